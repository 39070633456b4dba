"""The scenes: exported by photonmap, and read back for the converters.

`photonmap export` writes the XML of Mitsuba 3 with meshes as PLY files. Mitsuba reads that itself; for the other
renderers it is parsed here into a `Scene`.
"""

import json
import pathlib
import struct
import xml.etree.ElementTree
from dataclasses import dataclass

import numpy as np

from .errors import Malformed, Unsupported
from .process import run

SIZE = 256
# Scenes, and whether light can be focused in them by mirrors or glass.
SCENES = {"cornell": False, "cornell-glass": True, "ring-point": True}


@dataclass(frozen=True)
class Mesh:
    """Triangles of one material. `kind` is diffuse, mirror or glass; `radiance` is that of an area light or None."""

    path: pathlib.Path
    kind: str
    colour: tuple
    index: float
    radiance: tuple | None


@dataclass(frozen=True)
class Light:
    """A point light: its position, and its intensity in W/sr."""

    position: tuple
    intensity: tuple


@dataclass(frozen=True)
class Scene:
    name: str
    source: str
    xml: pathlib.Path
    origin: tuple
    target: tuple
    up: tuple
    fov: float
    meshes: tuple
    lights: tuple


def prepare(program, name, folder):
    """Exports the scene to `folder` and returns it."""
    folder.mkdir(parents=True, exist_ok=True)
    source = name
    if name == "ring-point":
        source = str(folder / "ring-point.glb")
        run([program, "export", "ring", "-o", folder / "ring.glb"])
        pathlib.Path(source).write_bytes(edited((folder / "ring.glb").read_bytes(), with_point_lights))
    xml = folder / f"{name}.xml"
    run([program, "export", source, "--size", f"{SIZE}x{SIZE}", "-o", xml])
    return parse(xml, name, source)


def edited(glb, edit):
    """A binary glTF file whose JSON was changed by the function `edit`."""
    magic, _, _, length, kind = struct.unpack_from("<4sIIII", glb)
    if magic != b"glTF" or kind != 0x4E4F534A:
        raise Malformed("not a binary glTF file", "export it with `photonmap export`")
    root, rest = json.loads(glb[20 : 20 + length]), glb[20 + length :]
    edit(root)
    text = json.dumps(root).encode()
    text += b" " * (-len(text) % 4)
    return struct.pack("<4sIIII", magic, 2, 20 + len(text) + len(rest), len(text), kind) + text + rest


def with_point_lights(root):
    """Puts point lights of the same intensity in the place of spotlights in the glTF of photonmap."""
    for light in root["extensions"]["KHR_lights_punctual"]["lights"]:
        if light["type"] == "spot":
            light["type"] = "point"
            del light["spot"]
    for node in root["nodes"]:
        exact = node.get("extras", {}).get("photonmap", {}).get("light", {})
        if exact.get("type") == "spot":
            exact["type"] = "point"
            for key in ("direction", "inner_angle", "outer_angle"):
                del exact[key]


def numbers(text):
    return tuple(float(part) for part in text.replace(",", " ").split())


def parse(path, name, source):
    """Reads what `photonmap export` writes; anything else is an error that names the plugin."""
    root = xml.etree.ElementTree.parse(path).getroot()
    sensor = root.find("sensor")
    view = sensor.find("transform/lookat")
    fov = float(sensor.find("float[@name='fov']").get("value"))
    meshes = tuple(parse_mesh(shape, path.parent) for shape in root.findall("shape"))
    lights = tuple(parse_light(emitter) for emitter in root.findall("emitter"))
    eye = [numbers(view.get(key)) for key in ("origin", "target", "up")]
    return Scene(name, source, path.resolve(), *eye, fov, meshes, lights)


def parse_mesh(shape, folder):
    bsdf = shape.find("bsdf")
    if bsdf.get("type") == "twosided":
        bsdf = bsdf.find("bsdf")
    kinds = {"diffuse": "diffuse", "conductor": "mirror", "dielectric": "glass"}
    if bsdf.get("type") not in kinds or bsdf.find("rgb") is None:
        raise Unsupported(f"BSDF {bsdf.get('type')} of the exported scene", "leave this scene out")
    if shape.find("medium") is not None:
        raise Unsupported("glass that absorbs", "leave this scene out")
    kind, index = kinds[bsdf.get("type")], 1.0
    if kind == "glass":
        index = float(bsdf.find("float[@name='int_ior']").get("value"))
    emitter = shape.find("emitter")
    radiance = None if emitter is None else numbers(emitter.find("rgb").get("value"))
    path = (folder / shape.find("string").get("value")).resolve()
    return Mesh(path, kind, numbers(bsdf.find("rgb").get("value")), index, radiance)


def parse_light(emitter):
    if emitter.get("type") != "point":
        raise Unsupported(f"light {emitter.get('type')} of the exported scene", "leave this scene out")
    return Light(numbers(emitter.find("point").get("value")), numbers(emitter.find("rgb").get("value")))


def read_ply(path):
    """Positions (n, 3) and triangles (m, 3) of a binary PLY file as `photonmap export` writes it."""
    data = path.read_bytes()
    end = data.find(b"end_header\n") + len(b"end_header\n")
    header = data[:end].decode("ascii", errors="replace").splitlines()
    expected = ["property float x", "property float y", "property float z"]
    if (
        "format binary_little_endian 1.0" not in header
        or [x for x in header if x.startswith("property float")] != expected
    ):
        raise Malformed(f"{path}: not a PLY file of positions alone", "export the scene again")
    counts = {line.split()[1]: int(line.split()[2]) for line in header if line.startswith("element")}
    points = np.frombuffer(data, "<f4", counts["vertex"] * 3, end).reshape(-1, 3)
    faces = np.frombuffer(data, np.dtype([("n", "u1"), ("v", "<i4", 3)]), counts["face"], end + points.nbytes)
    if (faces["n"] != 3).any():
        raise Malformed(f"{path}: a face is no triangle", "export the scene again")
    return points, faces["v"]
