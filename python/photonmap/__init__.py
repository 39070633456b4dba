"""Photon mapping on CPUs and GPUs, and exact nearest-neighbour searches in three dimensions."""

from ._errors import DeviceError, Error, FileError, ForkError, InputError, OutOfMemoryError
from ._kdtree import KDTree

__version__ = "0.1.0"

__all__ = [
    "DeviceError",
    "Error",
    "FileError",
    "ForkError",
    "InputError",
    "KDTree",
    "OutOfMemoryError",
]
