"""`Scene`: from arrays, from files, or built in."""

from __future__ import annotations

import math
import os
from typing import Any

import numpy as np

from ._errors import InputError, SceneWarning, warn
from ._materials import Lambert, Material, number, triple, vector
from ._materials import phase as phase_arguments
from ._photonmap import RawBuilder, RawScene, environment_text

__all__ = ["Scene"]


class Scene:
    """A scene in the user's own unit of length, with light in watts.

    Its methods add objects and return the scene. Nothing is checked against the rest of the scene before it is rendered, or
    `build` is called. It can be pickled; a scene of a file is read again where it is unpickled, and must be the same there.
    """

    def __init__(self) -> None:
        self._source: tuple[str, str, str | None, int | None] | None = None
        self._calls: list[tuple[str, tuple[Any, ...]]] = []
        self._built: RawScene | None = None
        self._digest: str | None = None
        self._has_warned = False

    @classmethod
    def builtin(cls, name: str) -> Scene:
        """A built-in scene; `photonmap.builtin_scenes()` lists them."""
        scene = cls()
        scene._source = ("builtin", str(name), None, None)
        RawBuilder.builtin(str(name))
        return scene

    @classmethod
    def load(
        cls,
        path: str | os.PathLike[str],
        overrides: str | os.PathLike[str] | None = None,
        *,
        environment: Any = None,
        memory: int | None = None,
    ) -> Scene:
        """A .gltf, .glb, .obj, .ply or .stl file, changed by an override file (TOML).

        `environment`: light from all around, as for the method of that name; it replaces that of the override file.
        `memory`: limit in bytes on what reading holds at any time: files, meshes, textures and images. Textures that do not
        fit are reduced, which `report` says; if that is not enough, the error is `OutOfMemoryError`.
        """
        scene = cls()
        more = None if overrides is None else os.path.abspath(os.fspath(overrides))
        scene._source = ("file", os.path.abspath(os.fspath(path)), more, _limit(memory))
        if environment is not None:
            scene.environment(environment, memory=memory)
        scene.build()
        return scene

    def mesh(
        self,
        name: str,
        vertices: Any,
        triangles: Any,
        material: Material | None = None,
        *,
        normals: Any = None,
        uvs: Any = None,
    ) -> Scene:
        """Adds triangles: `vertices` (n, 3), `triangles` (m, 3) indices into them, counter-clockwise from the front.

        `normals`: one for each vertex, of any length, for smooth shading. `uvs`: texture coordinates (n, 2), or a list of
        such arrays, one for each UV set. `material`: by default `Lambert(0.5)`.
        """
        material = Lambert() if material is None else material
        if not isinstance(material, Material):
            raise InputError(f"mesh {name!r}: material is {material!r}, but must be one such as photonmap.Lambert(0.5)")
        positions = _rows(f"mesh {name!r}: vertices", vertices)
        corners = np.asarray(triangles)
        if corners.ndim != 2 or corners.shape[1] != 3 or (corners.dtype.kind not in "iu" and corners.size > 0):
            raise InputError(
                f"mesh {name!r}: triangles has the shape {corners.shape} and the type {corners.dtype}, but must have (m, 3) "
                "whole numbers"
            )
        count = len(positions) // 3
        outside = (corners < 0) | (corners >= count)
        if outside.any():
            row = int(np.nonzero(outside.any(axis=1))[0][0])
            raise InputError(f"mesh {name!r}: triangle {row} is {corners[row].tolist()}, but there are {count} vertices")
        toward = None
        if normals is not None:
            toward = _rows(f"mesh {name!r}: normals", normals)
            if toward.size != positions.size:
                raise InputError(f"mesh {name!r}: {toward.size // 3} normals for {count} vertices")
        flat = np.ascontiguousarray(corners, dtype=np.uint32).reshape(-1)
        return self._call("mesh", str(name), positions, flat, material, toward, _uv_sets(name, uvs, count))

    def quad(self, name: str, corners: Any, material: Material | None = None) -> Scene:
        """Adds a quadrilateral of four corners, counter-clockwise as seen from the front.

        Textures fill it: their lower left, lower right, upper right and upper left corners are at these four.
        """
        if np.shape(corners) != (4, 3):
            raise InputError(f"quad {name!r}: corners has the shape {np.shape(corners)}, but must have (4, 3)")
        uvs = [[0, 1], [1, 1], [1, 0], [0, 0]]
        return self.mesh(name, corners, [[0, 1, 2], [0, 2, 3]], material, uvs=uvs)

    def point_light(self, position: Any, intensity: Any, *, name: str = "point light") -> Scene:
        """Adds a light that emits equally in all directions; `intensity` in W/sr, a number or RGB."""
        return self._call("point_light", name, vector("position", position), triple("intensity", intensity))

    def spot_light(
        self,
        position: Any,
        direction: Any,
        intensity: Any,
        *,
        inner: float = 30.0,
        outer: float = 40.0,
        name: str = "spot light",
    ) -> Scene:
        """Adds a light within a cone; angles from its axis to where it starts and ends to fade, in degrees."""
        angles = (math.radians(number("inner", inner)), math.radians(number("outer", outer)))
        return self._call(
            "spot_light",
            name,
            vector("position", position),
            vector("direction", direction),
            triple("intensity", intensity),
            angles,
        )

    def directional_light(self, direction: Any, irradiance: Any, *, name: str = "directional light") -> Scene:
        """Adds parallel light that travels in `direction`; `irradiance` in W/m², of a plane that faces it."""
        return self._call(
            "directional_light", name, vector("direction", direction), triple("irradiance", irradiance)
        )

    def sun(self, direction: Any, irradiance: Any, *, radius: float = 0.2669) -> Scene:
        """Sets the sun: a disc, infinitely far away, whose light travels in `direction`; its `radius` in degrees."""
        return self._call("sun", vector("direction", direction), triple("irradiance", irradiance), number("radius", radius))

    def environment(
        self, light: Any, *, rotate: float = 0.0, scale: float = 1.0, memory: int | None = None
    ) -> Scene:
        """Sets the light from all around, and replaces that of before.

        `light`: a radiance in W/(m² sr), a number or RGB; an image as an array (h, w, 3), w = 2h, in latitude and longitude;
        or the text of the program's option --environment: the path of an image; "gradient", of radiance 1 + 0.9 d·ω
        from direction ω, with the unit vector d along (-2, 4, 3); "constant", "constant:R,G,B"; or a clear sky with its sun,
        "sky:ELEVATION,TURBIDITY", in degrees and from 1 to 10.
        `rotate`: degrees, counter-clockwise as seen from above (+y). `memory`: limit in bytes on reading an image file.
        """
        turn, factor, limit = number("rotate", rotate), number("scale", scale), _limit(memory)
        if isinstance(light, (str, os.PathLike)):
            text = os.fspath(light)
            kind, numbers = environment_text(text) if isinstance(light, str) else ("file", [])
            if kind == "file":
                return self._call("environment_file", os.path.abspath(text), turn, factor, limit)
            if kind == "gradient":
                return self._call("environment_gradient", turn, factor)
            if kind == "sky":
                return self._call("environment_sky", *numbers, turn, factor)
            light = numbers
        if np.ndim(light) == 3:
            image = np.ascontiguousarray(light, dtype=np.float32)
            if image.shape[2] != 3:
                raise InputError(f"environment: the image has the shape {image.shape}, but must have (h, w, 3)")
            return self._call("environment_image", image.shape[1], image.reshape(-1, 3), turn, factor)
        radiance = [channel * factor for channel in triple("environment", light)]
        return self._call("environment_constant", radiance)

    def medium(
        self,
        *,
        scattering: Any = 0.0,
        absorption: Any = 0.0,
        anisotropy: float = 0.0,
        phase: str = "hg",
        droplet_micrometres: float | None = None,
        box: Any = None,
    ) -> Scene:
        """Sets the medium around all solids: fog, haze. Light from infinitely far away does not pass one without a box.

        `scattering`, `absorption`: coefficients per unit of length, a number or RGB. `phase`: "hg" (Henyey and Greenstein) with
        the mean cosine `anisotropy`, in (-1, 1): 0 scatters evenly, 1 forwards; "rayleigh" for air; or "mie" for fog, with
        droplets of `droplet_micrometres`, 5 to 50. `box`: lower and upper corner of what it fills, (2, 3).
        """
        coefficients = triple("scattering", scattering), triple("absorption", absorption)
        function = phase_arguments(phase, anisotropy, droplet_micrometres)
        bounds = None
        if box is not None:
            if np.shape(box) != (2, 3):
                raise InputError(f"the box has the shape {np.shape(box)}, but must have (2, 3)")
            bounds = [vector("a corner of the box", corner) for corner in box]
        return self._call("medium", *coefficients, function, bounds)

    def portal(self, opening: Any, *, name: str = "portal") -> Scene:
        """Declares an opening, such as a window, where photons of light from infinitely far away start more often.

        `opening`: three corners, or four of a quadrilateral, (3, 3) or (4, 3); or the name of a mesh or material whose
        triangles fill it. It affects noise alone, wherever it is.
        """
        if isinstance(opening, str):
            return self._call("portal_named", opening)
        if np.shape(opening) not in ((3, 3), (4, 3)):
            raise InputError(f"{name!r}: the opening has the shape {np.shape(opening)}, but must have (3, 3) or (4, 3)")
        corners = [vector(f"a corner of {name!r}", corner) for corner in opening]
        order = (0, 1, 2) if len(corners) == 3 else (0, 1, 2, 0, 2, 3)
        return self._call("portal", name, [corners[index] for index in order])

    def camera(
        self,
        position: Any,
        *,
        to: Any = None,
        direction: Any = None,
        up: Any = (0, 1, 0),
        fov: float = 40.0,
        height: float | None = None,
        aperture: float = 0.0,
        focus: float | None = None,
        name: str = "camera",
    ) -> Scene:
        """Adds a camera that looks at the point `to`, or in a `direction`; the first camera is the default.

        `fov`: degrees between the lower and the upper edge of the picture. `height`: an orthographic camera, whose picture is
        so high. `aperture`: diameter of the lens, `focus`: distance of what is sharp, by default that of `to`.
        """
        origin = vector("position", position)
        if (to is None) == (direction is None):
            raise InputError(f"camera {name!r}: give either to= or direction=")
        if to is not None:
            toward = [b - a for a, b in zip(origin, vector("to", to))]
            distance: float | None = math.hypot(*toward)
        else:
            toward, distance = vector("direction", direction), None
        lens = None
        if aperture != 0:
            far = distance if focus is None else number("focus", focus)
            if far is None:
                raise InputError(f"camera {name!r}: with an aperture and a direction, focus= is needed")
            lens = (number("aperture", aperture), far)
        view = (False, math.radians(number("fov", fov))) if height is None else (True, 0.5 * number("height", height))
        return self._call("camera", name, origin, toward, vector("up", up), view, lens)

    def build(self) -> Scene:
        """Checks everything, which `render` does too."""
        self._raw()
        return self

    @property
    def warnings(self) -> list[str]:
        """Problems that do not prevent rendering. When it is built they are warned of as `SceneWarning`, and so is what `report` says
        is approximated or left out."""
        return self._raw().warnings()

    @property
    def report(self) -> list[str]:
        """What the file has that is rendered differently, or left out."""
        return self._raw().report()

    @property
    def cameras(self) -> list[str]:
        """Names of the cameras."""
        return self._raw().cameras()

    @property
    def digest(self) -> str:
        """Digest of all that is rendered, cameras excluded, in hexadecimal."""
        return self._raw().digest()

    @property
    def name(self) -> str:
        """Name of the file or of the built-in scene."""
        return os.path.basename(self._source[1]) if self._source else "scene"

    def _call(self, method: str, *args: Any) -> Scene:
        self._calls.append((method, args))
        self._built = self._digest = None
        self._has_warned = False
        return self

    def _raw(self) -> RawScene:
        if self._built is None:
            builder = self._builder()
            materials: dict[int, int] = {}
            textures: dict[Any, int] = {}
            for method, args in self._calls:
                if method == "mesh":
                    name, positions, corners, material, normals, uvs = args
                    # One material for meshes that share the object.
                    if id(material) not in materials:
                        called = f"{type(material).__name__} of {name}"
                        materials[id(material)] = material._add_to(builder, called, textures)
                    builder.mesh(name, positions, corners, materials[id(material)], normals, uvs)
                else:
                    getattr(builder, method)(*args)
            built = builder.build()
            if self._digest is not None and built.digest() != self._digest:
                raise InputError(
                    f"{self.name}: the scene has changed since it was pickled, or is another on this machine; give all "
                    "machines the same files"
                )
            self._built = built
            # Workers do not repeat it.
            if not self._has_warned:
                self._has_warned = True
                for line in built.user_warnings():
                    warn(f"{self.name}: {line}", SceneWarning)
        return self._built

    def _builder(self) -> RawBuilder:
        if self._source is None:
            return RawBuilder()
        kind, name, overrides, memory = self._source
        return RawBuilder.builtin(name) if kind == "builtin" else RawBuilder.load(name, overrides, memory)

    def __getstate__(self) -> dict[str, Any]:
        # Arrays are part of the pickle, files are not: their contents must be the same.
        reads_files = self._source is not None or any(call in ("overrides", "environment_file") for call, _ in self._calls)
        digest = self.digest if reads_files else None
        has_warned = self._has_warned
        return {"_source": self._source, "_calls": self._calls, "_built": None, "_digest": digest, "_has_warned": has_warned}

    def __repr__(self) -> str:
        source = f"{self.name}, " if self._source else ""
        return f"Scene({source}{len(self._calls)} additions)"


