"""`Texture`: an image on a surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ._errors import InputError

__all__ = ["Texture"]

WRAPS = ("repeat", "mirror", "clamp")


@dataclass(frozen=True, eq=False)
class Texture:
    """An image that meshes with texture coordinates (`uvs=`) show, the top row first: (0, 0) is its upper left corner.

    `image`: (h, w) for grey, (h, w, 3) for RGB, or (h, w, 4) with alpha. Bytes (uint8) are sRGB in colours and linear
    elsewhere; real numbers are linear, in [0, 1] except for emission, which only has to be >= 0. `wrap`: "repeat", "mirror" or
    "clamp" beyond the edges, or a pair of them, for u and v. `nearest`: the nearest texel, in place of a bilinear filter.
    `uv_set`: which of the texture coordinates, if a mesh has several.

    The array is not copied: changing it before the scene is built changes the texture.
    """

    image: Any
    wrap: Any = "repeat"
    nearest: bool = False
    uv_set: int = 0

    def _texels(self, use: str) -> tuple[np.ndarray, int]:
        """Four channels a texel, flat, as uint8 or float32; and the width."""
        image = np.asarray(self.image)
        channels = image.shape[2] if image.ndim == 3 else 1
        if image.ndim not in (2, 3) or channels not in (1, 3, 4) or 0 in image.shape:
            raise InputError(f"{use}: the image has the shape {image.shape}, but must have (h, w), (h, w, 3) or (h, w, 4)")
        if image.dtype != np.uint8 and image.dtype.kind != "f":
            raise InputError(f"{use}: the image has the type {image.dtype}, but must have uint8 or real numbers")
        kind = np.uint8 if image.dtype == np.uint8 else np.float32
        texels = np.full((*image.shape[:2], 4), 255 if kind is np.uint8 else 1, dtype=kind)
        if channels == 1:
            texels[..., :3] = image.reshape(*image.shape[:2], 1)
        else:
            texels[..., :channels] = image
        return texels.reshape(-1), image.shape[1]

    def _wraps(self, use: str) -> tuple[int, int]:
        pair = (self.wrap, self.wrap) if isinstance(self.wrap, str) else tuple(self.wrap)
        if len(pair) != 2 or any(name not in WRAPS for name in pair):
            raise InputError(f"{use}: wrap is {self.wrap!r}, but must be one of {', '.join(WRAPS)}, or two of them")
        return WRAPS.index(pair[0]), WRAPS.index(pair[1])

    def _add_to(self, builder: Any, use: str, is_color: bool) -> int:
        texels, width = self._texels(use)
        wraps = self._wraps(use)
        if not 0 <= self.uv_set < 2**31:
            raise InputError(f"{use}: uv_set is {self.uv_set!r}, but must be 0, 1, ...")
        if texels.dtype == np.uint8:
            return builder.texture_bytes(use, texels, width, is_color, wraps, bool(self.nearest))
        return builder.texture_floats(use, texels, width, wraps, bool(self.nearest))
