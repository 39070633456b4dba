"""Photons out of the library, and estimates from photons of one's own."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any

import numpy as np

from ._device import gpu
from ._errors import InputError
from ._kdtree import _vectors
from ._photonmap import RawMap, trace_photons
from ._materials import number
from ._render import _scene, _whole
from ._scene import Scene
from ._settings import Settings

__all__ = ["PhotonMap", "Photons", "trace"]


@dataclass(frozen=True)
class Photons:
    """Photons at the diffuse surfaces that they met, ordered by kind, then by path.

    `position` (n, 3), float64, user space. `normal` (n, 3), float32: of the surface, on the side where they arrived.
    `direction` (n, 3), float32: unit vectors towards where they came from. `power` (n, 3), float64, watts: their sum at a
    surface is its flux. `kind` (n,), uint8: 0 directly from a light, 1 by way of mirrors and glass alone (caustics), 2 after
    diffuse reflection.
    """

    position: np.ndarray
    normal: np.ndarray
    direction: np.ndarray
    power: np.ndarray
    kind: np.ndarray

    def __len__(self) -> int:
        return len(self.kind)

    def __getitem__(self, index: Any) -> Photons:
        """The photons that a mask, a slice or indices select: `photons[photons.kind == 1]`."""
        at = slice(index, index + 1 or None) if isinstance(index, int) else index
        return Photons(self.position[at], self.normal[at], self.direction[at], self.power[at], self.kind[at])


def trace(
    scene: Scene | str | os.PathLike[str],
    photons: int = 200_000,
    *,
    settings: Settings | None = None,
    device: str = "auto",
    threads: int | None = None,
    environment: Any = None,
    **fields: Any,
) -> Photons:
    """Traces so many paths of light, and returns the photons that they leave at diffuse surfaces.

    Paths are those of the first pass of a render, none of them aimed at glass. `settings` and further keyword arguments are
    those of `render`, such as `seed=1`, and so are `device` and `environment`.
    """
    count = _whole("photons", photons, 2**32 - 1)
    chosen = (Settings() if settings is None else settings).replace(photons=count, **fields)
    arrays = trace_photons(_scene(scene, None, environment, chosen.memory)._raw(), chosen.to_json(), _device(device, threads))
    position, normal, direction, power = (array.reshape(-1, 3) for array in arrays[:4])
    return Photons(position, normal, direction, power, arrays[4])


class PhotonMap:
    """Photons of one's own, arranged for density estimation.

    `position`, `normal` (n, 3): of the surface where each photon arrived. `power`: (n,) or (n, 3), watts. `device`: as of
    `KDTree`.
    """

    def __init__(
        self, position: Any, normal: Any, power: Any, *, device: str = "auto", threads: int | None = None
    ) -> None:
        flat, toward = _vectors("position", position), _vectors("normal", normal)
        watts = np.asarray(power)
        self._grey = watts.ndim == 1
        if np.ndim(position) != 2 or toward.size != flat.size or watts.shape[0:1] != (flat.size // 3,):
            raise InputError(
                f"position, normal and power have the shapes {np.shape(position)}, {np.shape(normal)} and {watts.shape}, but "
                "must have (n, 3), (n, 3), and (n,) or (n, 3)"
            )
        colors = _vectors("power", np.repeat(watts[:, None], 3, axis=1) if self._grey else watts)
        self._raw = RawMap(flat, toward, colors, _device(device, threads, prefers=False))

    def __len__(self) -> int:
        return len(self._raw)

    def irradiance(
        self,
        x: Any,
        normals: Any,
        *,
        k: int | None = None,
        radius: float | None = None,
        kernel: str = "constant",
        min_normal_cosine: float = 0.7,
    ) -> np.ndarray:
        """Irradiance in W/m² at the points x (..., 3) of surfaces with these normals, one or one each, float64, (...) or (..., 3) as `power`.

        From the `k` nearest photons, of which the farthest only sets the radius (Jensen 2001), from all within `radius`, or
        from the k nearest within it. Photons count if the cosine between their normal and that of the point is at least
        `min_normal_cosine`. `kernel`: "constant" or "epanechnikov".
        """
        flat = _vectors("x", x)
        try:
            toward = _vectors("normals", np.broadcast_to(np.asarray(normals), np.shape(x)))
        except ValueError as why:
            if isinstance(why, InputError):
                raise
            raise InputError(
                f"normals has the shape {np.shape(normals)}, which cannot be broadcast to {np.shape(x)}, that of x"
            ) from None
        if k is None and radius is None:
            raise InputError("give k= or radius=")
        nearest = None if k is None else _whole("k", k, 2**32 - 1)
        if nearest == 1:
            raise InputError("k is 1, but at least 2 are needed: the farthest photon only sets the radius")
        reach = np.inf if radius is None else number("radius", radius)
        if not reach > 0 or (radius is not None and np.isinf(reach)):
            raise InputError(f"radius is {radius!r}, but must be above 0 and finite")
        found = self._raw.irradiance(flat, toward, nearest, reach, kernel, float(min_normal_cosine))
        colors = found.reshape(*np.shape(x)[:-1], 3)
        return colors[..., 0] if self._grey else colors


def _device(device: str, threads: int | None, prefers: bool = True) -> tuple[str | None, int]:
    return gpu(device, prefers), 0 if threads is None else _whole("threads", threads, 4096)
