"""Compares random scenes with an unbiased path tracer, Mitsuba 3 (Jakob et al. 2022).

    pip install mitsuba
    cargo build --release
    python tests/mitsuba/random_scenes.py target/release/photonmap 0 20

renders the scenes of the seeds 0 to 19: a closed room with an area light, or a floor under an environment map, and in it four
boxes, spheres and sheets that are scaled, turned and mirrored, of materials that both programs have exactly: diffuse, with
a texture, partly cut out, partly transparent, mirrors, panes and solids of smooth glass; with and without vertex normals,
all written as glTF. Fails if the mean of a channel differs by more than one per cent and 4.5 standard errors, or that of a
block of pixels by more than 4 % and 4.5 standard errors; before that it checks, as exported.py does, that the comparison
can fail.
"""

import argparse
import base64
import json
import pathlib
import struct
import subprocess
import sys
import zlib

import numpy as np

import exported

SIZE = 48
BLOCK = 16
LIMITS = (0.01, 0.04)
KINDS = ["lambert", "texture", "mask", "blend", "mirror", "glass", "thin"]
SHEETS = ("mask", "blend", "thin")
# Corners and turns about the axes of the quads that are the walls of a room: origin, axis, angle.
WALLS = [
    ([0, 0, 0], [1, 0, 0], 0),
    ([0, 4, 0], [1, 0, 0], np.pi),
    ([0, 2, -2], [1, 0, 0], np.pi / 2),
    ([0, 2, 2], [1, 0, 0], -np.pi / 2),
    ([-2, 2, 0], [0, 0, 1], -np.pi / 2),
    ([2, 2, 0], [0, 0, 1], np.pi / 2),
]


def quad():
    """Positions, normals, texture coordinates and triangles of a square of side 2 in the plane y = 0."""
    corners = np.array([[-1, 0, 1], [1, 0, 1], [1, 0, -1], [-1, 0, -1]], float)
    normals = np.array([[0, 1, 0]] * 4, float)
    return corners, normals, np.array([[0, 1], [1, 1], [1, 0], [0, 0]], float), np.array([[0, 1, 2], [0, 2, 3]])


def box():
    parts = [], [], []
    for axis in range(3):
        for side in (-1, 1):
            for u, v in [(-1, -1), (1, -1), (1, 1), (-1, 1)][::side]:
                point, normal = np.zeros(3), np.zeros(3)
                point[[axis, (axis + 1) % 3, (axis + 2) % 3]] = side, u, v
                normal[axis] = side
                for part, value in zip(parts, (point, normal, [(u + 1) / 2, (v + 1) / 2])):
                    part.append(value)
    triangles = [[4 * face, 4 * face + k, 4 * face + k + 1] for face in range(6) for k in (1, 2)]
    return *map(np.array, parts), np.array(triangles)


def sphere(around=40, rows=20):
    points, uvs, triangles = [], [], []
    for row in range(rows + 1):
        for column in range(around + 1):
            theta, phi = np.pi * row / rows, 2 * np.pi * (column % around) / around
            sine = np.sin(theta) if 0 < row < rows else 0.0
            points.append([sine * np.cos(phi), np.cos(theta), -sine * np.sin(phi)])
            uvs.append([column / around, row / rows])
            if row < rows and column < around:
                first, below = row * (around + 1) + column, (row + 1) * (around + 1) + column
                triangles += [[first, below, first + 1]] if row > 0 else []
                triangles += [[first + 1, below, below + 1]] if row < rows - 1 else []
    return np.array(points), np.array(points), np.array(uvs), np.array(triangles)


