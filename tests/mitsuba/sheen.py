"""Compares sheen with an unbiased path tracer, Mitsuba 3 (Jakob et al. 2022).

    pip install mitsuba
    cargo build --release
    python tests/mitsuba/sheen.py target/release/photonmap

Floor and wall of coloured cloths of several roughnesses, seen at a low angle, under a light and an even sky. Mitsuba has no
BSDF of this model, so that one is defined here from the formulas in photon-core's sheen.rs, with albedos by a quadrature.
Fails like surfaces.py.
"""

import base64
import json

import numpy as np

import pair

LIGHT = 20.0
SKY = 0.3
# Albedo, colour and roughness of the sheen.
CLOTHS = {
    "wool": ([0.5, 0.1, 0.1], [0.9, 0.6, 0.3], 0.6),
    "silk": ([0.1, 0.2, 0.5], [0.3, 0.8, 0.8], 0.3),
    "wall": ([0.3, 0.3, 0.3], [1.0, 1.0, 0.8], 1.0),
}
PARTS = {
    "wool": [(-1.5, 0, 1.5), (0, 0, 1.5), (0, 0, -1.5), (-1.5, 0, -1.5)],
    "silk": [(0, 0, 1.5), (1.5, 0, 1.5), (1.5, 0, -1.5), (0, 0, -1.5)],
    "wall": [(-1.5, 0, -1.5), (1.5, 0, -1.5), (1.5, 1.5, -1.5), (-1.5, 1.5, -1.5)],
    "light": [(-0.8, 1.6, -1.2), (0.8, 1.6, -1.2), (0.8, 1.6, -0.9), (-0.8, 1.6, -0.9)],
}
STEPS = 256


def coefficients(alpha):
    """Of the fit of Estevez and Kulla 2017, table 1."""
    weight = (1 - alpha) ** 2
    one = np.array([21.5473, 3.82987, 0.19823, -1.97760, -4.32054])
    zero = np.array([25.3245, 3.32435, 0.16801, -1.27393, -4.85967])
    return (one + (zero - one) * weight).tolist()


def lobe(dr, alpha, sine_squared, cosines):
    """D V, without the limit at grazing angles, where it does not apply; `dr` is drjit or numpy."""
    a, b, c, d, e = coefficients(alpha)
    select = dr.where if dr is np else dr.select

    def exponent(x):
        return a / (1 + b * dr.maximum(x, 1e-30) ** c) + d * x + e

    def smith(x):
        return dr.exp(select(x < 0.5, exponent(x), 2 * exponent_half - exponent(1 - x)))

    exponent_half = a / (1 + b * 0.5**c) + d * 0.5 + e
    distribution = (2 + 1 / alpha) * dr.maximum(sine_squared, 1e-30) ** (0.5 / alpha) / (2 * np.pi)
    return distribution / ((1 + smith(cosines[0]) + smith(cosines[1])) * 4 * cosines[0] * cosines[1])


def albedos(alpha):
    """Directional albedos over the root of the cosine, in steps of 1/STEPS, at most 1."""
    across, around = 400, 64
    root, turn = np.meshgrid((np.arange(across) + 0.5) / across, (np.arange(around) + 0.5) / around * np.pi)
    other = root**2
    found = []
    for step in range(STEPS + 1):
        cosine = max((step / STEPS) ** 2, 1e-3)
        between = np.sqrt((1 - cosine**2) * (1 - other**2)) * np.cos(turn) + cosine * other
        sine_squared = np.maximum(1 - (cosine + other) ** 2 / (2 + 2 * between), 0)
        values = lobe(np, alpha, sine_squared, (np.full_like(other, cosine), np.maximum(other, 1e-3)))
        found.append((values * other * 2 * root).mean() * 2 * np.pi)
    return np.minimum(np.array(found), 1)


def write_scene(folder):
    """scene.gltf for photonmap, and NAME.obj for Mitsuba."""
    data, meshes, materials, accessors, views = b"", [], [], [], []

    def add(array, kind, component):
        nonlocal data
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": array.nbytes})
        accessor = {"bufferView": len(views) - 1, "componentType": component, "count": len(array), "type": kind}
        if kind == "VEC3":
            accessor |= {"min": array.min(axis=0).tolist(), "max": array.max(axis=0).tolist()}
        accessors.append(accessor)
        data += array.tobytes()
        return len(accessors) - 1

    for name, points in PARTS.items():
        attributes = {"POSITION": add(np.array(points, np.float32), "VEC3", 5126)}
        indices = add(np.array([0, 1, 2, 0, 2, 3], np.uint32), "SCALAR", 5125)
        meshes.append({"primitives": [{"attributes": attributes, "indices": indices, "material": len(materials)}]})
        albedo, color, roughness = CLOTHS.get(name, ([0.0] * 3, None, None))
        material = {"name": name, "doubleSided": name != "light"}
        material["pbrMetallicRoughness"] = {"baseColorFactor": [*albedo, 1], "metallicFactor": 0}
        material["extensions"] = {"KHR_materials_specular": {"specularFactor": 0}}
        if name == "light":
            material["emissiveFactor"] = [1, 1, 1]
            material["extensions"]["KHR_materials_emissive_strength"] = {"emissiveStrength": LIGHT}
        else:
            sheen = {"sheenColorFactor": color, "sheenRoughnessFactor": roughness}
            material["extensions"]["KHR_materials_sheen"] = sheen
        materials.append(material)
        lines = [f"v {x} {y} {z}" for x, y, z in points]
        (folder / f"{name}.obj").write_text("\n".join([*lines, "f 1 2 3", "f 1 3 4"]) + "\n")
    root = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(meshes)))}],
        "nodes": [{"mesh": index} for index in range(len(meshes))],
        "meshes": meshes,
        "materials": materials,
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [
            {"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}
        ],
    }
    (folder / "scene.gltf").write_text(json.dumps(root))