def _limit(memory: float | None) -> int | None:
    """A number of bytes that fits into 64 bits."""
    if memory is None:
        return None
    if isinstance(memory, float) and memory.is_integer():
        memory = int(memory)
    if isinstance(memory, bool) or not isinstance(memory, (int, np.integer)) or not 0 < memory < 2**64:
        raise InputError(f"memory is {memory!r}, but must be a whole number of bytes above 0, or None")
    return int(memory)


def _uv_sets(name: str, uvs: Any, count: int) -> list[np.ndarray]:
    """Texture coordinates of `count` vertices as flat arrays, one for each set."""
    if uvs is None:
        return []
    try:
        sets = [np.asarray(uvs)] if np.ndim(uvs) == 2 else [np.asarray(one) for one in uvs]
    except (TypeError, ValueError):
        raise InputError(f"mesh {name!r}: uvs must be an array (n, 2), or a list of such arrays") from None
    for index, one in enumerate(sets):
        if one.shape != (count, 2) or one.dtype.kind not in "fiub":
            raise InputError(
                f"mesh {name!r}: UV set {index} has the shape {one.shape} and the type {one.dtype}, but must have "
                f"({count}, 2) real numbers"
            )
    return [np.array(one, dtype=np.float64, order="C").reshape(-1) for one in sets]


def _rows(name: str, values: Any) -> np.ndarray:
    """Vectors as a flat array of their coordinates."""
    array = np.asarray(values)
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in "fiub":
        raise InputError(f"{name} has the shape {array.shape} and the type {array.dtype}, but must have (n, 3) real numbers")
    return np.array(array, dtype=np.float64, order="C").reshape(-1)