def png(image):
    """A PNG of an array of bytes, rows of RGB or RGBA."""
    height, width, channels = image.shape
    rows = b"".join(b"\0" + row.tobytes() for row in image)

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    header = struct.pack(">IIBBBBB", width, height, 8, {3: 2, 4: 6}[channels], 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def quaternion(axis, angle):
    return np.array([*(np.array(axis) * np.sin(angle / 2)), np.cos(angle / 2)])


def matrix(quaternion):
    x, y, z, w = quaternion
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip


class Scene:
    """A scene for both programs."""

    def __init__(self, mi, rng):
        self.mi, self.rng, self.data, self.theirs = mi, rng, b"", {"type": "scene"}
        names = ("nodes", "meshes", "materials", "accessors", "bufferViews", "images", "textures", "samplers")
        self.ours = {name: [] for name in names}
        self.used = {"KHR_materials_specular"}

    def append(self, name, value):
        self.ours[name].append(value)
        return len(self.ours[name]) - 1

    def view(self, data):
        self.data += b"\0" * (-len(self.data) % 4)
        view = self.append("bufferViews", {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data)})
        self.data += data
        return view

    def accessor(self, array, kind, component):
        value = {"bufferView": self.view(array.tobytes()), "componentType": component, "count": len(array), "type": kind}
        if kind == "VEC3":
            value |= {"min": array.min(axis=0).tolist(), "max": array.max(axis=0).tolist()}
        return self.append("accessors", value)

    def texture(self, image, nearest):
        source = self.append("images", {"bufferView": self.view(png(image)), "mimeType": "image/png"})
        sampler = self.append("samplers", {"magFilter": 9728 if nearest else 9729})
        return self.append("textures", {"source": source, "sampler": sampler})

    def bitmap(self, image, nearest, raw=False):
        filtering = "nearest" if nearest else "bilinear"
        return {"type": "bitmap", "bitmap": self.mi.Bitmap(image.copy()), "raw": raw, "filter_type": filtering}

    def material(self, kind, emission=None):
        """Index of a new material, and the same as a BSDF."""
        rng = self.rng
        color = rng.uniform(0.15, 0.85, 3).tolist()
        base, extensions = {"metallicFactor": 0.0}, {"KHR_materials_specular": {"specularFactor": 0.0}}
        material = {"pbrMetallicRoughness": base, "extensions": extensions}
        diffuse = {"type": "diffuse", "reflectance": {"type": "rgb", "value": color}}
        bsdf = {"type": "twosided", "bsdf": diffuse}
        base["baseColorFactor"] = [*color, 1.0]
        if kind in ("texture", "mask"):
            image, nearest = rng.integers(30, 250, (8, 8, 4)).astype(np.uint8), kind == "mask"
            image[..., 3] = np.where(rng.random((8, 8)) < 0.4, 0, 255)
            del base["baseColorFactor"]
            base["baseColorTexture"] = {"index": self.texture(image if nearest else image[..., :3], nearest)}
            diffuse["reflectance"] = self.bitmap(image[..., :3], nearest)
            if nearest:
                material["alphaMode"] = "MASK"
                bsdf = {"type": "mask", "bsdf": bsdf, "opacity": self.bitmap(image[..., [3, 3, 3]], True, raw=True)}
        elif kind == "blend":
            alpha = rng.uniform(0.2, 0.8)
            base["baseColorFactor"][3], material["alphaMode"] = alpha, "BLEND"
            bsdf = {"type": "mask", "bsdf": bsdf, "opacity": float(alpha)}
        elif kind == "mirror":
            base |= {"metallicFactor": 1.0, "roughnessFactor": 0.0, "baseColorFactor": [1, 1, 1, 1]}
            bsdf = {"type": "twosided", "bsdf": {"type": "conductor", "material": "none"}}
        elif kind in ("glass", "thin"):
            ior = float(rng.uniform(1.2, 1.8))
            base["roughnessFactor"] = 0.0
            extensions.clear()
            extensions |= {"KHR_materials_transmission": {"transmissionFactor": 1.0}, "KHR_materials_ior": {"ior": ior}}
            bsdf = {"type": "dielectric" if kind == "glass" else "thindielectric", "int_ior": ior, "ext_ior": 1.0}
            if kind == "glass":
                base["baseColorFactor"] = [1, 1, 1, 1]
                extensions["KHR_materials_volume"] = {"thicknessFactor": 1.0}
            else:
                bsdf["specular_transmittance"] = {"type": "rgb", "value": color}
        if emission is not None:
            strength = max(emission)
            material["emissiveFactor"] = [channel / strength for channel in emission]
            extensions["KHR_materials_emissive_strength"] = {"emissiveStrength": strength}
        self.used |= set(extensions)
        return self.append("materials", material), bsdf

    def add(self, shape, kind, scale, turn, translation, smooth=False, emission=None):
        """A mesh, scaled, turned by a quaternion, and moved."""
        mi = self.mi
        index, bsdf = self.material(kind, emission)
        positions, normals, uvs, triangles = shape
        attributes = {"POSITION": self.accessor(positions.astype(np.float32), "VEC3", 5126)}
        attributes["TEXCOORD_0"] = self.accessor(uvs.astype(np.float32), "VEC2", 5126)
        if smooth:
            attributes["NORMAL"] = self.accessor(normals.astype(np.float32), "VEC3", 5126)
        indices = self.accessor(triangles.astype(np.uint32).ravel(), "SCALAR", 5125)
        mesh = self.append(
            "meshes", {"primitives": [{"attributes": attributes, "indices": indices, "material": index}]}
        )
        node = {"mesh": mesh, "rotation": list(map(float, turn)), "scale": list(map(float, scale))}
        name = f"object {self.append('nodes', node | {'translation': list(map(float, translation))})}"

        properties = mi.Properties()
        properties["bsdf"] = mi.load_dict(bsdf)
        if emission is not None:
            radiance = {"type": "rgb", "value": emission}
            properties["emitter"] = mi.load_dict({"type": "area", "radiance": radiance})
        if np.prod(scale) < 0:
            triangles = triangles[:, ::-1]
        theirs = mi.Mesh(name, len(positions), len(triangles), properties, smooth, True)
        parameters = mi.traverse(theirs)
        to_world = matrix(turn)
        turned = (normals / scale) @ to_world.T
        parameters["vertex_positions"] = ((positions * scale) @ to_world.T + translation).astype(np.float32).ravel()
        parameters["faces"] = triangles.astype(np.uint32).ravel()
        parameters["vertex_texcoords"] = uvs.astype(np.float32).ravel()
        if smooth:
            lengths = np.linalg.norm(turned, axis=1, keepdims=True)
            parameters["vertex_normals"] = (turned / lengths).astype(np.float32).ravel()
        parameters.update()
        self.theirs[name] = theirs

    def write(self, path):
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
        root = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(len(self.ours["nodes"])))}]}
        root |= {name: values for name, values in self.ours.items() if values}
        root |= {"buffers": [{"byteLength": len(self.data), "uri": uri}], "extensionsUsed": sorted(self.used)}
        path.write_text(json.dumps(root))


