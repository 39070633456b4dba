"""`Film`: what a render returns."""

from __future__ import annotations

import os
import sys
from functools import cached_property
from typing import Any

import numpy as np

from ._errors import InputError
from ._materials import number
from ._photonmap import RawFilm, check_writable, write_bytes

__all__ = ["Film"]

LAYERS = ("emission", "direct", "caustic", "indirect")


class Film:
    """The sums of all passes of a render. Arrays have the shape (height, width, 3) or (height, width), float32, the top row
    first; light is linear RGB in W/(m² sr). In a notebook it is shown as a picture.
    """

    def __init__(self, raw: RawFilm) -> None:
        if not isinstance(raw, RawFilm):
            raise InputError("films are made by rendering, or read from a file by Film.load(path)")
        self._raw = raw

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Film:
        """Reads a .film file."""
        return cls(RawFilm.load(os.fspath(path)))

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width."""
        return self._raw.height, self._raw.width

    @property
    def passes(self) -> int:
        """Number of passes."""
        return self._raw.passes

    @property
    def contains(self) -> list[tuple[int, range]]:
        """Which passes these are: seeds, and indices."""
        return [(seed, range(first, end)) for seed, first, end in self._raw.ranges()]

    @property
    def counts(self) -> dict[str, Any]:
        """What the photons of all passes did, also of those that were rendered earlier or elsewhere.

        "passes": how many were counted, fewer than `passes` if some are from a file without counts. "paths" and
        "aimed_paths": how many were emitted, and how they ended: absorbed, escaped, terminated (aimed ones at a diffuse
        surface, others in fog far away), truncated, dropped. "stored": photons by map. "truncated_camera_paths": unless 0,
        light is missing beyond `max_bounces`.
        """
        passes, paths, aimed, stored, cut = self._raw.counts()
        return {
            "passes": passes,
            "paths": dict(paths),
            "aimed_paths": dict(aimed),
            "stored": dict(stored),
            "truncated_camera_paths": cut,
        }

    @cached_property
    def beauty(self) -> np.ndarray:
        """The picture, the sum of the layers."""
        return self._colors("beauty")

    @cached_property
    def layers(self) -> dict[str, np.ndarray]:
        """The picture by paths of light: emission, direct, caustic, indirect."""
        return {name: self._colors(name) for name in LAYERS}

    @cached_property
    def error(self) -> np.ndarray:
        """Standard error of the mean over RGB of each pixel; infinite after one pass."""
        return self._numbers("error")

    @cached_property
    def error_bound(self) -> np.ndarray:
        """Half the width of a 95 % confidence interval of each pixel, bias included; infinite where there is no estimate.

        Needs a render with `errors=True` or a target error.
        """
        bound = self._raw.bounds()
        if bound is None:
            raise InputError("the film has no error statistics; render it with errors=True")
        return bound.reshape(self.shape)

    @cached_property
    def alpha(self) -> np.ndarray:
        """Share of the camera rays that hit a surface."""
        return self._numbers("alpha")

    @cached_property
    def depth(self) -> np.ndarray:
        """Mean distance to the first surface; infinite where there is none."""
        return self._numbers("depth")

    @cached_property
    def normal(self) -> np.ndarray:
        """Mean normal of the first surface; 0 where there is none."""
        return self._colors("normal")

    @cached_property
    def albedo(self) -> np.ndarray:
        """Mean albedo of the first surface."""
        return self._colors("albedo")

    def denoise(self) -> np.ndarray:
        """The picture, denoised by Open Image Denoise 2 with albedo and normal, as `photonmap render --denoise` does.

        Where the film has `error_bound`, the mean over RGB stays within it. `pip install pyoidn` installs the library, without
        which it is a `DeviceError`. Not for transparent backgrounds.
        """
        return self._raw.denoised(sys.prefix).reshape(*self.shape, 3)

    def save(
        self,
        path: str | os.PathLike[str],
        *,
        exposure: float | str | None = "auto",
        tonemap: str = "neutral",
        denoise: bool = False,
    ) -> None:
        """Writes a picture or a film, atomically.

        .exr: all layers, linear. .png: tone-mapped by "neutral", "agx", "aces", "reinhard" or "none", after an `exposure` in
        stops; "auto" or None: automatic. `denoise`: both as `denoise()` gives it. .film: the sums themselves, which `render(film=)`
        continues.
        """
        name = os.fspath(path)
        check_name(name)
        environment = sys.prefix if denoise else None
        if name.lower().endswith(".exr"):
            self._raw.save_exr(name, environment)
        elif name.lower().endswith(".film"):
            if denoise:
                raise InputError(f"{name}: a film has the sums as they are; denoise pictures of it, .exr or .png")
            self._raw.save(name)
        else:
            is_automatic = exposure is None or (isinstance(exposure, str) and exposure == "auto")
            stops = None if is_automatic else number("exposure", exposure)
            write_bytes(name, self._raw.png(stops, tonemap, environment))

    def _repr_png_(self) -> bytes:
        return self._raw.png(None, "neutral", None)

    def _colors(self, name: str) -> np.ndarray:
        return self._raw.colors(name).reshape(*self.shape, 3)

    def _numbers(self, name: str) -> np.ndarray:
        return self._raw.numbers(name).reshape(self.shape)

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore, self._raw.to_bytes()

    def __repr__(self) -> str:
        return f"Film({self._raw.width}x{self._raw.height}, {self.passes} passes)"


def _restore(data: bytes, refused: str | None) -> Film:
    return Film(RawFilm.from_bytes(data, refused))


def check_name(name: str) -> None:
    """Checks the name of an output, and that it can be written."""
    if not name.lower().endswith((".exr", ".png", ".film")):
        raise InputError(f"{name}: the name of a picture ends in .exr or .png, that of a film in .film")
    check_writable(name)
