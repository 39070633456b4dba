"""Compares a textured model under an environment with an unbiased path tracer, Mitsuba 3 (Jakob et al. 2022).

    pip install mitsuba
    cargo build --release
    python tests/mitsuba/helmet.py target/release/photonmap FlightHelmet.gltf studio.exr

Mitsuba renders the file's meshes with its own `principled` BSDF, or with the BSDF of gloss.py (`--bsdf glossy`), whose
roughness and metallic factor are textures here. Prints the means, the differences of blocks of pixels, and what
`photonmap compare` says of the pictures (relMSE and FLIP); writes both as .exr and .png. The model's transforms, samplers
and factors are ignored: those of the Khronos sample FlightHelmet are the defaults.
"""

import argparse
import json
import pathlib
import subprocess

import numpy as np

import gloss

COLUMNS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
TYPES = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}


class Model:
    """Meshes and images of a .gltf file."""

    def __init__(self, path):
        self.folder = path.parent
        self.file = json.loads(path.read_text())
        self.buffers = [(self.folder / buffer["uri"]).read_bytes() for buffer in self.file["buffers"]]

    def array(self, index):
        accessor = self.file["accessors"][index]
        view = self.file["bufferViews"][accessor["bufferView"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        columns = COLUMNS[accessor["type"]]
        data = self.buffers[view["buffer"]]
        flat = np.frombuffer(data, TYPES[accessor["componentType"]], accessor["count"] * columns, start)
        return flat.reshape(-1, columns)

    def primitives(self):
        for mesh in self.file["meshes"]:
            yield from mesh["primitives"]

    def bounds(self):
        positions = [self.array(p["attributes"]["POSITION"]).astype(np.float64) for p in self.primitives()]
        return np.concatenate(positions).min(axis=0), np.concatenate(positions).max(axis=0)

    def image(self, mi, texture):
        source = self.file["textures"][texture["index"]]["source"]
        return np.array(mi.Bitmap(str(self.folder / self.file["images"][source]["uri"])))


def texture(mi, texels, raw):
    bitmap = mi.Bitmap(np.ascontiguousarray(texels))
    bitmap.set_srgb_gamma(not raw)
    return {"type": "bitmap", "bitmap": bitmap, "raw": raw, "filter_type": "bilinear"}


def surface(mi, model, material, mirrored, kind):
    pbr = material["pbrMetallicRoughness"]
    base = model.image(mi, pbr["baseColorTexture"])
    rough = model.image(mi, pbr["metallicRoughnessTexture"])
    bsdf = {"type": kind, "base_color": texture(mi, base[..., :3], False)}
    bsdf |= {"roughness": texture(mi, rough[..., 1:2], True), "metallic": texture(mi, rough[..., 2:3], True)}
    normals = model.image(mi, material["normalTexture"])[..., :3].copy()
    if mirrored:
        normals[..., 1] = 255 - normals[..., 1]
    bsdf = {"type": "normalmap", "use_shadowing_function": False, "normalmap": texture(mi, normals, True), "bsdf": bsdf}
    bsdf = {"type": "twosided", "bsdf": bsdf}
    if material.get("alphaMode") == "BLEND":
        bsdf = {"type": "mask", "opacity": texture(mi, base[..., 3:4], True), "bsdf": bsdf}
    return bsdf


def meshes(mi, model, kind):
    """A mesh for each primitive and sign of the tangents, since Mitsuba derives bitangents from the normal alone."""
    for number, primitive in enumerate(model.primitives()):
        attributes = {name: model.array(index) for name, index in primitive["attributes"].items()}
        triangles = model.array(primitive["indices"]).reshape(-1, 3).astype(np.uint32)
        mirrored = attributes["TANGENT"][triangles[:, 0], 3] < 0
        for sign in (False, True):
            chosen = triangles[mirrored == sign]
            if len(chosen) == 0:
                continue
            material = model.file["materials"][primitive["material"]]
            properties = mi.Properties()
            properties["bsdf"] = mi.load_dict(surface(mi, model, material, sign, kind))
            count = len(attributes["POSITION"])
            mesh = mi.Mesh(f"{number}-{sign}", count, len(chosen), properties, True, True)
            parameters = mi.traverse(mesh)
            parameters["vertex_positions"] = attributes["POSITION"].ravel()
            parameters["vertex_normals"] = attributes["NORMAL"].ravel()
            parameters["vertex_texcoords"] = attributes["TEXCOORD_0"].ravel()
            parameters["faces"] = chosen.ravel()
            parameters.update()
            yield f"mesh-{number}-{int(sign)}", mesh


def environment(mi, path):
    """Mitsuba's rows run from pole to pole, and its left column looks along -z; both are exact where rows are doubled."""
    texels = np.array(mi.Bitmap(str(path)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False))
    rows = np.empty((2 * len(texels) + 1, *texels.shape[1:]), np.float32)
    rows[1::2] = texels
    rows[2:-1:2] = 0.5 * (texels[:-1] + texels[1:])
    rows[0], rows[-1] = texels[0], texels[-1]
    rolled = np.roll(rows, texels.shape[1] // 2, axis=1)
    return {"type": "envmap", "bitmap": mi.Bitmap(np.ascontiguousarray(rolled))}


def sensor(mi, model, size):
    """The camera that photonmap frames a model with."""
    low, high = model.bounds()
    extent, center = high - low, low + 0.5 * (high - low)
    fov = 40.0
    distance = 0.5 * extent[2] + 0.55 * max(extent[0], extent[1]) / np.tan(np.radians(fov / 2))
    origin = center + [0, 0, distance]
    to_world = mi.ScalarTransform4f().look_at(origin=list(origin), target=list(center), up=[0, 1, 0])
    film = {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}}
    return {"type": "perspective", "fov": fov, "fov_axis": "y", "to_world": to_world, "film": film}


def blocks(picture, block=8):
    size = len(picture) // block * block
    return picture[:size, :size].reshape(size // block, block, size // block, block, 3).mean(axis=(1, 3))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path, help="the photonmap program")
    parser.add_argument("model", type=pathlib.Path)
    parser.add_argument("environment", type=pathlib.Path)
    parser.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("out/helmet"))
    parser.add_argument("--bsdf", choices=["principled", "glossy"], default="principled")
    parser.add_argument("--variant", default="llvm_ad_rgb")
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--samples", type=int, default=512, help="paths per pixel of Mitsuba")
    parser.add_argument("--passes", type=int, default=64)
    args, further = parser.parse_known_args()  # Others are options of photonmap.
    args.folder.mkdir(parents=True, exist_ok=True)

    import drjit as dr
    import mitsuba as mi

    mi.set_variant(args.variant)
    gloss.make_bsdf(mi, dr)
    model = Model(args.model)
    scene = {"type": "scene", "sensor": sensor(mi, model, args.size), "sky": environment(mi, args.environment)}
    scene = mi.load_dict(scene | dict(meshes(mi, model, args.bsdf)))
    path = mi.load_dict({"type": "path", "max_depth": -1, "rr_depth": 32})
    # In parts, so that the memory of one rendering is bounded.
    parts = max(1, args.samples // 64)
    theirs = sum(np.array(mi.render(scene, integrator=path, spp=args.samples // parts, seed=k)) for k in range(parts))
    theirs = theirs / parts
    name = f"{args.environment.stem}-{args.bsdf}"
    files = [args.folder / f"{name}-theirs.exr", args.folder / f"{args.environment.stem}-ours.exr"]
    mi.Bitmap(theirs.astype(np.float32)).write(str(files[0]))
    program = args.program.resolve()
    command = [program, "render", args.model, "--environment", args.environment]
    command += ["--size", f"{args.size}x{args.size}", "--passes", str(args.passes), "-o", files[1]]
    subprocess.run([*map(str, command), *further], check=True, stderr=subprocess.DEVNULL)
    layers = dict(mi.Bitmap(str(files[1])).split())
    ours = np.array(layers["<root>"], dtype=np.float64)[..., :3]
    for picture, file in ((theirs, files[0]), (ours, files[1])):
        mi.util.write_bitmap(str(file.with_suffix(".png")), picture.astype(np.float32))
    print(name, "mean, ours / theirs:", (ours.mean(axis=(0, 1)) / theirs.mean(axis=(0, 1))).round(4))
    off = blocks(ours) / blocks(theirs) - 1
    print("blocks of 8 pixels: root mean square", np.sqrt((off**2).mean()).round(4), "largest", np.abs(off).max().round(4))
    subprocess.run([str(program), "compare", str(files[1]), str(files[0])], check=False)


if __name__ == "__main__":
    main()
