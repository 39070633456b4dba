"""Materials. Colours are linear RGB in [0, 1]: a number for grey, or three numbers."""

from __future__ import annotations

import os
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ._errors import InputError
from ._texture import Texture

__all__ = ["Boundary", "Glass", "Lambert", "Material", "Metal", "Mirror", "Plastic"]


def triple(name: str, value: Any) -> list[float]:
    """Three finite or infinite numbers; of one number, three times that. Ranges are checked when the scene is built."""
    try:
        numbers = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        numbers = np.empty(0)
    if numbers.shape not in ((), (3,)):
        raise InputError(f"{name} is {value!r}, but must be a number or three of them")
    return np.broadcast_to(numbers, (3,)).tolist()


def vector(name: str, value: Any) -> list[float]:
    """Three finite numbers."""
    numbers = triple(name, value) if np.shape(value) == (3,) else []
    if len(numbers) != 3 or not np.isfinite(numbers).all():
        raise InputError(f"{name} is {value!r}, but must be three finite numbers")
    return numbers


def number(name: str, value: Any) -> float:
    """A number that is not NaN."""
    try:
        result = float(value)
    except (TypeError, ValueError):
        result = np.nan
    if np.isnan(result):
        raise InputError(f"{name} is {value!r}, but must be a number")
    return result


def phase(name: str, anisotropy: Any, droplet_micrometres: Any) -> tuple[str, float, float | None]:
    """The arguments of a phase function."""
    droplets = None if droplet_micrometres is None else number("droplet_micrometres", droplet_micrometres)
    return str(name), number("anisotropy", anisotropy), droplets


# Parameters that are colours.
_COLORS = {"albedo", "tint", "absorption", "scattering", "sheen", "diffuse_transmission_color"}


def _numbers(key: str, value: Any) -> list[float]:
    return triple(key, value) if key in _COLORS else [number(key, value)]


def _layer(absent: dict[str, Any], **given: Any) -> dict[str, Any]:
    """The parameters of a layer; none if all have the values of one that is absent."""
    return given if any(_numbers(key, value) != _numbers(key, absent[key]) for key, value in given.items()) else {}


def _leaf(share: Any, color: Any) -> dict[str, Any]:
    absent = {"diffuse_transmission": 0, "diffuse_transmission_color": 1}
    return _layer(absent, diffuse_transmission=share, diffuse_transmission_color=color)


def _in_place(texture: Texture, use: str) -> Texture:
    """The same with channels where the library reads them."""
    image = np.asarray(texture.image)
    if use == "alpha_texture" and image.ndim in (2, 3) and (image.ndim == 2 or image.shape[2] != 4):
        grey = image if image.ndim == 2 else image[..., 0]
        return replace(texture, image=np.stack([grey] * 4, axis=-1))
    if use == "roughness_texture" and image.ndim == 2:
        full = np.full_like(image, 255 if image.dtype == np.uint8 else 1)
        return replace(texture, image=np.stack([full, image, full], axis=-1))
    return texture


