"""Lights and cameras of random_models.py, in glTF and in Mitsuba 3."""

import base64
import json

import numpy as np

from model_meshes import Meshes

LUMENS_PER_WATT = 683.0


class Model(Meshes):
    """A scene for both programs."""

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
        self.choices.uses(f"{kind} light")

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


def look_at(eye, target, up):
    """The matrix of a node that looks along -z."""
    back = np.array(eye, float) - target
    back /= np.linalg.norm(back)
    right = np.cross(up, back)
    right /= np.linalg.norm(right)
    return np.block([[np.array([right, np.cross(back, right), back, eye]).T], [0, 0, 0, 1]])
