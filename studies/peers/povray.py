"""POV-Ray: photons for caustics and radiosity for other indirect light."""

import math
import re

import numpy as np

from . import measures
from .errors import Unsupported
from .process import run
from .renderer import Result
from .scene import SIZE, read_ply

# Distance below which lights do not follow the inverse square law, in units of the scene.
NEAR = 1e-3
# Photons, directions of a radiosity sample, and rays along each side of a pixel, by quality.
QUALITIES = [(100_000, 80, 1), (250_000, 120, 2), (600_000, 250, 3), (2_500_000, 500, 5)]


def version(tools):
    found = re.search(r"POV-Ray (\S+)", run([tools.povray, "--version"]).output)
    return f"POV-Ray {found.group(1) if found else 'of an unknown version'}"


def variants(scene):
    if any(mesh.radiance and max(mesh.radiance) > 5.0 for mesh in scene.meshes):
        return [], [
            "POV-Ray: the light of its area lights does not fall with the cosine, and photons do not leave surfaces"
        ]
    return ["povray"], []


def vector(values):
    return "<" + ", ".join(f"{value:.9g}" for value in values) + ">"


def mesh_text(mesh):
    points, triangles = read_ply(mesh.path)
    vertices = ",".join(map(vector, points))
    faces = ",".join(map(vector, triangles))
    if mesh.kind == "glass":
        raise Unsupported("glass", "POV-Ray is compared in scenes without it")
    mirror = mesh.kind == "mirror"
    finish = f"reflection {{ rgb {vector(mesh.colour)} }} diffuse 0" if mirror else "diffuse 1"
    if mesh.radiance:
        if any(mesh.colour):
            raise Unsupported(
                "a light that reflects", "POV-Ray multiplies emission with the colour; leave the scene out"
            )
        # Emission is multiplied with the pigment.
        finish = f"emission rgb {vector(mesh.radiance)} diffuse 0"
    pigment = mesh.colour if mesh.kind == "diffuse" and not mesh.radiance else (1.0, 1.0, 1.0)
    photons = "target reflection on refraction off collect off" if mirror else "collect on"
    return f"""mesh2 {{
  vertex_vectors {{ {len(points)}, {vertices} }}
  face_indices {{ {len(triangles)}, {faces} }}
  pigment {{ rgb {vector(pigment)} }}
  finish {{ ambient 0 {finish} }}
  photons {{ {photons} }}
}}
"""


def scene_text(scene, photons, directions):
    """The scene in POV-Ray's language. A light of the intensity I gives the radiance ρ I cos θ/(π d²)."""
    forward = np.array(scene.target) - np.array(scene.origin)
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, scene.up)
    right /= np.linalg.norm(right)
    side = 2.0 * math.tan(math.radians(scene.fov) / 2.0)
    text = f"""#version 3.7;
global_settings {{
  assumed_gamma 1
  max_trace_level 64
  photons {{ count {photons} autostop 0 max_trace_level 64 }}
  radiosity {{ count {directions} error_bound 0.3 recursion_limit 5 nearest_count 10 low_error_factor 0.5
    gray_threshold 0 minimum_reuse 0.005 pretrace_start 0.08 pretrace_end 0.01 }}
}}
camera {{
  location {vector(scene.origin)} direction {vector(forward)}
  right {vector(side * right)} up {vector(side * np.cross(right, forward))}
}}
"""
    for light in scene.lights:
        # With fade_power 2 the light at distance d is multiplied with 2/(1 + (d/NEAR)²).
        power = np.array(light.intensity) / (2.0 * math.pi * NEAR**2)
        fading = f"fade_distance {NEAR} fade_power 2"
        text += (
            f"light_source {{ {vector(light.position)} rgb {vector(power)} {fading} photons {{ reflection on }} }}\n"
        )
    return text + "".join(map(mesh_text, scene.meshes))


def render(tools, scene, variant, budget):
    """The budget chooses a quality: 3, 8 and 20 s are about what three of them take in `ring-point`."""
    quality = sum(budget > limit for limit in (6.0, 15.0, 60.0))
    photons, directions, rays = QUALITIES[quality]
    source, picture = tools.folder / "povray.pov", tools.folder / "povray.exr"
    source.write_text(scene_text(scene, photons, directions))
    options = [f"+I{source}", f"+O{picture}", "+FE", f"+W{SIZE}", f"+H{SIZE}", "-D", f"+WT{tools.threads}", "-J"]
    options += ["+AM1", "+A0.0", f"+R{rays}"] if rays > 1 else ["-A"]
    usage = run([tools.povray, *options])
    parsing = re.search(r"Parse Time:.*?with ([0-9.]+) CPU-seconds", usage.output, re.DOTALL)
    prepared = float(parsing.group(1)) if parsing else 0.0
    settings = f"{photons} photons, {directions} directions, {rays}×{rays} rays a pixel"
    return Result(measures.read_layers(picture)["RGB"], usage.processor, prepared, usage.wall, settings)
