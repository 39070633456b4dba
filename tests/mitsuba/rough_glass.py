"""Compares rough glass with an unbiased path tracer, Mitsuba 3 (Jakob et al. 2022).

    pip install mitsuba
    cargo build --release
    python tests/mitsuba/rough_glass.py target/release/photonmap

A ball of rough glass stands on a diffuse floor, under an area light and an even sky.
Mitsuba leaves out multiple scattering, and its G2 is a product; both matter little at the width of 0.02 taken here. Fails like
surfaces.py.
"""

import pair
import surfaces

ALPHA = 0.02
LIGHT = 12.0
SKY = 0.3
FLOOR = [0.6, 0.5, 0.4]


def write_meshes(folder):
    """scene.obj of ball, floor and light, and one file for each of them."""
    vertices, faces = surfaces.icosphere(4)
    parts = {
        "ball": ([(0.5 * x, 0.5 * y + 0.502, 0.5 * z) for x, y, z in vertices], [[i + 1 for i in face] for face in faces]),
        "floor": ([(-3, 0, 3), (3, 0, 3), (3, 0, -3), (-3, 0, -3)], [[1, 2, 3], [1, 3, 4]]),
        "light": ([(-1.2, 2, -0.5), (-0.4, 2, -0.5), (-0.4, 2, 0.3), (-1.2, 2, 0.3)], [[1, 2, 3], [1, 3, 4]]),
    }
    pair.write_meshes(folder, parts)


def main():
    args = pair.arguments(__doc__, "out/rough-glass", "llvm_ad_rgb", 2048)

    import mitsuba as mi

    mi.set_variant(args.variant)
    write_meshes(args.folder)
    eye, target, fov = [0.6, 1.3, 2.6], [0.0, 0.4, 0.0], 40.0
    materials = {
        "ball": f'{{ kind = "glass", ior = 1.5, roughness = {ALPHA**0.5} }}',
        "floor": f'{{ kind = "lambert", albedo = {FLOOR} }}',
        "light": f'{{ kind = "lambert", albedo = 0.0, emission = {LIGHT} }}',
    }
    pair.write_overrides(args, materials, SKY, eye, target, fov)

    bsdfs = {
        "ball": {"type": "roughdielectric", "distribution": "ggx", "alpha": ALPHA, "int_ior": 1.5, "ext_ior": 1.0},
        "floor": {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": FLOOR}}},
        "light": {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}},
    }
    scene = pair.scene_of_meshes(args, mi, bsdfs, LIGHT, SKY, eye, target, fov)
    pair.compare(*pair.render(args, scene, mi), args.folder)


if __name__ == "__main__":
    main()