@dataclass(frozen=True, kw_only=True)
class Material:
    """What all materials have.

    `emission`: radiance that the front emits, W/(m² sr), a number or RGB: a mesh of such a material is an area light.
    `emits_both_sides`: the back emits too. `clearcoat`: weight of a colourless layer of lacquer, in [0, 1]. `sheen`: colour
    of fibres over the surface (cloth), in [0, 1]. Glass has neither of the two.

    Textures multiply what they belong to: `color_texture` albedo, reflectance or tint, `emission_texture` the emission, and
    `roughness_texture` (grey; or as in glTF, roughness in green and metal in blue) the roughness of metal and plastic.
    `normal_map` has tangent-space normals as in glTF, whose x and y are multiplied by `normal_scale`. With
    `alpha_texture` (the alpha of four channels, else the red one) a surface has holes: where alpha is below `alpha_cutoff`;
    without a cutoff it covers that share of all light.
    """

    emission: Any = 0.0
    emits_both_sides: bool = False
    clearcoat: float = 0.0
    clearcoat_roughness: float = 0.0
    sheen: Any = 0.0
    sheen_roughness: float = 0.0
    color_texture: Texture | None = None
    emission_texture: Texture | None = None
    roughness_texture: Texture | None = None
    normal_map: Texture | None = None
    normal_scale: float = 1.0
    alpha_texture: Texture | None = None
    alpha_cutoff: float | None = None

    def _parameters(self) -> tuple[str, dict[str, Any]]:
        """Kind, and parameters by their keys in override files."""
        raise InputError("Material itself has no surface; use Lambert, Mirror, Glass, Boundary, Metal or Plastic")

    def _add_to(self, builder: Any, name: str, added: dict[Any, int]) -> int:
        kind, given = self._parameters()
        for name_of_layer in ("clearcoat", "sheen"):
            keys = (name_of_layer, f"{name_of_layer}_roughness")
            given |= _layer(dict.fromkeys(keys, 0), **{key: getattr(self, key) for key in keys})
        parameters = [(key, _numbers(key, value)) for key, value in given.items()]
        emission = (triple("emission", self.emission), bool(self.emits_both_sides))
        cutoff = None if self.alpha_cutoff is None else number("alpha_cutoff", self.alpha_cutoff)
        textures = (self._textures(builder, name, added), number("normal_scale", self.normal_scale), cutoff)
        index = builder.material(name, kind, parameters, emission, self._phase(), self._dispersion(), textures)
        grid = self._grid()
        if grid is not None:
            builder.grid(index, *grid)
        return index

    def _textures(self, builder: Any, name: str, added: dict[Any, int]) -> list[tuple[str, int, int]]:
        """Uses, numbers and UV sets of the textures. `added` has those of other materials."""
        result = []
        for use in ("color_texture", "emission_texture", "roughness_texture", "normal_map", "alpha_texture"):
            texture = getattr(self, use)
            if texture is None:
                continue
            if not isinstance(texture, Texture):
                raise InputError(f"{use} of {name!r} is {type(texture).__name__}, but must be a photonmap.Texture")
            made = _in_place(texture, use)
            is_color = use in ("color_texture", "emission_texture")
            key = (id(texture), use if made is not texture else is_color)
            if key not in added:
                added[key] = made._add_to(builder, f"{use} of {name}", is_color)
            result.append((use, added[key], texture.uv_set))
        return result

    def _phase(self) -> tuple[str, float, float | None]:
        """The phase function."""
        return "hg", 0.0, None

    def _grid(self) -> tuple[Any, ...] | None:
        """File, densities, cells, transform and scale."""
        return None

    def _dispersion(self) -> list[float]:
        """None, or the 1, 2 or 6 numbers of a formula."""
        return []


@dataclass(frozen=True)
class Lambert(Material):
    """A diffuse surface.

    `diffuse_transmission`: the share of the light that a sheet (a leaf, paper) lets through instead of reflecting it, in
    [0, 1], times `diffuse_transmission_color`.
    """

    albedo: Any = 0.5
    diffuse_transmission: float = 0.0
    diffuse_transmission_color: Any = 1.0

    def _parameters(self) -> tuple[str, dict[str, Any]]:
        return "lambert", {"albedo": self.albedo, **_leaf(self.diffuse_transmission, self.diffuse_transmission_color)}


@dataclass(frozen=True)
class Mirror(Material):
    """A perfect mirror, on both sides."""

    reflectance: Any = 1.0

    def _parameters(self) -> tuple[str, dict[str, Any]]:
        return "mirror", {"albedo": triple("reflectance", self.reflectance)}


