"""Random materials of random_models.py, in glTF and for Mitsuba 3."""

import numpy as np

import gltf_texture
import random_scenes


class Materials(random_scenes.Scene):
    """Materials of a scene for both programs; the base class has what all glTF files need."""

    def __init__(self, mi, choices):
        super().__init__(mi, None)
        self.choices, self.roots = choices, []
        self.ours |= {"cameras": []}
        self.lights, self.is_absorbing, self.used = [], False, {"KHR_materials_specular"}

    def image(self, number, which, texels, is_color, emits=False):
        """A texture of bytes for an object: its glTF textureInfo, and the image for gltf_texture.describe.

        Where Mitsuba samples a light, it knows neither the second set of coordinates nor the colours of vertices, so
        that what `emits` has none.
        """
        rng, has = self.choices.rng(2, number, which), self.choices.has
        wrap = rng.choice([gltf_texture.REPEAT, gltf_texture.CLAMP, gltf_texture.MIRROR], 2).tolist()
        # Asked last: a wrap that is drawn may be the ordinary one.
        wrap = wrap if wrap != [gltf_texture.REPEAT] * 2 and has("wraps", number) else [gltf_texture.REPEAT] * 2
        nearest = bool(rng.random() < 0.3)
        sampler = {"magFilter": 9728 if nearest else 9729, "wrapS": wrap[0], "wrapT": wrap[1]}
        source = self.append("images", {"bufferView": self.view(random_scenes.png(texels)), "mimeType": "image/png"})
        texture = self.append("textures", {"source": source, "sampler": self.append("samplers", sampler)})
        info = {"index": texture}
        values = texels / 255.0
        if is_color:
            values[..., :3] = gltf_texture.linear(texels[..., :3])
        if values.shape[2] == 3:
            values = np.concatenate([values, np.ones_like(values[..., :1])], axis=2)
        image = {"texels": values, "nearest": nearest, "wrap": wrap, "set": 0}
        image |= {"offset": [0.0, 0.0], "rotation": 0.0, "scale": [1.0, 1.0]}
        if which != "normal" and which != 3 and has("transform", number):
            change = {"offset": rng.uniform(-1, 1, 2).tolist(), "rotation": float(rng.uniform(-3, 3))}
            change["scale"] = (rng.uniform(0.5, 1.5, 2) * rng.choice([-1, 1], 2)).tolist()
            info["extensions"] = {"KHR_texture_transform": change}
            image |= change
            self.used.add("KHR_texture_transform")
        if which not in (2, 3) and not emits and has("second-set", number):
            info["texCoord"] = image["set"] = 1
        return info, image

    def describe(self, *arguments, **named):
        return gltf_texture.describe(self.mi, *arguments, **named)

    def material(self, number, kind, emission=None):
        """Index of a new material, and the same as a BSDF, with the radiance that it emits."""
        rng, has = self.choices.rng(3, number), self.choices.has
        extensions = {}
        # The same number of draws for each kind.
        color, alpha, ior = rng.uniform(0.15, 0.85, 3).tolist(), rng.uniform(0.3, 0.9), float(rng.uniform(1.2, 1.8))
        roughness, metallic = float(rng.uniform(0.39, 1)), float(rng.choice([0, 0, 1, 1, rng.random()]))
        texels, parts = rng.integers(30, 250, (8, 8, 4)).astype(np.uint8), rng.integers(150, 256, (8, 8, 3)).astype(np.uint8)
        glow, slopes, normal_scale = rng.integers(20, 256, (4, 4, 3)), rng.uniform(-0.3, 0.3, (8, 8, 2)), rng.uniform(0.5, 1.2)
        pbr, material = {"metallicFactor": 0.0}, {"extensions": extensions}
        material["pbrMetallicRoughness"] = pbr
        mode = self.choices.first(("mask", "blend"), number) if kind == "sheet" else None
        alpha = float(alpha) if mode else 1.0
        pbr["baseColorFactor"] = [*color, alpha]
        is_covered_light = mode is not None and emission is not None
        colors, base = not is_covered_light and has("vertex-colors", number), None
        if kind in ("glass", "thin"):
            is_tinted = has("tint", number)
            if not is_tinted:
                color = [1.0, 1.0, 1.0]
            distance = None
            if kind == "glass" and self.choices.would_have("absorption", number):
                distance = float(rng.uniform(0.3, 1))
                # White does not absorb.
                if is_tinted:
                    self.choices.uses("absorption", number)
            return self.glass(kind, color, ior, distance, colors)
        if has("base-texture", number):
            info, base = self.image(number, 0, texels, True, is_covered_light)
            pbr["baseColorTexture"] = info
        factor = pbr["baseColorFactor"]
        reflectance = self.describe("rgb", factor, base, colors)
        if has("gloss", number):
            pbr |= {"metallicFactor": metallic, "roughnessFactor": roughness}
            rough = None
            if has("rough-texture", number):
                pbr["metallicRoughnessTexture"], rough = self.image(number, 1, parts, False)
            scale = (1, roughness, metallic, 1)
            bsdf = {"type": "glossy", "base_color": reflectance}
            bsdf |= {"roughness": self.describe(1, scale, rough), "metallic": self.describe(2, scale, rough)}
        else:
            extensions["KHR_materials_specular"] = {"specularFactor": 0.0}
            bsdf = {"type": "diffuse", "reflectance": reflectance}
        if kind in ("wall", "box") and has("normal-map", number):
            normals = np.concatenate([slopes, np.ones_like(slopes[..., :1])], axis=2)
            normals /= np.linalg.norm(normals, axis=2, keepdims=True)
            info, normal = self.image(number, 3, np.round((normals + 1) * 127.5).astype(np.uint8), False)
            material["normalTexture"] = info | {"scale": float(normal_scale)}
            normal = self.describe("rgb", image=normal, normal=float(normal_scale))
            bsdf = {"type": "normalmap", "use_shadowing_function": False, "normalmap": normal, "bsdf": bsdf}
            # gltf_texture.py bends normals that face away from the viewer, as we do; glTF leaves that open.
            bsdf["flip_invalid_normals"] = False
        bsdf = {"type": "twosided", "bsdf": bsdf}
        opacity = None
        if mode:
            material["alphaMode"] = mode.upper()
            cutoff = None
            if mode == "mask":
                # Of a factor and vertex colours, too, but so that a part is there.
                cutoff = material["alphaCutoff"] = float(0.4 * alpha)
            opacity = self.describe(3, factor, base, colors, cutoff)
            bsdf = {"type": "mask", "bsdf": bsdf, "opacity": opacity}
        radiance = None
        if emission is not None:
            strength = max(emission)
            material["emissiveFactor"] = [part / strength for part in emission]
            extensions["KHR_materials_emissive_strength"] = {"emissiveStrength": strength}
            shown = None
            if has("emission-texture", number):
                material["emissiveTexture"], shown = self.image(number, 2, glow.astype(np.uint8), True)
            # What is not covered does not emit (glTF 2.0, 3.9.4); Mitsuba's `mask` leaves lights as they are.
            radiance = self.describe("rgb", (*emission, 1), shown, emits=True, opacity=opacity)
        else:
            material["doubleSided"] = not has("single-sided", number)
        self.used |= set(extensions)
        return self.append("materials", material), bsdf, radiance, colors

    def glass(self, kind, color, ior, distance, colors):
        """A material of smooth glass, a solid or a pane; it absorbs if there is a distance for that."""
        pbr = {"metallicFactor": 0.0, "roughnessFactor": 0.0, "baseColorFactor": [*color, 1.0]}
        extensions = {"KHR_materials_transmission": {"transmissionFactor": 1.0}, "KHR_materials_ior": {"ior": ior}}
        bsdf = {"type": "dielectric" if kind == "glass" else "thindielectric", "int_ior": ior, "ext_ior": 1.0}
        bsdf["specular_transmittance"] = self.describe("rgb", (*color, 1), None, colors)
        if kind == "glass":
            extensions["KHR_materials_volume"] = {"thicknessFactor": 1.0}
        if distance is not None:
            attenuation = {"attenuationColor": color[::-1], "attenuationDistance": distance}
            extensions["KHR_materials_volume"] |= attenuation
            bsdf["absorption"] = (-np.log(color[::-1]) / distance).tolist()
        self.used |= set(extensions)
        material = {"extensions": extensions, "pbrMetallicRoughness": pbr}
        return self.append("materials", material), bsdf, None, colors