def make_bsdf(mi, dr):
    class Cloth(mi.BSDF):
        """A Lambertian base under a sheen."""

        def __init__(self, props):
            mi.BSDF.__init__(self, props)
            self.albedo, self.color = [mi.Color3f([props[f"{k}_{i}"] for i in range(3)]) for k in ("albedo", "color")]
            self.strength = max(props[f"color_{i}"] for i in range(3))
            self.alpha = props["roughness"] ** 2
            values = albedos(self.alpha)
            # 4 E x^3 over the root x of the cosine.
            steps = np.linspace(0, 1, STEPS + 1)
            products = 4 * values * steps**3
            self.mean = 1 - self.strength * float((products[1:] + products[:-1]).sum() / (2 * STEPS))
            self.values = mi.Float(values)
            flags = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
            self.m_components = [flags]
            self.m_flags = flags

        def through(self, cosine):
            column = dr.sqrt(dr.clip(cosine, 0, 1)) * STEPS
            first = dr.minimum(mi.UInt32(column), STEPS - 1)
            values = [dr.gather(mi.Float, self.values, first + k) for k in (0, 1)]
            return 1 - self.strength * dr.lerp(values[0], values[1], column - mi.Float(first))

        def value(self, si, wo, active):
            cos_i, cos_o = mi.Frame3f.cos_theta(si.wi), mi.Frame3f.cos_theta(wo)
            active = active & (cos_i > 0) & (cos_o > 0)
            base = self.albedo * (self.through(cos_i) * self.through(cos_o) / (self.mean * np.pi))
            h = dr.normalize(si.wi + wo)
            cosines = [dr.maximum(cosine, 1e-3) for cosine in (cos_i, cos_o)]
            sheen = self.color * lobe(dr, self.alpha, 1 - h.z * h.z, cosines)
            return dr.select(active, (base + sheen) * cos_o, 0)

        def density(self, si, wo, active):
            cos_i, cos_o = mi.Frame3f.cos_theta(si.wi), mi.Frame3f.cos_theta(wo)
            return dr.select(active & (cos_i > 0) & (cos_o > 0), (0.25 + 0.5 * cos_o) / np.pi, 0)

        def sample(self, ctx, si, sample1, sample2, active=True):
            even, dense = [
                warp(sample2) for warp in (mi.warp.square_to_uniform_hemisphere, mi.warp.square_to_cosine_hemisphere)
            ]
            found = mi.BSDFSample3f()
            found.wo = dr.select(sample1 < 0.5, even, dense)
            found.pdf = self.density(si, found.wo, active)
            found.eta = 1.0
            found.sampled_type = mi.UInt32(+mi.BSDFFlags.GlossyReflection)
            found.sampled_component = mi.UInt32(0)
            return found, dr.select(active & (found.pdf > 0), self.value(si, found.wo, active) / found.pdf, 0)

        def eval(self, ctx, si, wo, active=True):
            return self.value(si, wo, active)

        def pdf(self, ctx, si, wo, active=True):
            return self.density(si, wo, active)

        def eval_pdf(self, ctx, si, wo, active=True):
            return self.value(si, wo, active), self.density(si, wo, active)

    mi.register_bsdf("cloth", Cloth)


def main():
    args = pair.arguments(__doc__, "out/sheen", "llvm_ad_rgb", 1024)

    import drjit as dr
    import mitsuba as mi

    mi.set_variant(args.variant)
    make_bsdf(mi, dr)
    write_scene(args.folder)
    eye, target, fov = [0.2, 0.7, 2.8], [0.0, 0.15, 0.0], 45.0
    pair.write_overrides(args, {}, SKY, eye, target, fov)
    bsdfs = {"light": {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}}}
    for name, (albedo, color, roughness) in CLOTHS.items():
        parts = {f"albedo_{i}": part for i, part in enumerate(albedo)}
        parts |= {f"color_{i}": part for i, part in enumerate(color)}
        bsdfs[name] = {"type": "twosided", "bsdf": {"type": "cloth", "roughness": roughness, **parts}}
    scene = pair.scene_of_meshes(args, mi, bsdfs, LIGHT, SKY, eye, target, fov)
    pair.compare(*pair.render(args, scene, mi, "scene.gltf"), args.folder)


if __name__ == "__main__":
    main()
