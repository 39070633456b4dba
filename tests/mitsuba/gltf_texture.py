"""A texture for Mitsuba 3 with what glTF 2.0 defines and Mitsuba's own textures lack; used by random_models.py.

It has two sets of texture coordinates, KHR_texture_transform, wrap modes of their own for both axes, a factor, vertex
colours and a cutoff of alpha. Texels are decoded from sRGB before they are interpolated.
"""

import math

import numpy as np

REPEAT, CLAMP, MIRROR = 10497, 33071, 33648
# Textures that were described, by the number that Mitsuba's constructor is given.
DESCRIBED = []


def linear(image):
    """Linear values of bytes in sRGB (IEC 61966-2-1)."""
    value = image / 255.0
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)


def describe(mi, select, factor=(1, 1, 1, 1), image=None, colors=False, cutoff=None, normal=None, emits=False, opacity=None):
    """A texture of `factor`, times an image if there is one, times vertex colours if `colors`.

    `select` is "rgb" or the number of a channel; with a cutoff the result is 0 below and 1 from there. An image is a dict of
    texels (rows of four linear numbers), set, offset, rotation, scale, wrap and nearest. `normal` is the scale of a normal
    map: its second component then points where the bitangent of Mitsuba does. A light is the product with its `opacity`.
    """
    DESCRIBED.append((select, factor, image, colors, cutoff, normal, emits, opacity))
    return mi.load_dict({"type": "gltf_texture", "number": len(DESCRIBED) - 1})


def register(mi, dr):
    class GltfTexture(mi.Texture):
        def __init__(self, props):
            mi.Texture.__init__(self, props)
            self.select, self.factor, self.image, self.colors, self.cutoff, self.normal, self.emits, self.opacity = DESCRIBED[
                props["number"]
            ]
            if self.image is not None:
                self.height, self.width = self.image["texels"].shape[:2]
                self.texels = mi.Float(np.ascontiguousarray(self.image["texels"], np.float32).ravel())

        def coordinates(self, si, active):
            if self.image["set"] == 0:
                u, v = si.uv.x, si.uv.y
            else:
                second = si.shape.eval_attribute_3("vertex_second", si, active)
                u, v = second.x, second.y
            u, v = u * self.image["scale"][0], v * self.image["scale"][1]
            # Counter-clockwise in the image, whose v points down.
            c, s = math.cos(self.image["rotation"]), math.sin(self.image["rotation"])
            return c * u + s * v + self.image["offset"][0], -s * u + c * v + self.image["offset"][1]

        def wrapped(self, index, count, mode):
            """The texel that glTF's wrap mode shows at an index, which may be negative."""
            if mode == CLAMP:
                return mi.UInt32(dr.clip(index, 0, count - 1))
            period = count if mode == REPEAT else 2 * count
            within = index - period * mi.Int32(dr.floor((mi.Float(index) + 0.5) / period))
            return mi.UInt32(within if mode == REPEAT else dr.minimum(within, period - 1 - within))

        def texel(self, x, y, active):
            column = self.wrapped(x, self.width, self.image["wrap"][0])
            at = (self.wrapped(y, self.height, self.image["wrap"][1]) * self.width + column) * 4
            return [dr.gather(mi.Float, self.texels, at + k, active) for k in range(4)]

        def channels(self, si, active):
            value = [mi.Float(float(part)) for part in self.factor]
            if self.image is not None:
                u, v = self.coordinates(si, active)
                x, y = u * self.width, v * self.height
                if self.image["nearest"]:
                    found = self.texel(mi.Int32(dr.floor(x)), mi.Int32(dr.floor(y)), active)
                else:
                    left, top = mi.Int32(dr.floor(x - 0.5)), mi.Int32(dr.floor(y - 0.5))
                    right, down = x - 0.5 - mi.Float(left), y - 0.5 - mi.Float(top)
                    rows = []
                    for row in (top, top + 1):
                        pair = [self.texel(column, row, active) for column in (left, left + 1)]
                        rows.append([dr.lerp(a, b, right) for a, b in zip(*pair)])
                    found = [dr.lerp(a, b, down) for a, b in zip(*rows)]
                value = [a * b for a, b in zip(value, found)]
            if self.colors:
                color = si.shape.eval_attribute_3("vertex_tint", si, active)
                cover = si.shape.eval_attribute_1("vertex_cover", si, active)
                value = [a * b for a, b in zip(value, [color.x, color.y, color.z, cover])]
            return value

        def eval_3(self, si, active=True):
            value = self.channels(si, active)[:3]
            if self.opacity is not None:
                value = [part * self.opacity.eval_1(si, active) for part in value]
            if self.normal is not None:
                hand = dr.select(si.shape.eval_attribute_1("vertex_hand", si, active) > 0, 1.0, -1.0)
                value = [2 * part - 1 for part in value]
                normal = mi.Vector3f(value[0] * self.normal, value[1] * self.normal * hand, value[2])
                normal, toward = dr.normalize(normal), dr.select(si.wi.z < 0, -1.0, 1.0) * si.wi
                cosine = dr.dot(normal, toward)
                normal = dr.select(cosine < 1e-3, dr.normalize(normal + toward * (1e-3 - cosine)), normal)
                value = list(normal * 0.5 + 0.5)
            return mi.Color3f(*value)

        def eval(self, si, active=True):
            if self.select == "rgb":
                return self.eval_3(si, active)
            return mi.Color3f(self.eval_1(si, active))

        def eval_1(self, si, active=True):
            if self.select == "rgb":
                return mi.luminance(self.eval_3(si, active))
            value = self.channels(si, active)[self.select]
            return value if self.cutoff is None else dr.select(value >= self.cutoff, mi.Float(1), mi.Float(0))

        def mean(self):
            return mi.Float(0.5)

        def is_spatially_varying(self):
            # Lights would sample positions in proportion to the texture.
            return not self.emits

        def to_string(self):
            return "GltfTexture[]"

    mi.register_texture("gltf_texture", GltfTexture)
