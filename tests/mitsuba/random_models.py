"""Compares random glTF files of many features with an unbiased path tracer, Mitsuba 3 (Jakob et al. 2022).

    pip install mitsuba
    cargo build --release
    python tests/mitsuba/random_models.py target/release/photonmap 0 20
    python tests/mitsuba/random_models.py target/release/photonmap 7 1 --without wraps,second-set

renders the scenes of the seeds 0 to 19. Each seed has a random subset of FEATURES, which are on or off in the scene as a
whole and then used by random objects; `--without` removes some of them and leaves what the others draw as it is, so that a
difference can be reduced. Plastics and metals have the BSDF of gloss.py in Mitsuba, textures that of gltf_texture.py. Fails if
the mean of a channel differs by more than one per cent and 4.5 standard errors, or that of a block of 8×8 pixels by more
than 4 % and 4.5 standard errors (relative to the block, or to a twentieth of the mean of the picture where it is darker);
before that it checks that a picture 10 % too bright in red fails. Unknown options are those of `photonmap render`.

Point, spot and directional lights exclude smooth glass and emission in it, whose caustics a path tracer cannot find.
"""

import argparse
import base64
import json
import pathlib
import subprocess
import sys

import numpy as np

import block_comparison
import exported
import gloss
import gltf_texture
import helmet
import random_scenes
from random_choices import FEATURES, Choices
from random_scenes import WALLS, box, quad, quaternion, sphere

LUMENS_PER_WATT = 683.0
# Walls have lower numbers, objects higher ones.
LIGHT = 10


