"""Compares glossy surfaces with an unbiased path tracer, Mitsuba 3 (Jakob et al. 2022).

    pip install mitsuba
    cargo build --release
    python tests/mitsuba/gloss.py target/release/photonmap

The scene is that of surfaces.py with a ball of rough metal on a floor with a coat, both textured. Mitsuba has no BSDF of
this model, so that one is defined here, from the formulas in photon-core's glossy.rs, with albedos by a quadrature of its
own. Fails like surfaces.py.
"""

import functools

import numpy as np

import pair
import surfaces

STEPS = 256
# Where roughness is a texture.
ROUGHNESSES = np.linspace(0.04, 1, 33)


def schlick(f0, cosine):
    return f0 + (1 - f0) * (1 - cosine) ** 5


def albedo(alpha, cosine, f0):
    """The integral of single scattering over half vectors of density D cos."""
    across, around = np.meshgrid((np.arange(400) + 0.5) / 400, 2 * np.pi * (np.arange(96) + 0.5) / 96)
    tangent = alpha * np.sqrt(across / (1 - across))
    up = 1 / np.sqrt(1 + tangent**2)
    h = np.stack([up * tangent * np.cos(around), up * tangent * np.sin(around), up], -1)
    o = np.array([np.sqrt(1 - cosine**2), 0, cosine])
    onto = h @ o
    i = 2 * onto[..., None] * h - o
    counts = (onto > 0) & (i[..., 2] > 0)

    def smith(c):
        return 0.5 * (np.sqrt(1 + alpha**2 * (1 / c**2 - 1)) - 1)

    below = np.where(counts, i[..., 2], 1)
    masked = 1 / (1 + smith(cosine) + smith(below))
    return (np.where(counts, schlick(f0, np.clip(onto, 0, 1)) * masked * onto / (cosine * up), 0)).mean()


@functools.cache
def table(alphas, f0, steps):
    """Albedos for each alpha at cosines from 0 to 1, and their means over the hemisphere weighted by the cosine."""
    cosines = np.maximum(np.arange(steps + 1) / steps, 1e-3)
    values = np.array([[albedo(alpha, c, f0) for c in cosines] for alpha in alphas])
    middle = (np.arange(steps) + 0.5) / steps
    means = ((values[:, 1:] + values[:, :-1]) * middle).sum(axis=1) / steps
    return values.astype(np.float32), means.astype(np.float32)


