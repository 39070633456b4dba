"""Everyday models beside Mitsuba 3: textured glTF files in the open, lit by an image of the surroundings.

    python -m studies.peers.everyday prepare MODEL.gltf SKY.exr FOLDER
    python -m studies.peers.everyday measure FOLDER --seconds 4 --variant cuda_ad_rgb

`prepare` converts the model for Mitsuba, since `photonmap export` refuses textures and vertex normals: its textures become those of
the `principled` BSDF, and camera and environment are those that `photonmap export` writes for the model without them. `measure`
renders with both for the same time. Each is compared with a long render of its own, since the two materials are not quite the
same.
"""

import argparse
import json
import pathlib
import subprocess
import time
import xml.etree.ElementTree as ET

import numpy as np

from .scene import edited

SIZE = 512


def without_textures(root):
    """Removes textures and vertex attributes, and makes all of metal, so that `photonmap export` writes camera and lights."""
    root["materials"] = [{"pbrMetallicRoughness": {"metallicFactor": 1}} for _ in root["materials"]]
    for mesh in root["meshes"]:
        for primitive in mesh["primitives"]:
            primitive["attributes"] = {"POSITION": primitive["attributes"]["POSITION"]}


def plain(model):
    """A copy of a model without textures, beside it, where it finds its buffers."""
    path = model.with_name(f".plain-{model.name}")
    if model.suffix == ".glb":
        path.write_bytes(edited(model.read_bytes(), without_textures))
    else:
        root = json.loads(model.read_text())
        without_textures(root)
        path.write_text(json.dumps(root))
    return path


def write_ply(path, positions, normals, uvs, faces):
    names = ["x", "y", "z", "nx", "ny", "nz", "u", "v"]
    rows = np.hstack([positions, normals, uvs]).astype("<f4")
    records = np.zeros(len(faces), np.dtype([("n", "u1"), ("v", "<i4", 3)]))
    records["n"], records["v"] = 3, faces
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(rows)}"]
    header += [f"property float {name}" for name in names]
    header += [f"element face {len(faces)}", "property list uchar int vertex_index", "end_header", ""]
    path.write_bytes("\n".join(header).encode() + rows.tobytes() + records.tobytes())


def texture(parent, name, image, path, raw):
    image.save(path)
    element = ET.SubElement(parent, "texture", type="bitmap", name=name)
    ET.SubElement(element, "string", name="filename", value=path.name)
    ET.SubElement(element, "boolean", name="raw", value="true" if raw else "false")


def bsdf(parent, material, stem, folder):
    """The `principled` BSDF of a glTF material: roughness is green and metallic is blue in one image."""
    from PIL import Image

    outer = parent
    if material.alphaMode in ("BLEND", "MASK") and material.baseColorTexture is not None:
        outer = ET.SubElement(outer, "bsdf", type="mask")
        texture(outer, "opacity", material.baseColorTexture.getchannel("A"), folder / f"{stem}-opacity.png", True)
    if material.doubleSided:
        outer = ET.SubElement(outer, "bsdf", type="twosided")
    if material.normalTexture is not None:
        outer = ET.SubElement(outer, "bsdf", type="normalmap")
        # Green is up in glTF, against the direction of v; here it is along v.
        red, green, blue = material.normalTexture.convert("RGB").split()
        turned = Image.merge("RGB", (red, green.point(lambda value: 255 - value), blue))
        texture(outer, "normalmap", turned, folder / f"{stem}-normal.png", True)
    inner = ET.SubElement(outer, "bsdf", type="principled")
    factor = material.baseColorFactor
    colour = [1.0, 1.0, 1.0] if factor is None else [c / 255 for c in factor[:3]]
    if material.baseColorTexture is None:
        ET.SubElement(inner, "rgb", name="base_color", value=" ".join(map(str, colour)))
    elif min(colour) < 1:
        raise SystemExit(f"{stem}: a texture with a factor is not converted")
    else:
        texture(inner, "base_color", material.baseColorTexture.convert("RGB"), folder / f"{stem}-colour.png", False)
    for name, channel, value in [("roughness", 1, material.roughnessFactor), ("metallic", 2, material.metallicFactor)]:
        value = 1.0 if value is None else value
        image = material.metallicRoughnessTexture
        if image is None:
            ET.SubElement(inner, "float", name=name, value=str(value))
        else:
            scaled = np.asarray(image.convert("RGB"), float)[..., channel] * value
            texture(inner, name, Image.fromarray(np.uint8(scaled.round())), folder / f"{stem}-{name}.png", True)