class Model(random_scenes.Scene):
    """A scene for both programs; the base class has what all glTF files need."""

    def __init__(self, mi, choices):
        super().__init__(mi, None)
        self.choices, self.roots, self.described = choices, [], []
        self.ours |= {"cameras": []}
        self.lights, self.is_absorbing, self.used = [], False, {"KHR_materials_specular"}

    def image(self, number, which, texels, is_color, emits=False):
        """A texture of bytes for an object: its glTF textureInfo, and the image for gltf_texture.describe.

        Where Mitsuba samples a light, it knows neither the second set of coordinates nor the colours of vertices, so
        that what `emits` has none.
        """
        rng, has = self.choices.rng(2, number, which), self.choices.has
        wrap = rng.choice([gltf_texture.REPEAT, gltf_texture.CLAMP, gltf_texture.MIRROR], 2).tolist()
        wrap = wrap if has("wraps", number) else [gltf_texture.REPEAT] * 2
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
        mode = next((name for name in ("mask", "blend") if has(name, number)), None) if kind == "sheet" else None
        alpha = float(alpha) if mode else 1.0
        pbr["baseColorFactor"] = [*color, alpha]
        is_covered_light = mode is not None and emission is not None
        colors, base = has("vertex-colors", number) and not is_covered_light, None
        if kind in ("glass", "thin"):
            pbr["roughnessFactor"] = 0.0
            if not has("tint", number):
                color = [1.0, 1.0, 1.0]
            pbr["baseColorFactor"] = [*color, 1.0]
            extensions |= {"KHR_materials_transmission": {"transmissionFactor": 1.0}, "KHR_materials_ior": {"ior": ior}}
            bsdf = {"type": "dielectric" if kind == "glass" else "thindielectric", "int_ior": ior, "ext_ior": 1.0}
            bsdf["specular_transmittance"] = self.describe("rgb", (*color, 1), None, colors)
            if kind == "glass":
                volume = extensions["KHR_materials_volume"] = {"thicknessFactor": 1.0}
                if has("absorption", number):
                    distance = float(rng.uniform(0.3, 1))
                    volume |= {"attenuationColor": color[::-1], "attenuationDistance": distance}
                    bsdf["absorption"] = (-np.log(color[::-1]) / distance).tolist()
            self.used |= set(extensions)
            return self.append("materials", material), bsdf, None, colors
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

    def mesh(self, number, shape, kind, smooth, emission=None):
        """A mesh of glTF, with what `place` needs for each of its instances."""
        rng, has = self.choices.rng(4, number), self.choices.has
        index, bsdf, radiance, colors = self.material(number, kind, emission)
        positions, normals, uvs, triangles = shape
        uvs = uvs * rng.uniform(0.7, 2.2, 2) + rng.uniform(-1, 1, 2)
        if rng.random() < 0.5:
            uvs = uvs * [-1, 1]
        turn = rng.normal(size=(2, 2))
        second = uvs @ turn + rng.uniform(-1, 1, 2)
        tints = np.concatenate([rng.uniform(0.2, 1, (len(positions), 3)), rng.uniform(0.6, 1, (len(positions), 1))], axis=1)
        attributes = {"POSITION": self.accessor(positions.astype(np.float32), "VEC3", 5126)}
        attributes["TEXCOORD_0"] = self.accessor(uvs.astype(np.float32), "VEC2", 5126)
        attributes["TEXCOORD_1"] = self.accessor(second.astype(np.float32), "VEC2", 5126)
        material = self.ours["materials"][index]
        if colors:
            attributes["COLOR_0"] = self.accessor(tints.astype(np.float32), "VEC4", 5126)
        is_faceted = bool((normals[triangles] == normals[triangles[:, :1]]).all())
        if smooth or (is_faceted and has("tangents", number)):
            attributes["NORMAL"] = self.accessor(normals.astype(np.float32), "VEC3", 5126)
        if "normalTexture" in material and has("tangents", number):
            tangents = np.zeros((len(positions), 4), np.float32)
            for triangle in triangles:
                along, up = directions(positions[triangle], uvs[triangle])
                along /= np.linalg.norm(along)
                hand = np.sign(np.cross(normals[triangle[0]], along) @ up)
                tangents[triangle] = [*along, hand]
            attributes["TANGENT"] = self.accessor(tangents, "VEC4", 5126)
        indices = self.accessor(triangles.astype(np.uint32).ravel(), "SCALAR", 5125)
        primitive = {"attributes": attributes, "indices": indices, "material": index}
        mesh = self.append("meshes", {"primitives": [primitive]})
        described = [kind] + (["smooth"] if smooth else []) + [name for name in FEATURES if has(name, number)]
        self.described.append(f"{number}: {' '.join(described)}")
        return mesh, (positions, normals, uvs, second, tints, triangles), bsdf, radiance, smooth

    def place(self, number, made, scale, turn, translation):
        """An instance of a mesh, perhaps below a node that is scaled and turned as well."""
        rng, mesh = self.choices.rng(5, number), made[0]
        local = np.eye(4)
        local[:3, :3], local[:3, 3] = random_scenes.matrix(turn) * scale, translation
        node = {"mesh": mesh, "rotation": list(map(float, turn)), "scale": list(map(float, scale))}
        node["translation"] = list(map(float, translation))
        world = local
        # Walls stay where they are: behind surfaces, Mitsuba's `twosided` mirrors a normal map in the surface, while glTF turns
        # the normal over.
        if number >= LIGHT and self.choices.has("hierarchy", number):
            outer = rng.normal(size=4)
            outer /= np.linalg.norm(outer)
            parent = np.eye(4)
            parent[:3, :3] = random_scenes.matrix(outer) * rng.uniform(0.8, 1.25, 3)
            moved = np.linalg.solve(parent, np.array([*translation, 1]))
            local[:3, 3] = moved[:3]
            node = {"mesh": mesh, "matrix": local.T.ravel().tolist()}
            above = {"matrix": parent.T.ravel().tolist(), "children": [self.append("nodes", node)]}
            self.roots.append(self.append("nodes", above))
            world = parent @ local
        else:
            self.roots.append(self.append("nodes", node))
        self.add_theirs(f"object-{number}", made, world)
        if self.ours["materials"][self.ours["meshes"][mesh]["primitives"][0]["material"]].get("doubleSided") and made[3]:
            shifted = world.copy()
            normal = np.linalg.inv(world[:3, :3]).T @ made[1][1][0]
            shifted[:3, 3] -= 1e-3 * normal / np.linalg.norm(normal)
            self.add_theirs(f"object-{number}-back", made, shifted, turned_over=True)

    def add_theirs(self, name, made, world, turned_over=False):
        mi = self.mi
        _, (positions, normals, uvs, second, tints, triangles), bsdf, radiance, smooth = made
        properties = mi.Properties()
        bsdf = dict(bsdf)
        absorption = bsdf.pop("absorption", None)
        properties["bsdf"] = mi.load_dict(bsdf, parallel=False)
        if absorption is not None and max(absorption) > 0:
            self.is_absorbing = True
            scale = max(absorption)
            sigma = {"type": "rgb", "value": [part / scale for part in absorption]}
            medium = {"type": "homogeneous", "albedo": {"type": "rgb", "value": 0.0}, "sigma_t": sigma, "scale": scale}
            properties["interior"] = mi.load_dict(medium)
        if radiance is not None:
            properties["emitter"] = mi.load_dict({"type": "area", "radiance": radiance})
        if (np.linalg.det(world[:3, :3]) < 0) != turned_over:
            triangles = triangles[:, ::-1]
        places = positions @ world[:3, :3].T + world[:3, 3]
        hands = np.ones(len(positions), np.float32)
        for triangle in triangles:
            along, up = directions(places[triangle], uvs[triangle])
            corners = places[triangle]
            hands[triangle] = np.sign(np.cross(np.cross(corners[1] - corners[0], corners[2] - corners[0]), along) @ up)
        mesh = mi.Mesh(name, len(positions), len(triangles), properties, smooth, True)
        extended = np.concatenate([second, np.zeros_like(second[:, :1])], axis=1)
        mesh.add_attribute("vertex_second", 3, extended.astype(np.float32).ravel())
        mesh.add_attribute("vertex_tint", 3, tints[:, :3].astype(np.float32).ravel())
        mesh.add_attribute("vertex_cover", 1, tints[:, 3].astype(np.float32).ravel())
        mesh.add_attribute("vertex_hand", 1, hands)
        parameters = mi.traverse(mesh)
        parameters["vertex_positions"] = places.astype(np.float32).ravel()
        parameters["faces"] = triangles.astype(np.uint32).ravel()
        parameters["vertex_texcoords"] = uvs.astype(np.float32).ravel()
        if smooth:
            turned = normals @ np.linalg.inv(world[:3, :3])
            turned /= np.linalg.norm(turned, axis=1, keepdims=True)
            parameters["vertex_normals"] = turned.astype(np.float32).ravel()
        parameters.update()
        self.theirs[name] = mesh

    def add_light(self, number, at, towards):
        """A light of KHR_lights_punctual."""
        mi, rng = self.mi, self.choices.rng(6, number)
        kind = rng.choice(["point", "spot"] if "room" in self.choices.on else ["point", "spot", "directional"])
        color, strength = rng.uniform(0.3, 1, 3), float(rng.uniform(4, 12)) * (0.2 if kind == "directional" else 1)
        unit = LUMENS_PER_WATT if "standard-units" in self.choices.on else 1.0
        light = {"type": str(kind), "color": color.tolist(), "intensity": strength * unit}
        value = {"type": "rgb", "value": (color * strength).tolist()}
        frame = look_at(at, towards, [0.3, 1, 0.2])
        axis = (np.array(towards) - at).tolist()
        if kind == "point":
            theirs = {"type": "point", "position": list(at), "intensity": value}
        elif kind == "directional":
            theirs = {"type": "directional", "direction": axis, "irradiance": value}
        else:
            outer, inner = rng.uniform(0.5, 1.1), rng.uniform(0, 0.45)
            light["spot"] = {"innerConeAngle": float(inner), "outerConeAngle": float(outer)}
            # The falloff of glTF as a picture that the light projects, since that of Mitsuba is another.
            across = np.tan(outer) * (np.arange(1024) + 0.5 - 512) / 512
            cosine = 1 / np.sqrt(1 + across[:, None] ** 2 + across**2)
            falloff = np.clip((cosine - np.cos(outer)) / (np.cos(inner) - np.cos(outer)), 0, 1) ** 2
            picture = mi.Bitmap(falloff.astype(np.float32)[..., None].repeat(3, axis=2))
            texture = {"type": "bitmap", "bitmap": picture, "raw": True}
            to_world = mi.ScalarTransform4f().look_at(origin=list(at), target=list(towards), up=[0, 1, 0])
            theirs = {"type": "spot", "to_world": to_world, "intensity": value, "texture": texture}
            theirs |= {"cutoff_angle": float(np.degrees(outer)), "beam_width": float(np.degrees(outer)) * 0.9999}
        self.theirs[f"light-{number}"] = theirs
        self.lights.append(light)
        extension = {"KHR_lights_punctual": {"light": len(self.lights) - 1}}
        self.roots.append(self.append("nodes", {"matrix": frame.T.ravel().tolist(), "extensions": extension}))
        self.used.add("KHR_lights_punctual")
        self.described.append(str(kind))

    def add_camera(self, size, eye, target, up, fov, half_height):
        mi, (width, height) = self.mi, size
        film = {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"}, "pixel_format": "rgb"}
        to_world = mi.ScalarTransform4f().look_at(origin=list(eye), target=list(target), up=list(up))
        if "orthographic" in self.choices.on:
            half_width = half_height * width / height
            lens = {"xmag": half_width, "ymag": half_height, "znear": 0.0, "zfar": 100}
            camera = {"type": "orthographic", "orthographic": lens}
            to_world = to_world @ mi.ScalarTransform4f().scale([half_width, half_width, 1])
            sensor = {"type": "orthographic"}
        else:
            lens = {"yfov": float(np.radians(fov)), "aspectRatio": width / height, "znear": 0.01}
            camera = {"type": "perspective", "perspective": lens}
            sensor = {"type": "perspective", "fov": fov, "fov_axis": "y"}
        # Ours does not clip, which shows where orthographic rays start near a wall.
        self.theirs["sensor"] = sensor | {"to_world": to_world, "film": film, "near_clip": 1e-5}
        node = {"matrix": look_at(eye, target, up).T.ravel().tolist(), "camera": self.append("cameras", camera)}
        self.roots.append(self.append("nodes", node))

    def write(self, path):
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
        root = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": self.roots}]}
        root |= {name: values for name, values in self.ours.items() if values}
        root |= {"buffers": [{"byteLength": len(self.data), "uri": uri}], "extensionsUsed": sorted(self.used)}
        if self.lights:
            root["extensions"] = {"KHR_lights_punctual": {"lights": self.lights}}
        path.write_text(json.dumps(root))


def directions(corners, uvs):
    """The directions in which u of a triangle grows and v, which points down, falls."""
    edges, steps = corners[1:] - corners[0], uvs[1:] - uvs[0]
    if abs(np.linalg.det(steps)) < 1e-12:
        return edges[0], edges[1]
    along, down = np.linalg.solve(steps, edges)
    return along, -down


def look_at(eye, target, up):
    """The matrix of a node that looks along -z."""
    back = np.array(eye, float) - target
    back /= np.linalg.norm(back)
    right = np.cross(up, back)
    right /= np.linalg.norm(right)
    return np.block([[np.array([right, np.cross(back, right), back, eye]).T], [0, 0, 0, 1]])


def make(mi, seed, folder, without):
    """The scene in scene.gltf and environment.exr; the same for Mitsuba, its size, our options, and its description."""
    choices = Choices(seed, without)
    rng, on, scene, options = choices.rng(7), choices.on, Model(mi, choices), ["--max-plane-distance", "0.1"]
    is_room = "room" in on
    size = (80, 48) if "wide" in on else (48, 80) if "tall" in on else (56, 56)
    for number, (at, axis, angle) in enumerate(WALLS if is_room else WALLS[:1]):
        made = scene.mesh(number, quad(), "wall", False)
        scene.place(number, made, (2, 1, 2), quaternion(axis, angle), at)
    lights = [(-1.1, 3.3, 0.8), (0.9, 2.9, 1.2)] if is_room else [(-2, 4, 1.5), (2.5, 3.5, 2)]
    if "lights" in on:
        for number, at in enumerate(lights):
            scene.add_light(number, at, rng.uniform(-0.6, 0.6, 3) + [0, 0.4, 0])
    if is_room and "lights" not in on:
        emission = choices.rng(8).uniform(4, 10, 3).tolist()
        made = scene.mesh(LIGHT, quad(), "light", False, emission)
        if choices.has("both-sides", LIGHT):
            scene.ours["materials"][-1]["doubleSided"] = True
        scene.place(LIGHT, made, (0.8, 1, 0.8), quaternion([1, 0, 0], np.pi), [0.2, 3.2, -0.1])
    if not is_room:
        brightest = 4 if "lights" in on else 15
        cells = rng.uniform(0.2, 1, (16, 32, 3)).astype(np.float32) * (0.3 if "lights" in on else 1)
        for _ in range(6 if "scattered-environment" in on else 1):
            cells[rng.integers(2, 7), rng.integers(0, 32)] *= brightest
        mi.Bitmap(cells).write(str(folder / "environment.exr"))
        turned, scaled = float(rng.uniform(-180, 180)), float(rng.uniform(0.5, 2))
        environment = helmet.environment(mi, folder / "environment.exr")
        environment |= {"to_world": mi.ScalarTransform4f().rotate([0, 1, 0], turned), "scale": scaled}
        scene.theirs["environment"] = environment
        options += ["--environment", folder / "environment.exr", f"--environment-rotate={turned}"]
        options += [f"--environment-scale={scaled}"]
    made = None
    for number, (x, z) in enumerate([(-1, -1), (1, -0.9), (-0.9, 0.7), (1, 0.9)], 20):
        own = choices.rng(9, number)
        name, again = own.choice(["box", "sphere", "sheet"]), number == 23 and "instance" in on
        scale, turn, height = own.uniform(0.35, 0.55, 3), own.normal(size=4), own.uniform(0.9, 1.3)
        if choices.has("mirrored", number):
            scale *= [[-1, 1, 1], [1, -1, 1], [-1, -1, -1]][own.integers(3)]
        shape = {"box": box, "sphere": sphere, "sheet": quad}[name]()
        kind, emission, smooth = str(name), None, bool(name == "sphere" and choices.has("smooth", number))
        if number == 21 and choices.has("emitter", number):
            emission = own.uniform(0.5, 3, 3).tolist()
        elif name != "sheet" and choices.has("glass", number):
            kind = "glass"
        elif name == "sheet" and choices.has("thin", number):
            kind = "thin"
        made = made if again else scene.mesh(number, shape, kind, smooth, emission)
        scene.place(number, made, scale, turn / np.linalg.norm(turn), [x, height, z])
        if kind == "glass" and choices.has("light-in-glass", number) and not again:
            inner = scene.mesh(number + 10, box(), "box", False, own.uniform(2, 6, 3).tolist())
            scene.place(number + 10, inner, [0.1, 0.1, 0.1], quaternion([0, 1, 0], 0.3), [x, height, z])
    if is_room:
        eye, target, fov, half = [rng.uniform(-1.2, 1.2), rng.uniform(1.5, 2.8), 1.85], [0.0, 1.1, -0.2], 65.0, 1.0
    else:
        eye, target, fov, half = [rng.uniform(-3, 3), rng.uniform(2.5, 5), 6.0], [0.0, 0.8, 0.0], 32.0, 1.8
    up = [0.3, 1.0, 0.2] if "roll" in on else [0, 1, 0]
    if "camera-in-glass" in on and "orthographic" not in on:
        around = scene.mesh(40, sphere(), "glass", False)
        scene.place(40, around, [0.12, 0.12, 0.12], quaternion([0, 1, 0], 0.5), eye)
    scene.add_camera(size, eye, target, up, fov, half)
    scene.write(folder / "scene.gltf")
    options += ["--light-units", "standard"] if "standard-units" in on else []
    options += ["--indirect", "gather"] if "gather" in on else []
    volumes = scene.is_absorbing or ("lights" in on and on & {"mask", "blend"})
    integrator, described = "volpath" if volumes else "path", [" ".join(sorted(on)), *scene.described]
    return mi.load_dict(scene.theirs, parallel=False), integrator, size, options, described


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path, help="the photonmap program")
    parser.add_argument("first", type=int, help="the first seed")
    parser.add_argument("count", type=int, help="the number of scenes")
    parser.add_argument("--without", default="", help="features to leave out, separated by commas")
    parser.add_argument("--only", help="leave out all features but these")
    parser.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("out/models"))
    parser.add_argument("--variant", default="llvm_ad_rgb")
    parser.add_argument("--samples", type=int, default=128, help="paths per pixel and run of Mitsuba")
    parser.add_argument("--runs", type=int, default=6, help="runs of each with different seeds, at least 4")
    parser.add_argument("--passes", type=int, default=10)
    args, further = parser.parse_known_args()
    if args.runs < 4:
        parser.error("at least 4 runs are needed")
    without = {name for name in args.without.split(",") if name}
    if args.only is not None:
        without = set(FEATURES) - set(args.only.split(","))
    if without - set(FEATURES):
        parser.error(f"features are {', '.join(FEATURES)}")

    import drjit as dr
    import mitsuba as mi

    mi.set_variant(args.variant)
    gloss.make_bsdf(mi, dr)
    gltf_texture.register(mi, dr)
    args.folder.mkdir(parents=True, exist_ok=True)
    different = []
    for seed in range(args.first, args.first + args.count):
        scene, integrator, size, options, described = make(mi, seed, args.folder, without)
        path = mi.load_dict({"type": integrator, "max_depth": -1, "rr_depth": 32})
        ours, theirs = [], []
        for run in range(args.runs):
            theirs.append(np.array(mi.render(scene, integrator=path, spp=args.samples, seed=run), dtype=np.float64))
            picture = args.folder / f"ours-{run}.exr"
            command = [args.program, "render", args.folder / "scene.gltf", "--size", f"{size[0]}x{size[1]}", *options]
            command += ["--passes", args.passes, "--seed", run, "-o", picture]
            # Mitsuba's shadow rays start at the triangles.
            command += [*exported.OURS, "--no-terminator-offset", *further]
            subprocess.run(list(map(str, command)), check=True, stderr=subprocess.DEVNULL)
            layers = dict(mi.Bitmap(str(picture)).split())
            ours.append(np.array(layers["<root>"], dtype=np.float64)[..., :3])
        ours, theirs = np.array(ours), np.array(theirs)[..., :3]
        for name, pictures in (("ours", ours), ("theirs", theirs)):
            mi.Bitmap(pictures.mean(axis=0).astype(np.float32)).write(str(args.folder / f"{seed}-{name}.exr"))
        if not block_comparison.compare(ours * [1.1, 1.0, 1.0], theirs)[1]:
            sys.exit(f"seed {seed}: too noisy, a picture 10 % too bright in red would pass; use more samples or runs")
        lines, differ = block_comparison.compare(ours, theirs)
        print(f"seed {seed}: {'DIFFERS' if differ else 'agrees'}", *lines, *described, sep="\n  ", flush=True)
        different += [seed] if differ else []
    if different:
        sys.exit(f"the pictures differ: seeds {different}")


if __name__ == "__main__":
    main()