def make(mi, seed, folder):
    """A scene in scene.gltf, scene.toml and environment.exr of the folder; the same for Mitsuba, and its description."""
    rng = np.random.default_rng(seed)
    scene = Scene(mi, rng)
    overrides, still = [], quaternion([1, 0, 0], 0)
    is_room = rng.random() < 0.6
    if is_room:
        for at, axis, angle in WALLS:
            scene.add(quad(), rng.choice(["lambert", "texture"]), (2, 1, 2), quaternion(axis, angle), at)
        at = [rng.uniform(-0.8, 0.8), 3.9, rng.uniform(-0.8, 0.8)]
        radiance = rng.uniform(5, 15, 3).tolist()
        scene.add(quad(), "lambert", (0.7, 1, 0.7), quaternion([1, 0, 0], np.pi), at, emission=radiance)
    else:
        scene.add(quad(), rng.choice(["lambert", "texture"]), (2, 1, 2), still, [0, 0, 0])
        # Large even cells, since the programs interpolate between texels differently.
        cells = rng.uniform(0.2, 1, (16, 32, 3)).astype(np.float32)
        cells[rng.integers(2, 6), rng.integers(0, 32)] *= 20
        image = mi.Bitmap(cells.repeat(64, axis=0).repeat(64, axis=1))
        image.write(str(folder / "environment.exr"))
        to_world = mi.ScalarTransform4f().rotate([0, 1, 0], 180)
        scene.theirs["environment"] = {"type": "envmap", "bitmap": image, "to_world": to_world}
        overrides += ["[environment]", 'file = "environment.exr"']
    described = ["room" if is_room else "environment"]
    for kind, (x, z) in zip(rng.choice(KINDS, 4), rng.permutation([(-1, -1), (1, -1), (-1, 0.9), (1, 0.9)])):
        shapes = ["box", "sphere"] + (["quad"] if kind in SHEETS else [])
        name = rng.choice(shapes)
        smooth = bool(name == "sphere" and kind != "thin" and rng.random() < 0.7)
        scale = rng.uniform(0.35, 0.6, 3) * np.where(rng.random(3) < 0.3, -1, 1)
        turn = rng.normal(size=4)
        shape = {"box": box, "sphere": sphere, "quad": quad}[name]()
        scene.add(shape, kind, scale, turn / np.linalg.norm(turn), [x, rng.uniform(1.1, 1.6), z], smooth)
        described.append(f"{kind} {name}{' with normals' if smooth else ''}")
    eye, target, fov = [rng.uniform(-1.2, 1.2), rng.uniform(1.5, 3.2), 1.85], [0.0, 1.2, -0.2], 65.0
    overrides += ["[[cameras]]", 'name = "main"', f"from = {eye}", f"to = {target}", f"fov_degrees = {fov}"]
    (folder / "scene.toml").write_text("\n".join(overrides) + "\n")
    scene.write(folder / "scene.gltf")
    film = {"type": "hdrfilm", "width": SIZE, "height": SIZE, "rfilter": {"type": "box"}, "pixel_format": "rgb"}
    to_world = mi.ScalarTransform4f().look_at(origin=eye, target=target, up=[0, 1, 0])
    scene.theirs["sensor"] = {"type": "perspective", "fov": fov, "fov_axis": "y", "to_world": to_world, "film": film}
    return mi.load_dict(scene.theirs), ", ".join(described)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path, help="the photonmap program")
    parser.add_argument("first", type=int, help="the first seed")
    parser.add_argument("count", type=int, help="the number of scenes")
    parser.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("out/random"))
    parser.add_argument("--variant", default="llvm_ad_rgb")
    parser.add_argument("--samples", type=int, default=128, help="paths per pixel and run of Mitsuba")
    parser.add_argument("--runs", type=int, default=4, help="runs of each with different seeds, at least 4")
    parser.add_argument("--passes", type=int, default=10)
    args, further = parser.parse_known_args()
    if args.runs < 4:
        parser.error("at least 4 runs are needed")

    import mitsuba as mi

    mi.set_variant(args.variant)
    args.folder.mkdir(parents=True, exist_ok=True)
    different = []
    for seed in range(args.first, args.first + args.count):
        scene, described = make(mi, seed, args.folder)
        path = mi.load_dict({"type": "path", "max_depth": -1, "rr_depth": 32})
        ours, theirs = [], []
        for run in range(args.runs):
            theirs.append(np.array(mi.render(scene, integrator=path, spp=args.samples, seed=run), dtype=np.float64))
            picture = args.folder / f"ours-{run}.exr"
            command = [args.program, "render", args.folder / "scene.gltf", "--overrides", args.folder / "scene.toml"]
            command += ["--size", f"{SIZE}x{SIZE}", "--passes", args.passes, "--seed", run, "-o", picture]
            # Mitsuba's shadow rays start at the triangles.
            command += [*exported.OURS, "--no-terminator-offset", *further]
            subprocess.run(list(map(str, command)), check=True, stderr=subprocess.DEVNULL)
            layers = dict(mi.Bitmap(str(picture)).split())
            ours.append(np.array(layers["<root>"], dtype=np.float64)[..., :3])
        ours, theirs = np.array(ours), np.array(theirs)[..., :3]
        if not exported.compare(ours * [1.1, 1.0, 1.0], theirs, BLOCK, LIMITS)[1]:
            sys.exit(f"seed {seed}: too noisy, a picture 10 % too bright in red would pass; use more samples or runs")
        lines, differ = exported.compare(ours, theirs, BLOCK, LIMITS)
        print(f"seed {seed}: {described}", *lines, sep="\n  ", flush=True)
        different += [seed] if differ else []
    if different:
        sys.exit(f"the pictures differ: seeds {different}")


if __name__ == "__main__":
    main()
