"""Meshes of random_models.py, and their instances below nodes of glTF and in Mitsuba 3."""

import numpy as np

import random_scenes
from model_materials import Materials
from random_choices import LIGHT


class Meshes(Materials):
    def mesh(self, number, shape, kind, smooth, emission=None):
        """A mesh of glTF, with what `place` needs for each of its instances."""
        rng = self.choices.rng(4, number)
        self.choices.uses(kind, number)
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
        has_tangents = self.choices.would_have("tangents", number)
        if smooth or (is_faceted and has_tangents):
            self.choices.uses("normals", number)
            attributes["NORMAL"] = self.accessor(normals.astype(np.float32), "VEC3", 5126)
        if "normalTexture" in material and has_tangents:
            self.choices.uses("tangents", number)
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


def directions(corners, uvs):
    """The directions in which u of a triangle grows and v, which points down, falls."""
    edges, steps = corners[1:] - corners[0], uvs[1:] - uvs[0]
    if abs(np.linalg.det(steps)) < 1e-12:
        return edges[0], edges[1]
    along, down = np.linalg.solve(steps, edges)
    return along, -down
