"""Photon mapping on CPUs and GPUs, and exact nearest-neighbour searches in three dimensions."""

from ._errors import (
    DeviceError,
    Error,
    FileError,
    ForkError,
    InputError,
    Interrupted,
    OutOfMemoryError,
    SceneWarning,
)
from ._film import Film
from ._kdtree import KDTree
from ._materials import Boundary, Glass, Lambert, Material, Metal, Mirror, Plastic
from ._photons import PhotonMap, Photons, trace
from ._progress import Progress
from ._render import builtin_scenes, render
from ._scene import Scene
from ._settings import Settings
from ._texture import Texture

__version__ = "0.1.0"

__all__ = [
    "Boundary",
    "DeviceError",
    "Error",
    "FileError",
    "Film",
    "ForkError",
    "Glass",
    "InputError",
    "Interrupted",
    "KDTree",
    "Lambert",
    "Material",
    "Metal",
    "Mirror",
    "OutOfMemoryError",
    "PhotonMap",
    "Photons",
    "Plastic",
    "Progress",
    "Scene",
    "SceneWarning",
    "Settings",
    "Texture",
    "builtin_scenes",
    "render",
    "trace",
]
