"""Compares diffuse transmission with an unbiased path tracer, Mitsuba 3 (Jakob et al. 2022).

    pip install mitsuba
    cargo build --release
    python tests/mitsuba/diffuse_transmission.py target/release/photonmap

Two coloured sheets stand between an area light and a white floor with a wall, under a dim, even sky: both are seen with
light from behind and from the front, and colour the floor in their shadow. Mitsuba has no BSDF that is Lambertian on both
sides, so that one is defined here. Fails like surfaces.py.
"""

import numpy as np

import pair

LIGHT = 30.0
SKY = 0.2
WALL = 0.7
# Albedo, share that transmits, and colour of transmission.
LEAVES = {
    "leaf": ([0.3, 0.5, 0.1], 0.6, [0.6, 0.8, 0.1]),
    "paper": ([0.9, 0.85, 0.7], 0.3, [0.9, 0.7, 0.4]),
}


def write_meshes(folder):
    """scene.obj of two sheets, a floor, a wall and a light, and one file for each of them."""
    parts = {
        "leaf": [(-1.2, 0.1, 0.2), (-0.1, 0.1, 0.6), (-0.1, 1.1, 0.3), (-1.2, 1.1, -0.1)],
        "paper": [(0.1, 0.1, 0.6), (1.3, 0.4, 0.3), (1.3, 1.0, -0.5), (0.1, 0.9, -0.1)],
        "floor": [(-2, 0, 2), (2, 0, 2), (2, 0, -1.5), (-2, 0, -1.5)],
        "wall": [(-2, 0, -1.5), (2, 0, -1.5), (2, 2, -1.5), (-2, 2, -1.5)],
        "light": [(-0.4, 1.9, -0.9), (0.4, 1.9, -0.9), (0.4, 1.9, -0.4), (-0.4, 1.9, -0.4)],
    }
    whole, base = [], 0
    for name, points in parts.items():
        lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in points]

        def faces(first):
            return [f"f {first + 1} {first + 2} {first + 3}", f"f {first + 1} {first + 3} {first + 4}"]

        whole += [f"usemtl {name}", *lines, *faces(base)]
        (folder / f"{name}.obj").write_text("\n".join([*lines, *faces(0)]) + "\n")
        base += 4
    (folder / "scene.obj").write_text("\n".join(whole) + "\n")


def make_bsdf(mi, dr):
    class Leaf(mi.BSDF):
        """Lambertian reflection of `reflected` and transmission of `transmitted`, alike from both sides."""

        def __init__(self, props):
            mi.BSDF.__init__(self, props)
            self.reflected, self.transmitted = [
                mi.Color3f([props[f"{part}_{i}"] for i in range(3)]) for part in ("reflected", "transmitted")
            ]
            sides = mi.BSDFFlags.FrontSide | mi.BSDFFlags.BackSide
            self.m_components = [mi.BSDFFlags.DiffuseReflection | sides, mi.BSDFFlags.DiffuseTransmission | sides]
            self.m_flags = self.m_components[0] | self.m_components[1]

        def value(self, si, wo, active):
            cos_i, cos_o = mi.Frame3f.cos_theta(si.wi), mi.Frame3f.cos_theta(wo)
            albedo = dr.select(cos_i * cos_o > 0, self.reflected, self.transmitted)
            return dr.select(active & (cos_i != 0), albedo * (dr.abs(cos_o) / np.pi), 0)

        def density(self, wo, active):
            return dr.select(active, 0.5 * dr.abs(mi.Frame3f.cos_theta(wo)) / np.pi, 0)

        def sample(self, ctx, si, sample1, sample2, active=True):
            up = mi.warp.square_to_cosine_hemisphere(sample2)
            stays = sample1 < 0.5
            up.z = dr.select(stays == (mi.Frame3f.cos_theta(si.wi) > 0), up.z, -up.z)
            found = mi.BSDFSample3f()
            found.wo = up
            found.pdf = self.density(up, active)
            found.eta = 1.0
            kinds = [mi.UInt32(+kind) for kind in (mi.BSDFFlags.DiffuseReflection, mi.BSDFFlags.DiffuseTransmission)]
            found.sampled_type = dr.select(stays, *kinds)
            found.sampled_component = dr.select(stays, mi.UInt32(0), mi.UInt32(1))
            return found, dr.select(active & (found.pdf > 0), self.value(si, up, active) / found.pdf, 0)

        def eval(self, ctx, si, wo, active=True):
            return self.value(si, wo, active)

        def pdf(self, ctx, si, wo, active=True):
            return self.density(wo, active)

        def eval_pdf(self, ctx, si, wo, active=True):
            return self.value(si, wo, active), self.density(wo, active)

    mi.register_bsdf("leaf", Leaf)


def main():
    args = pair.arguments(__doc__, "out/diffuse-transmission", "llvm_ad_rgb", 1024)

    import drjit as dr
    import mitsuba as mi

    mi.set_variant(args.variant)
    make_bsdf(mi, dr)
    write_meshes(args.folder)
    eye, target, fov = [0.3, 1.3, 3.0], [0.0, 0.6, 0.0], 45.0
    white = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": WALL}}}
    materials = {name: f'{{ kind = "lambert", albedo = {WALL} }}' for name in ("floor", "wall")}
    materials["light"] = f'{{ kind = "lambert", albedo = 0.0, emission = {LIGHT} }}'
    bsdfs = {"floor": white, "wall": white, "light": {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}}}
    for name, (albedo, share, color) in LEAVES.items():
        keys = f"albedo = {albedo}, diffuse_transmission = {share}, diffuse_transmission_color = {color}"
        materials[name] = f'{{ kind = "lambert", {keys} }}'
        reflected = {f"reflected_{i}": (1 - share) * part for i, part in enumerate(albedo)}
        bsdfs[name] = {"type": "leaf", **reflected, **{f"transmitted_{i}": share * part for i, part in enumerate(color)}}
    pair.write_overrides(args, materials, SKY, eye, target, fov)
    scene = pair.scene_of_meshes(args, mi, bsdfs, LIGHT, SKY, eye, target, fov)
    pair.compare(*pair.render(args, scene, mi), args.folder)


if __name__ == "__main__":
    main()