def make_bsdf(mi, dr):
    class Glossy(mi.BSDF):
        """`metallic` and `alpha` are numbers; or `metallic` and `roughness`, the root of alpha, are textures."""

        def __init__(self, props):
            mi.BSDF.__init__(self, props)
            self.color = props["base_color"]
            self.metallic = props["metallic"]
            self.roughness = props["roughness"] if "roughness" in props else None
            self.alphas = [props["alpha"]] if self.roughness is None else ROUGHNESSES**2
            self.steps = STEPS if self.roughness is None else STEPS // 4
            # For F0 of 1 and of 0.04, a row for each alpha.
            self.tables, self.means = [], []
            for f0 in (1.0, 0.04):
                values, means = table(tuple(self.alphas), f0, self.steps)
                self.means.append(mi.Float(means))
                self.tables.append(mi.Float(values.ravel()))
            flags = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
            self.m_components = [flags]
            self.m_flags = flags

        def parameters(self, si, active):
            """Alpha, share of metal, and the place of alpha among the rows of the tables."""
            if self.roughness is None:
                return mi.Float(self.alphas[0]), self.metallic, mi.Float(0)
            roughness = dr.clip(self.roughness.eval_1(si, active), ROUGHNESSES[0], 1)
            at = (roughness - ROUGHNESSES[0]) / (ROUGHNESSES[1] - ROUGHNESSES[0])
            return roughness * roughness, self.metallic.eval_1(si, active), at

        def rows(self, at):
            first = dr.minimum(mi.UInt32(at), max(len(self.alphas) - 2, 0))
            return first, dr.minimum(first + 1, len(self.alphas) - 1), at - mi.Float(first)

        def mean(self, which, at):
            low, high, part = self.rows(at)
            return dr.lerp(*[dr.gather(mi.Float, self.means[which], row) for row in (low, high)], part)

        def lookup(self, which, at, cosine):
            low, high, part = self.rows(at)
            column = dr.clip(cosine, 0, 1) * self.steps
            first = dr.minimum(mi.UInt32(column), self.steps - 1)

            def row(number):
                values = [dr.gather(mi.Float, self.tables[which], number * (self.steps + 1) + first + k) for k in (0, 1)]
                return dr.lerp(values[0], values[1], column - mi.Float(first))

            return dr.lerp(row(low), row(high), part)

        def distribution(self, alpha):
            return mi.MicrofacetDistribution(mi.MicrofacetType.GGX, alpha, alpha, True)

        def value(self, si, wo, active):
            wi = si.wi
            alpha, m, at = self.parameters(si, active)
            color = self.color.eval(si, active)
            cos_i, cos_o = mi.Frame3f.cos_theta(wi), mi.Frame3f.cos_theta(wo)
            active = active & (cos_i > 0) & (cos_o > 0)
            h = dr.normalize(wi + wo)
            d = self.distribution(alpha).eval(h)
            smith = [0.5 * (dr.sqrt(1 + alpha**2 * (1 / (c * c) - 1)) - 1) for c in (cos_i, cos_o)]
            single = d / (1 + smith[0] + smith[1]) / (4 * cos_i * cos_o)
            grazing = (1 - dr.clip(dr.dot(wi, h), 0, 1)) ** 5
            f0 = color * m + 0.04 * (1 - m)
            fresnel = f0 + (1 - f0) * grazing
            lost = [1 - self.lookup(0, at, c) for c in (cos_i, cos_o)]
            average = color + (1 - color) / 21
            mean = self.mean(0, at)
            repeated = average * average * mean / (1 - average * (1 - mean))
            multiple = m * repeated * (lost[0] * lost[1] / (np.pi * (1 - mean)))
            through = [1 - self.lookup(1, at, c) for c in (cos_i, cos_o)]
            base = (1 - m) * color * (through[0] * through[1] / (np.pi * (1 - self.mean(1, at))))
            return dr.select(active, (fresnel * single + multiple + base) * cos_o, 0)

        def density(self, si, wo, active):
            cos_i, cos_o = mi.Frame3f.cos_theta(si.wi), mi.Frame3f.cos_theta(wo)
            h = dr.normalize(si.wi + wo)
            alpha, _, _ = self.parameters(si, active)
            narrow = self.distribution(alpha).pdf(si.wi, h) / (4 * dr.dot(wo, h))
            mixed = 0.5 * narrow + 0.5 * cos_o / np.pi
            return dr.select(active & (cos_i > 0) & (cos_o > 0), mixed, 0)

        def sample(self, ctx, si, sample1, sample2, active=True):
            cos_i = mi.Frame3f.cos_theta(si.wi)
            active = active & (cos_i > 0)
            alpha, _, _ = self.parameters(si, active)
            h, _ = self.distribution(alpha).sample(si.wi, sample2)
            wo = dr.select(sample1 < 0.5, mi.reflect(si.wi, h), mi.warp.square_to_cosine_hemisphere(sample2))
            found = mi.BSDFSample3f()
            found.wo = wo
            found.pdf = self.density(si, wo, active)
            found.eta = 1.0
            found.sampled_type = mi.UInt32(+mi.BSDFFlags.GlossyReflection)
            found.sampled_component = mi.UInt32(0)
            value = self.value(si, wo, active) / found.pdf
            return found, dr.select(active & (found.pdf > 0), value, 0)

        def eval(self, ctx, si, wo, active=True):
            return self.value(si, wo, active)

        def pdf(self, ctx, si, wo, active=True):
            return self.density(si, wo, active)

        def eval_pdf(self, ctx, si, wo, active=True):
            return self.value(si, wo, active), self.density(si, wo, active)

        def traverse(self, callback):
            callback.put_object("base_color", self.color, mi.ParamFlags.Differentiable)
            if self.roughness is not None:
                callback.put_object("metallic", self.metallic, mi.ParamFlags.Differentiable)
                callback.put_object("roughness", self.roughness, mi.ParamFlags.Differentiable)

    mi.register_bsdf("glossy", Glossy)


MATERIALS = {"ball": (1.0, 0.2), "floor": (0.0, 0.1)}


def main():
    args = pair.arguments(__doc__, "out/gloss", "llvm_ad_rgb", 1024)

    import drjit as dr
    import mitsuba as mi

    mi.set_variant(args.variant)
    make_bsdf(mi, dr)

    def glossy(metallic, alpha):
        return lambda image: {"type": "glossy", "base_color": image, "metallic": metallic, "alpha": alpha}

    scene = surfaces.their_scene(args.folder, mi, {name: glossy(*material) for name, material in MATERIALS.items()})
    overrides = (args.folder / "scene.toml").read_text() + "\n[materials]\n"
    for name, (metallic, alpha) in MATERIALS.items():
        overrides += f'{name} = {{ kind = "glossy", metallic = {metallic}, roughness = {alpha**0.5} }}\n'
    (args.folder / "scene.toml").write_text(overrides)
    pair.compare(*pair.render(args, scene, mi), args.folder)


if __name__ == "__main__":
    main()
