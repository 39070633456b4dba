"""Compares anisotropic metal with an unbiased path tracer, Mitsuba 3 (Jakob et al. 2022).

    pip install mitsuba
    cargo build --release
    python tests/mitsuba/anisotropy.py target/release/photonmap

Two metal plates before a diffuse wall, under a long area light and an even sky: highlights are stretched along the texture
coordinate u on the left plate, and across it on the right one. Mitsuba leaves out multiple scattering, and its G2 is a
product; both matter little at the widths of 0.02 and 0.06 taken here. Fails like surfaces.py.
"""

import pair

ROUGHNESS = 0.02**0.5
STRENGTH = 0.2
LIGHT = 40.0
SKY = 0.3
WALL = 0.6


def write_meshes(folder):
    """scene.obj of two plates, a wall and a light, and one file for each of them."""
    parts = {
        "along": [(-1.5, 0, 1.5), (0, 0, 1.5), (0, 0, -1.5), (-1.5, 0, -1.5)],
        "across": [(0, 0, 1.5), (1.5, 0, 1.5), (1.5, 0, -1.5), (0, 0, -1.5)],
        "wall": [(-1.5, 0, -1.5), (1.5, 0, -1.5), (1.5, 1.5, -1.5), (-1.5, 1.5, -1.5)],
        "light": [(-1.2, 1.6, -1.2), (1.2, 1.6, -1.2), (1.2, 1.6, -1.1), (-1.2, 1.6, -1.1)],
    }
    coordinates = ["vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1"]
    whole, base = [], 0
    for name, points in parts.items():
        lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in points] + coordinates
        corners = lambda face: "f " + " ".join(f"{base + i}/{base + i}" for i in face)
        whole += [f"usemtl {name}", *lines, corners([1, 2, 3]), corners([1, 3, 4])]
        base, before = 0, base
        (folder / f"{name}.obj").write_text("\n".join([*lines, corners([1, 2, 3]), corners([1, 3, 4])]) + "\n")
        base = before + 4
    (folder / "scene.obj").write_text("\n".join(whole) + "\n")


def main():
    args = pair.arguments(__doc__, "out/anisotropy", "llvm_ad_rgb", 1024)

    import mitsuba as mi

    mi.set_variant(args.variant)
    write_meshes(args.folder)
    eye, target, fov = [0.0, 1.8, 2.6], [0.0, 0.0, 0.0], 45.0
    metal = f'kind = "glossy", albedo = 1.0, metallic = 1.0, roughness = {ROUGHNESS}, anisotropy = {STRENGTH}'
    materials = {
        "along": f"{{ {metal} }}",
        "across": f"{{ {metal}, anisotropy_degrees = 90 }}",
        "wall": f'{{ kind = "lambert", albedo = {WALL} }}',
        "light": f'{{ kind = "lambert", albedo = 0.0, emission = {LIGHT} }}',
    }
    pair.write_overrides(args, materials, SKY, eye, target, fov)

    least = ROUGHNESS**2
    widths = [least + (1 - least) * STRENGTH**2, least]
    rough = {"type": "roughconductor", "distribution": "ggx", "material": "none"}
    bsdfs = {
        "along": {"type": "twosided", "bsdf": {**rough, "alpha_u": widths[0], "alpha_v": widths[1]}},
        "across": {"type": "twosided", "bsdf": {**rough, "alpha_u": widths[1], "alpha_v": widths[0]}},
        "wall": {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": WALL}}},
        "light": {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}},
    }
    scene = pair.scene_of_meshes(args, mi, bsdfs, LIGHT, SKY, eye, target, fov)
    pair.compare(*pair.render(args, scene, mi), args.folder)


if __name__ == "__main__":
    main()
