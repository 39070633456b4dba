"""Compares clearcoats with an unbiased path tracer, Mitsuba 3 (Jakob et al. 2022).

    pip install mitsuba
    cargo build --release
    python tests/mitsuba/clearcoat.py target/release/photonmap

A coloured, diffuse floor under a clearcoat, before a wall that is under an even one: the left half of the floor has a wavy
normal map for the clearcoat alone, the right half none. Mitsuba has no BSDF of this model, so that one is defined here from
the formulas in photon-core's clearcoat.rs, with albedos by the quadrature of gloss.py. Fails like surfaces.py.
"""

import base64
import json

import numpy as np

import gloss
import pair

LIGHT = 20.0
SKY = 0.3
ROUGHNESS = 0.3
ALBEDO = {"wavy": [0.6, 0.2, 0.1], "even": [0.1, 0.3, 0.6], "wall": [0.7, 0.7, 0.7], "light": [0.0, 0.0, 0.0]}
# From the lower left corner counter-clockwise, with texture coordinates (0, 1), (1, 1), (1, 0), (0, 0) of glTF.
PARTS = {
    "wavy": [(-1.5, 0, 1.5), (0, 0, 1.5), (0, 0, -1.5), (-1.5, 0, -1.5)],
    "even": [(0, 0, 1.5), (1.5, 0, 1.5), (1.5, 0, -1.5), (0, 0, -1.5)],
    "wall": [(-1.5, 0, -1.5), (1.5, 0, -1.5), (1.5, 1.5, -1.5), (-1.5, 1.5, -1.5)],
    "light": [(-0.8, 1.6, -1.2), (0.8, 1.6, -1.2), (0.8, 1.6, -0.9), (-0.8, 1.6, -0.9)],
}
UVS = [(0, 1), (1, 1), (1, 0), (0, 0)]


def waves():
    """A normal map with tilts of up to 20 degrees along both axes."""
    x, y = np.meshgrid((np.arange(32) + 0.5) / 32, (np.arange(32) + 0.5) / 32)
    slopes = [0.36 * np.sin(2 * np.pi * (2 * x + y)), 0.36 * np.sin(2 * np.pi * (3 * y - x))]
    normal = np.stack([slopes[0], slopes[1], np.ones_like(x)], -1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    return np.round((normal + 1) * 127.5).astype(np.uint8)


def write_scene(folder, mi):
    """scene.gltf for photonmap, NAME.obj for Mitsuba, and waves.png for both."""
    mi.Bitmap(waves(), mi.Bitmap.PixelFormat.RGB).write(str(folder / "waves.png"))
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
        attributes = {
            "POSITION": add(np.array(points, np.float32), "VEC3", 5126),
            "TEXCOORD_0": add(np.array(UVS, np.float32), "VEC2", 5126),
        }
        indices = add(np.array([0, 1, 2, 0, 2, 3], np.uint32), "SCALAR", 5125)
        meshes.append({"primitives": [{"attributes": attributes, "indices": indices, "material": len(materials)}]})
        material = {"name": name, "doubleSided": name != "light"}
        material["pbrMetallicRoughness"] = {"baseColorFactor": [*ALBEDO[name], 1], "metallicFactor": 0}
        material["extensions"] = {"KHR_materials_specular": {"specularFactor": 0}}
        if name == "light":
            material["emissiveFactor"] = [1, 1, 1]
            material["extensions"]["KHR_materials_emissive_strength"] = {"emissiveStrength": LIGHT}
        else:
            coat = {"clearcoatFactor": 1, "clearcoatRoughnessFactor": ROUGHNESS}
            if name == "wavy":
                coat["clearcoatNormalTexture"] = {"index": 0}
            material["extensions"]["KHR_materials_clearcoat"] = coat
        materials.append(material)
        lines = [f"v {x} {y} {z}" for x, y, z in points] + [f"vt {u} {1 - v}" for u, v in UVS]
        (folder / f"{name}.obj").write_text("\n".join([*lines, "f 1/1 2/2 3/3", "f 1/1 3/3 4/4"]) + "\n")
    root = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(meshes)))}],
        "nodes": [{"mesh": index} for index in range(len(meshes))],
        "meshes": meshes,
        "materials": materials,
        "textures": [{"source": 0}],
        "images": [{"uri": "waves.png"}],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [
            {"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}
        ],
    }
    (folder / "scene.gltf").write_text(json.dumps(root))


