"""Compares surfaces that are partly glass with an unbiased path tracer, Mitsuba 3 (Jakob et al. 2022).

    pip install mitsuba
    cargo build --release
    python tests/mitsuba/partial_transmission.py target/release/photonmap

Two coloured sheets and a block stand between an area light and a white floor with a wall, under a dim, even sky. A share of
each is glass and the rest is diffuse: Mitsuba's `blendbsdf` of `thindielectric` or `dielectric` with `diffuse`. Fails like
surfaces.py.
"""

import pair
from diffuse_transmission import LIGHT, SKY, WALL

# Colour, share of glass, index of refraction, and whether it is a solid.
SURFACES = {
    "screen": ([0.5, 0.9, 0.2], 0.6, 1.5, False),
    "paper": ([0.9, 0.6, 0.4], 0.25, 1.5, False),
    "block": ([0.8, 0.85, 0.9], 0.5, 1.4, True),
}


def write_meshes(folder):
    """scene.obj of two sheets, a block, a floor, a wall and a light, and one file for each of them."""
    low, high = (-0.35, 0.05, 0.7), (0.3, 0.4, 1.1)
    corners = [tuple((low, high)[i >> axis & 1][axis] for axis in range(3)) for i in range(8)]
    sides = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    parts = {
        "screen": [(-1.2, 0.1, 0.2), (-0.1, 0.1, 0.6), (-0.1, 1.1, 0.3), (-1.2, 1.1, -0.1)],
        "paper": [(0.1, 0.1, 0.6), (1.3, 0.4, 0.3), (1.3, 1.0, -0.5), (0.1, 0.9, -0.1)],
        "block": corners,
        "floor": [(-2, 0, 2), (2, 0, 2), (2, 0, -1.5), (-2, 0, -1.5)],
        "wall": [(-2, 0, -1.5), (2, 0, -1.5), (2, 2, -1.5), (-2, 2, -1.5)],
        "light": [(-0.4, 1.9, -0.9), (0.4, 1.9, -0.9), (0.4, 1.9, -0.4), (-0.4, 1.9, -0.4)],
    }
    whole, base = [], 0
    for name, points in parts.items():
        lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in points]
        quads = sides if name == "block" else [(0, 1, 2, 3)]
        halves = [half for a, b, c, d in quads for half in ((a, b, c), (a, c, d))]

        def faces(first):
            return ["f " + " ".join(str(first + vertex + 1) for vertex in half) for half in halves]

        whole += [f"usemtl {name}", *lines, *faces(base)]
        (folder / f"{name}.obj").write_text("\n".join([*lines, *faces(0)]) + "\n")
        base += len(points)
    (folder / "scene.obj").write_text("\n".join(whole) + "\n")


def main():
    args = pair.arguments(__doc__, "out/partial-transmission", "llvm_ad_rgb", 2048)

    import mitsuba as mi

    mi.set_variant(args.variant)
    write_meshes(args.folder)
    eye, target, fov = [0.3, 1.3, 3.0], [0.0, 0.6, 0.0], 45.0

    def diffuse(color):
        return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": color}}}

    materials = {name: f'{{ kind = "lambert", albedo = {WALL} }}' for name in ("floor", "wall")}
    materials["light"] = f'{{ kind = "lambert", albedo = 0.0, emission = {LIGHT} }}'
    bsdfs = {"floor": diffuse(WALL), "wall": diffuse(WALL), "light": {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}}}
    for name, (color, share, ior, is_solid) in SURFACES.items():
        keys = f"albedo = {color}, specular = 0, roughness = 0, ior = {ior}, transmission = {share}"
        materials[name] = f'{{ kind = "glossy", {keys}{", absorption = 0" if is_solid else ""} }}'
        glass = {"type": "dielectric" if is_solid else "thindielectric", "int_ior": ior, "ext_ior": 1.0}
        glass["specular_transmittance"] = {"type": "rgb", "value": color}
        # The weight is that of the second.
        bsdfs[name] = {"type": "blendbsdf", "weight": share, "opaque": diffuse(color), "second": glass}
    pair.write_overrides(args, materials, SKY, eye, target, fov)
    scene = pair.scene_of_meshes(args, mi, bsdfs, LIGHT, SKY, eye, target, fov)
    pair.compare(*pair.render(args, scene, mi), args.folder)


if __name__ == "__main__":
    main()
