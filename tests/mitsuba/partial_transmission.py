"""Compares surfaces that are partly glass with an unbiased path tracer, Mitsuba 3 (Jakob et al. 2022).

    pip install mitsuba
    cargo build --release
    python tests/mitsuba/partial_transmission.py target/release/photonmap

Two coloured sheets and a block stand between an area light and a white floor with a wall, under a dim, even sky. A
share of each is glass and the rest is diffuse: Mitsuba's `blendbsdf` of `thindielectric` or `dielectric` with
`diffuse`. Its weight is a random texture of zeros and ones. With one number in between, Mitsuba 3.9.1 adds the density
of the diffuse part to the probability of a mirror reflection, and loses part of what glass reflects. Fails like
surfaces.py.
"""

import numpy as np

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
        quads = sides if name == "block" else [(0, 1, 2, 3)]
        lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for quad in quads for x, y, z in (points[corner] for corner in quad)]
        coordinates = ["vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1"]

        def faces(first, with_coordinates):
            halves = [(4 * quad, half) for quad in range(len(quads)) for half in ((0, 1, 2), (0, 2, 3))]
            place = (lambda at, c: f"{at}/{c + 1}") if with_coordinates else (lambda at, c: f"{at}")
            return ["f " + " ".join(place(first + at + c + 1, c) for c in half) for at, half in halves]

        whole += [f"usemtl {name}", *lines, *faces(base, False)]
        (folder / f"{name}.obj").write_text("\n".join([*lines, *coordinates, *faces(0, True)]) + "\n")
        base += len(lines)
    (folder / "scene.obj").write_text("\n".join(whole) + "\n")


def weights(mi, share):
    """A texture of which a share is 1 and the rest 0, in random order."""
    side = 256
    texels = np.zeros(side * side, dtype=np.float32)
    texels[: round(share * side * side)] = 1
    np.random.default_rng(1).shuffle(texels)
    bitmap = mi.Bitmap(texels.reshape(side, side, 1))
    return {"type": "bitmap", "bitmap": bitmap, "raw": True, "filter_type": "nearest"}


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
    black = {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}}
    bsdfs = {"floor": diffuse(WALL), "wall": diffuse(WALL), "light": black}
    for name, (color, share, ior, is_solid) in SURFACES.items():
        keys = f"albedo = {color}, specular = 0, roughness = 0, ior = {ior}, transmission = {share}"
        materials[name] = f'{{ kind = "glossy", {keys}{", absorption = 0" if is_solid else ""} }}'
        glass = {"type": "dielectric" if is_solid else "thindielectric", "int_ior": ior, "ext_ior": 1.0}
        glass["specular_transmittance"] = {"type": "rgb", "value": color}
        # The weight is that of the second.
        bsdfs[name] = {"type": "blendbsdf", "weight": weights(mi, share), "opaque": diffuse(color), "second": glass}
    pair.write_overrides(args, materials, SKY, eye, target, fov)
    scene = pair.scene_of_meshes(args, mi, bsdfs, LIGHT, SKY, eye, target, fov)
    pair.compare(*pair.render(args, scene, mi), args.folder)


if __name__ == "__main__":
    main()
