"""Compares textures, vertex normals and an environment map with an unbiased path tracer, Mitsuba 3 (Jakob et al. 2022).

    pip install mitsuba
    cargo build --release
    python tests/mitsuba/surfaces.py target/release/photonmap

Writes a scene of its own (a coarse sphere with smooth vertex normals, on a textured floor, under a sky), renders
it with both programs, and compares the means of the pictures and of blocks of pixels. Fails if the means differ by more
than 1 %, or a block by more than 3 % and 4.5 standard errors.
"""

import math

import numpy as np

import pair


def icosphere(levels):
    """Vertices on the unit sphere, and triangles, counter-clockwise from outside."""
    golden = (1 + 5**0.5) / 2
    vertices = [(-1, golden, 0), (1, golden, 0), (-1, -golden, 0), (1, -golden, 0)]
    vertices += [(0, -1, golden), (0, 1, golden), (0, -1, -golden), (0, 1, -golden)]
    vertices += [(golden, 0, -1), (golden, 0, 1), (-golden, 0, -1), (-golden, 0, 1)]
    vertices = [np.array(v) / np.linalg.norm(v) for v in vertices]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6)]
    faces += [(7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10)]
    faces += [(8, 6, 7), (9, 8, 1)]
    for _ in range(levels):
        middles, finer = {}, []

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                point = vertices[a] + vertices[b]
                vertices.append(point / np.linalg.norm(point))
                middles[key] = len(vertices) - 1
            return middles[key]

        for a, b, c in faces:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = finer
    return np.array(vertices), faces


def write_meshes(folder):
    """ball.obj and floor.obj, and scene.obj, which holds both."""
    vertices, faces = icosphere(1)
    ball = ["usemtl ball"]
    ball += [f"v {0.5 * x:.9g} {0.5 * y + 0.5:.9g} {0.5 * z:.9g}" for x, y, z in vertices]
    ball += [f"vn {x:.9g} {y:.9g} {z:.9g}" for x, y, z in vertices]
    ball += [f"vt {2 * x:.9g} {2 * y + z:.9g}" for x, y, z in vertices]
    ball += ["f " + " ".join(f"{i + 1}/{i + 1}/{i + 1}" for i in face) for face in faces]
    base = len(vertices)
    corners = [(-2, 2), (2, 2), (2, -2), (-2, -2)]
    texture = [(0.1, 0), (2.1, 0.3), (1.8, 1.9), (0, 1.5)]

    def floor(first):
        lines = ["usemtl floor"] + [f"v {x} 0 {z}" for x, z in corners] + [f"vt {u} {v}" for u, v in texture]
        at = [first + i for i in range(1, 5)]
        return lines + [f"f {a}/{a} {b}/{b} {c}/{c}" for a, b, c in (at[:3], (at[0], at[2], at[3]))]

    (folder / "ball.obj").write_text("\n".join(ball) + "\n")
    (folder / "floor.obj").write_text("\n".join(floor(0)) + "\n")
    (folder / "scene.obj").write_text("\n".join(["mtllib scene.mtl"] + ball + floor(base)) + "\n")
    materials = [f"newmtl {name}\nKd 1 1 1\nmap_Kd {name}.png\n" for name in ("ball", "floor")]
    (folder / "scene.mtl").write_text("\n".join(materials))
    camera = '[[cameras]]\nname = "front"\nfrom = [0.3, 1.6, 2.6]\nto = [0.0, 0.35, 0.0]\nfov_degrees = 40\n'
    sky = '[environment]\nfile = "sky.exr"\nrotate_degrees = 30\n'
    (folder / "scene.toml").write_text(camera + sky)


def radiance(direction):
    """A dim gradient with a bright, coloured patch above and to the side."""
    towards = np.array([0.6, 0.6, 0.53])
    patch = np.exp(20 * (direction @ (towards / np.linalg.norm(towards)) - 1))
    height = np.clip(direction[..., 1], 0, None)
    return np.stack([0.3 + 0.2 * height + 6 * patch, 0.3 + 0.4 * height + 5 * patch, 0.3 + 0.9 * height + 3 * patch], -1)


def directions(u, v):
    phi, theta = 2 * math.pi * (u - 0.5), math.pi * v
    return np.stack([np.sin(phi) * np.sin(theta), np.cos(theta), -np.cos(phi) * np.sin(theta)], -1)


def write_images(folder, mi):
    random = np.random.default_rng(3)
    for name in ("ball", "floor"):
        texels = random.integers(40, 256, (8, 8, 3), dtype=np.uint8)
        mi.Bitmap(texels, mi.Bitmap.PixelFormat.RGB).write(str(folder / f"{name}.png"))
    width, height = 512, 256
    # Ours: texel centres, -z in the middle. Mitsuba's: rows from pole to pole, -z at the left.
    u, v = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height)
    mi.Bitmap(radiance(directions(u, v)).astype(np.float32)).write(str(folder / "sky.exr"))
    u, v = np.meshgrid((np.arange(width) + 0.5) / width + 0.5, np.arange(height) / (height - 1))
    return mi.Bitmap(radiance(directions(u, v)).astype(np.float32))


def diffuse(image):
    """Mitsuba's surface of an image."""
    return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": image}}


def their_scene(folder, mi, surfaces):
    """Writes the scene for photonmap, and returns it for Mitsuba, with a function from image to surface for each name."""
    write_meshes(folder)
    sky = write_images(folder, mi)

    def textured(name, surface):
        image = {"type": "bitmap", "filename": str(folder / f"{name}.png"), "filter_type": "bilinear"}
        return {"type": "obj", "filename": str(folder / f"{name}.obj"), "bsdf": surface(image)}

    scene = {"type": "scene", "sensor": pair.sensor(mi, [0.3, 1.6, 2.6], [0, 0.35, 0], 40)}
    scene |= {name: textured(name, surface) for name, surface in surfaces.items()}
    # A rotation about +y by 30 degrees, counter-clockwise as seen from above.
    scene["sky"] = {"type": "envmap", "bitmap": sky, "to_world": mi.ScalarTransform4f().rotate([0, 1, 0], 30)}
    return mi.load_dict(scene)


def main():
    args = pair.arguments(__doc__, "out/surfaces", "scalar_rgb", 256)

    import mitsuba as mi

    mi.set_variant(args.variant)
    scene = their_scene(args.folder, mi, {"ball": diffuse, "floor": diffuse})
    pair.compare(*pair.render(args, scene, mi), args.folder)


if __name__ == "__main__":
    main()