def prepare(args):
    import trimesh

    folder, model = args.folder.resolve(), args.model.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    copy = plain(model)
    command = [args.program, "export", copy, "--environment", args.sky.resolve(), "--size", f"{SIZE}x{SIZE}"]
    subprocess.run([*command, "-o", folder / "plain.xml"], check=True)
    copy.unlink()
    root = ET.parse(folder / "plain.xml").getroot()
    for shape in root.findall("shape"):
        root.remove(shape)
    scene = trimesh.load(model, force="scene")
    for number, node in enumerate(scene.graph.nodes_geometry):
        transform, name = scene.graph[node]
        mesh = scene.geometry[name].copy()
        mesh.apply_transform(transform)
        path = folder / f"{number}.ply"
        uvs = np.zeros((len(mesh.vertices), 2)) if mesh.visual.uv is None else np.array(mesh.visual.uv)
        # The first row of an image is at v = 0, as in the file.
        uvs[:, 1] = 1 - uvs[:, 1]
        write_ply(path, mesh.vertices, mesh.vertex_normals, uvs, mesh.faces)
        shape = ET.SubElement(root, "shape", type="ply")
        ET.SubElement(shape, "string", name="filename", value=path.name)
        bsdf(shape, mesh.visual.material, str(number), folder)
    ET.indent(root)
    ET.ElementTree(root).write(folder / "scene.xml")
    job = {"model": str(model), "sky": str(args.sky.resolve())}
    (folder / "job.json").write_text(json.dumps(job))


def picture(path):
    """The picture of an EXR file of photonmap."""
    import mitsuba as mi

    layers = dict(mi.Bitmap(str(path)).split())
    return np.array(layers["<root>"].convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float64, False))


def theirs(folder, seconds, seed):
    """Pictures of 16 samples of a pixel are added up until the time is over; loading and compiling count for nothing."""
    import mitsuba as mi

    scene = mi.load_file(str(folder / "scene.xml"))
    integrator = mi.load_dict({"type": "path", "max_depth": -1})
    np.array(mi.render(scene, integrator=integrator, spp=16, seed=seed))
    total, count, begun = 0.0, 0, time.perf_counter()
    while count == 0 or time.perf_counter() - begun < seconds:
        count += 1
        total = total + np.array(mi.render(scene, integrator=integrator, spp=16, seed=seed + count), np.float64)
    return total / count, count * 16


def ours(args, job, seconds, seed):
    path = args.folder / "ours.exr"
    backend = "vulkan" if args.variant.startswith("cuda") else "cpu"
    command = [args.program, "render", job["model"], "--environment", job["sky"], "--size", str(SIZE)]
    command += ["--backend", backend, "--time", str(seconds), "--set", f"seed={seed}", "-o", str(path)]
    subprocess.run(command, check=True, capture_output=True)
    return picture(path)


def rel_mse(found, reference):
    """As `photonmap compare`."""
    return np.mean((found - reference) ** 2 / (reference**2 + reference.mean() ** 2 / 100))


def measure(args):
    import mitsuba as mi

    mi.set_variant(args.variant)
    job = json.loads((args.folder / "job.json").read_text())
    job = {key: str(args.folder / value) for key, value in job.items()}
    ours(args, job, args.seconds, 1)
    own = ours(args, job, args.reference, 1000)
    other, samples = theirs(args.folder, args.reference, 1_000_000)
    print(f"means {own.mean():.6g} and {other.mean():.6g}; relMSE between them {rel_mse(own, other):.3g}")
    for seed in (1, 2):
        mine = rel_mse(ours(args, job, args.seconds, seed), own)
        found, samples = theirs(args.folder, args.seconds, 100_000 * seed)
        their = rel_mse(found, other)
        print(f"relMSE after {args.seconds:g} s: {mine:.3g}, Mitsuba {their:.3g} ({samples} spp): {mine / their:.2f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True)
    first = commands.add_parser("prepare")
    first.add_argument("model", type=pathlib.Path)
    first.add_argument("sky", type=pathlib.Path)
    first.set_defaults(run=prepare)
    second = commands.add_parser("measure")
    second.add_argument("--seconds", type=float, default=4)
    second.add_argument("--reference", type=float, default=60, help="seconds of the references")
    second.add_argument("--variant", default="cuda_ad_rgb")
    second.set_defaults(run=measure)
    for command in (first, second):
        command.add_argument("folder", type=pathlib.Path)
        command.add_argument("--program", default="target/release/photonmap")
    args = parser.parse_args()
    args.run(args)


if __name__ == "__main__":
    main()