@dataclass(frozen=True)
class Glass(Material):
    """A solid of glass, whose mesh must be closed and face outwards; `thin`: a pane without thickness.

    `ior`: refractive index. `absorption`, `scattering` (milk, wax): per unit of length.
    `phase`: "hg" (Henyey and Greenstein) with the mean cosine `anisotropy` of the scattering, in (-1, 1); "rayleigh"; or "mie"
    with `droplet_micrometres`, 5 to 50. `tint` multiplies the light at each crossing. `roughness` in [0, 1]; 0 is smooth.

    `grid`: densities that multiply both, of shape (z, y, x) and at least 0, or a `.vol` or `.nvdb` file; trilinear between the
    centres of cells. `transform`: four rows, from the unit cube, which the cells fill; by default that cube, or the box of the
    file. `density_scale`: a factor.

    Light is dispersed by at most one of `abbe`, the Abbe number, > 0; `cauchy`, `(A, B)` of n = A + B/λ²; and `sellmeier`,
    `(B1, B2, B3, C1, C2, C3)` of n² = 1 + Σ Bλ²/(λ² − C), λ in micrometres. The last two replace `ior`. A thin pane has neither
    these nor anything inside.
    """

    ior: float = 1.5
    tint: Any = 1.0
    absorption: Any = 0.0
    roughness: float = 0.0
    thin: bool = False
    abbe: float | None = None
    cauchy: Any = None
    sellmeier: Any = None
    scattering: Any = 0.0
    anisotropy: float = 0.0
    phase: str = "hg"
    droplet_micrometres: float | None = None
    # Arrays have no truth value by which dataclasses could compare them.
    grid: Any = field(default=None, compare=False)
    transform: Any = field(default=None, compare=False)
    density_scale: float = 1.0

    def _phase(self) -> tuple[str, float, float | None]:
        return phase(self.phase, self.anisotropy, self.droplet_micrometres)

    def _grid(self) -> tuple[Any, ...] | None:
        if self.grid is None:
            if self.transform is not None or self.density_scale != 1.0:
                raise InputError("glass has transform or density_scale, but no grid; give it a grid of densities")
            return None
        rows = None
        if self.transform is not None:
            try:
                rows = np.asarray(self.transform, dtype=np.float64)
            except (TypeError, ValueError):
                rows = np.empty(0)
            if rows.shape != (4, 4):
                raise InputError(f"transform is {self.transform!r}, but must be four rows of four numbers")
            rows = rows.tolist()
        scale = number("density_scale", self.density_scale)
        if isinstance(self.grid, (str, os.PathLike)):
            return os.fspath(self.grid), np.empty(0, np.float32), (0, 0, 0), rows, scale
        try:
            densities = np.ascontiguousarray(self.grid, dtype=np.float32)
        except (TypeError, ValueError):
            densities = np.empty(0, np.float32)
        if densities.ndim != 3:
            raise InputError("grid must be a file, or numbers of shape (z, y, x)")
        depth, height, width = densities.shape
        return None, densities.reshape(-1), (width, height, depth), rows, scale

    def _dispersion(self) -> list[float]:
        formulas = (("abbe", 1), ("cauchy", 2), ("sellmeier", 6))
        given = [(name, count) for name, count in formulas if getattr(self, name) is not None]
        if len(given) > 1:
            raise InputError(f"glass has both {given[0][0]} and {given[1][0]}; give one of abbe, cauchy and sellmeier")
        if not given:
            return []
        [(name, count)] = given
        value = getattr(self, name)
        terms = [number(name, term) for term in np.ravel(np.asarray(value, dtype=object))]
        if len(terms) != count:
            raise InputError(f"{name} is {value!r}, but must be {'a number' if count == 1 else f'{count} numbers'}")
        return terms

    def _parameters(self) -> tuple[str, dict[str, Any]]:
        given = {"ior": self.ior, "tint": self.tint, "roughness": self.roughness}
        inside = {"absorption": self.absorption, "scattering": self.scattering}
        # A pane has no inside: only what differs from nothing is refused.
        inside = {key: value for key, value in inside.items() if not self.thin or any(triple(key, value))}
        return ("thin" if self.thin else "glass"), given | inside


@dataclass(frozen=True)
class Boundary(Material):
    """The boundary of mist, smoke or ink, which light passes unchanged; its mesh must be closed and face outwards.

    `absorption`, `scattering`: per unit of length. `phase`, `anisotropy`, `droplet_micrometres`: as of `Glass`.
    """

    absorption: Any = 0.0
    scattering: Any = 0.0
    anisotropy: float = 0.0
    phase: str = "hg"
    droplet_micrometres: float | None = None

    def _phase(self) -> tuple[str, float, float | None]:
        return phase(self.phase, self.anisotropy, self.droplet_micrometres)

    def _parameters(self) -> tuple[str, dict[str, Any]]:
        return "boundary", {"absorption": self.absorption, "scattering": self.scattering}


@dataclass(frozen=True)
class Metal(Material):
    """A metal of this reflectance, and roughness in [0, 1] (GGX)."""

    reflectance: Any = 0.9
    roughness: float = 0.2

    def _parameters(self) -> tuple[str, dict[str, Any]]:
        return "glossy", {"albedo": triple("reflectance", self.reflectance), "metallic": 1, "roughness": self.roughness}


@dataclass(frozen=True)
class Plastic(Material):
    """A diffuse base under a coat of refractive index `ior`, and roughness in [0, 1] (GGX).

    `diffuse_transmission`, `diffuse_transmission_color`: as of `Lambert`. `transmission`: the share of the surface, in [0, 1],
    that is glass of the same index, roughness and colour: a pane, or with an `absorption` per unit of length a solid.
    """

    albedo: Any = 0.5
    roughness: float = 0.2
    ior: float = 1.5
    specular: float = 1.0
    diffuse_transmission: float = 0.0
    diffuse_transmission_color: Any = 1.0
    transmission: float = 0.0
    absorption: Any = None

    def _parameters(self) -> tuple[str, dict[str, Any]]:
        given = {"albedo": self.albedo, "roughness": self.roughness, "ior": self.ior, "specular": self.specular}
        leaf = _leaf(self.diffuse_transmission, self.diffuse_transmission_color)
        glass = {"transmission": self.transmission}
        glass |= {} if self.absorption is None else {"absorption": self.absorption}
        return "glossy", given | leaf | glass