def make_bsdf(mi, dr):
    class Coated(mi.BSDF):
        """A Lambertian base under a clearcoat, whose normal is that of the texture `normal` if there is one."""

        def __init__(self, props):
            mi.BSDF.__init__(self, props)
            self.albedo = mi.Color3f([props[f"albedo_{i}"] for i in range(3)])
            self.normal = props["normal"] if "normal" in props else None
            self.alpha = ROUGHNESS**2
            values, means = gloss.table((self.alpha,), 0.04, gloss.STEPS)
            self.mean, self.values = float(means[0]), mi.Float(values.ravel())
            flags = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
            self.m_components = [flags]
            self.m_flags = flags
            self.ggx = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, self.alpha, self.alpha, True)

        def through(self, cosine):
            column = dr.clip(cosine, 0, 1) * gloss.STEPS
            first = dr.minimum(mi.UInt32(column), gloss.STEPS - 1)
            values = [dr.gather(mi.Float, self.values, first + k) for k in (0, 1)]
            return 1 - dr.lerp(values[0], values[1], column - mi.Float(first))

        def frame(self, si, active):
            if self.normal is None:
                return mi.Frame3f(mi.Normal3f(0, 0, 1))
            return mi.Frame3f(dr.normalize(mi.Normal3f(self.normal.eval_3(si, active) * 2 - 1)))

        def value(self, si, wo, active):
            wi, frame = si.wi, self.frame(si, active)
            cos_i, cos_o = mi.Frame3f.cos_theta(wi), mi.Frame3f.cos_theta(wo)
            active = active & (cos_i > 0) & (cos_o > 0)
            base = self.albedo * (self.through(cos_i) * self.through(cos_o) / ((1 - self.mean) * np.pi)) * cos_o
            i, o = frame.to_local(wi), frame.to_local(wo)
            above = (i.z > 0) & (o.z > 0)
            h = dr.normalize(i + o)
            smith = [0.5 * (dr.sqrt(1 + self.alpha**2 * (1 / (c * c) - 1)) - 1) for c in (i.z, o.z)]
            single = self.ggx.eval(h) / (1 + smith[0] + smith[1]) / (4 * i.z)
            coat = gloss.schlick(0.04, dr.clip(dr.dot(i, h), 0, 1)) * single
            return dr.select(active, base + dr.select(above, coat, 0), 0)

        def density(self, si, wo, active):
            cos_i, cos_o = mi.Frame3f.cos_theta(si.wi), mi.Frame3f.cos_theta(wo)
            frame = self.frame(si, active)
            i, o = frame.to_local(si.wi), frame.to_local(wo)
            h = dr.normalize(i + o)
            narrow = dr.select((i.z > 0) & (o.z > 0), self.ggx.pdf(i, h) / (4 * dr.dot(o, h)), 0)
            return dr.select(active & (cos_i > 0) & (cos_o > 0), 0.5 * narrow + 0.5 * cos_o / np.pi, 0)

        def sample(self, ctx, si, sample1, sample2, active=True):
            frame = self.frame(si, active)
            i = frame.to_local(si.wi)
            h, _ = self.ggx.sample(i, sample2)
            reflected = frame.to_world(mi.reflect(i, h))
            wo = dr.select(sample1 < 0.5, reflected, mi.warp.square_to_cosine_hemisphere(sample2))
            active = active & (mi.Frame3f.cos_theta(si.wi) > 0)
            found = mi.BSDFSample3f()
            found.wo = wo
            found.pdf = self.density(si, wo, active)
            found.eta = 1.0
            found.sampled_type = mi.UInt32(+mi.BSDFFlags.GlossyReflection)
            found.sampled_component = mi.UInt32(0)
            return found, dr.select(active & (found.pdf > 0), self.value(si, wo, active) / found.pdf, 0)

        def eval(self, ctx, si, wo, active=True):
            return self.value(si, wo, active)

        def pdf(self, ctx, si, wo, active=True):
            return self.density(si, wo, active)

        def eval_pdf(self, ctx, si, wo, active=True):
            return self.value(si, wo, active), self.density(si, wo, active)

        def traverse(self, callback):
            if self.normal is not None:
                callback.put_object("normal", self.normal, mi.ParamFlags.Differentiable)

    mi.register_bsdf("coated", Coated)


def main():
    args = pair.arguments(__doc__, "out/clearcoat", "llvm_ad_rgb", 1024)

    import drjit as dr
    import mitsuba as mi

    mi.set_variant(args.variant)
    make_bsdf(mi, dr)
    write_scene(args.folder, mi)
    eye, target, fov = [0.2, 1.6, 2.6], [0.0, 0.1, 0.0], 45.0
    pair.write_overrides(args, {}, SKY, eye, target, fov)
    image = {"type": "bitmap", "filename": str(args.folder / "waves.png"), "filter_type": "bilinear", "raw": True}
    bsdfs = {}
    for name, albedo in ALBEDO.items():
        coated = {"type": "coated", **{f"albedo_{i}": part for i, part in enumerate(albedo)}}
        bsdfs[name] = {"type": "twosided", "bsdf": coated | ({"normal": image} if name == "wavy" else {})}
    bsdfs["light"] = {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}}
    scene = pair.scene_of_meshes(args, mi, bsdfs, LIGHT, SKY, eye, target, fov)
    pair.compare(*pair.render(args, scene, mi, "scene.gltf"), args.folder)


if __name__ == "__main__":
    main()
