"""LuxCore: path tracing, with light tracing for caustics, bidirectional, with vertex merging, and with photon caches.

`main` runs in a process of its own.
"""

import importlib.metadata
import importlib.util
import json
import math
import os
import pathlib
import time

import numpy as np

from . import process
from .errors import ToolMissing
from .renderer import Result, environment
from .scene import SIZE, parse

DEPTH = 64
# Bidirectional engines are too bright by 3 to 8 % in `cornell` with Russian roulette, so that they go without it.
BIDIRECTIONAL = {"path.russianroulette.depth": DEPTH, "path.maxdepth": 16, "light.maxdepth": 16}
COMMON = {
    "film.width": SIZE,
    "film.height": SIZE,
    "film.filter.type": "BOX",
    "film.filter.width": 0.5,
    "film.outputs.0.type": "RGB",
    "film.outputs.0.filename": "unused.exr",
    "path.pathdepth.total": DEPTH,
    "path.pathdepth.diffuse": DEPTH,
    "path.pathdepth.glossy": DEPTH,
    "path.pathdepth.specular": DEPTH,
    "path.clamping.variance.maxvalue": 0.0,
    "light.maxdepth": DEPTH,
    "path.maxdepth": DEPTH,
    "sampler.type": "SOBOL",
    "sampler.sobol.adaptive.strength": 0.0,
}
# Radius of a search among caustic photons, about 1.3 times the width of a pixel; with LuxCore's own, 0.15, the squared
# error in the caustic pixels of `cornell-glass` is 1.
RADIUS = {"cornell-glass": 0.04, "ring-point": 0.01}
ENGINES = {
    "path": {"renderengine.type": "PATHCPU"},
    "hybrid": {"renderengine.type": "PATHCPU", "path.hybridbackforward.enable": 1},
    "bidir": {"renderengine.type": "BIDIRCPU"} | BIDIRECTIONAL,
    "bidirvm": {"renderengine.type": "BIDIRVMCPU"} | BIDIRECTIONAL,
    "pgi": {
        "renderengine.type": "PATHCPU",
        "path.photongi.sampler.type": "METROPOLIS",
        "path.photongi.photon.maxcount": 1_000_000,
        "path.photongi.photon.maxdepth": 16,
        # Its cache of indirect light made `cornell-glass` 5 % too bright.
        "path.photongi.indirect.enabled": 0,
        "path.photongi.caustic.enabled": 1,
        "path.photongi.caustic.maxsize": 100_000,
        "path.photongi.caustic.updatespp": 8,
    },
}


def version(tools):
    if importlib.util.find_spec("pyluxcore") is None:
        raise ToolMissing("LuxCore is not installed", "pip install pyluxcore")
    return f"LuxCore {importlib.metadata.version('pyluxcore')}"


def variants(scene):
    if all(mesh.kind == "diffuse" for mesh in scene.meshes):
        return ["lux-path", "lux-bidir"], []
    if scene.lights:
        return ["lux-hybrid", "lux-bidirvm", "lux-pgi"], ["lux-path: it finds no caustics of point lights"]
    return ["lux-path", "lux-bidir", "lux-bidirvm", "lux-pgi"], []


def preloaded():
    """The environment in which pyluxcore does not crash: its wheel brings an allocator that replaces malloc, and other
    packages that are loaded before it then free what it did not allocate."""
    folder = pathlib.Path(importlib.util.find_spec("pyluxcore").origin).parent.parent / "pyluxcore.libs"
    proxies = sorted(folder.glob("libtbbmalloc_proxy*.so*"))
    return environment(LD_LIBRARY_PATH=folder, LD_PRELOAD=proxies[0]) if proxies else environment()


def render(tools, scene, variant, budget):
    picture = tools.folder / "lux.npy"
    job = {"scene": str(scene.xml), "engine": variant.removeprefix("lux-"), "budget": budget}
    job |= {"threads": tools.threads, "picture": str(picture), "radius": RADIUS.get(scene.name, 0.15)}
    usage, found = process.run_module("luxcore", job, env=preloaded())
    settings = f"{found['samples']:.3g} samples a pixel"
    return Result(np.load(picture), usage.processor, found["preparation"], usage.wall, settings)


def description(scene):
    """The scene in LuxCore's properties."""
    camera = "scene.camera."
    properties = {
        camera + "type": "perspective",
        camera + "lookat.orig": scene.origin,
        camera + "lookat.target": scene.target,
        camera + "up": scene.up,
        camera + "fieldofview": scene.fov,
        # Its pictures are a row too low; the window is therefore moved by a pixel.
        camera + "screenwindow": (-1.0, 1.0, -1.0 - 2.0 / SIZE, 1.0 - 2.0 / SIZE),
    }
    for number, mesh in enumerate(scene.meshes):
        material = f"scene.materials.m{number}."
        if mesh.kind == "glass":
            properties |= {material + "type": "glass", material + "kr": (1.0,) * 3, material + "kt": mesh.colour}
            properties[material + "interiorior"] = mesh.index
        else:
            kind, colour = ("matte", "kd") if mesh.kind == "diffuse" else ("mirror", "kr")
            properties |= {material + "type": kind, material + colour: mesh.colour}
        if mesh.radiance:
            properties[material + "emission"] = mesh.radiance
        shape = f"scene.objects.o{number}."
        properties |= {shape + "material": f"m{number}", shape + "ply": str(mesh.path)}
    for number, light in enumerate(scene.lights):
        key = f"scene.lights.l{number}."
        # Its colour is the flux of a channel, 4π times the intensity.
        flux = tuple(4.0 * math.pi * part for part in light.intensity)
        properties |= {key + "type": "point", key + "position": light.position, key + "color": flux}
    return properties


def main(job):
    import pyluxcore

    def wrapped(values):
        properties = pyluxcore.Properties()
        for key, value in values.items():
            properties.Set(pyluxcore.Property(key, list(value) if isinstance(value, tuple) else value))
        return properties

    def session(engine):
        values = COMMON | ENGINES[engine] | {"native.threads.count": job["threads"]}
        values["path.photongi.caustic.lookup.radius"] = job["radius"]
        return pyluxcore.RenderSession(pyluxcore.RenderConfig(wrapped(values), scene))

    pyluxcore.Init(lambda message: None)
    scene = pyluxcore.Scene()
    scene.Parse(wrapped(description(parse(pathlib.Path(job["scene"]), "", ""))))
    preparation = time.process_time()
    # A path tracer's session builds the tree of the scene alone; each session builds it anew.
    first = session("path")
    first.Start()
    tree = time.process_time() - preparation
    first.Stop()
    begun = time.process_time()
    chosen = session(job["engine"])
    chosen.Start()
    samples = 0.0
    # Photon caches are filled before the first sample, which may take longer than the budget.
    while samples < 1.0 or time.process_time() - begun - tree < job["budget"]:
        time.sleep(0.02)
        chosen.UpdateStats()
        samples = chosen.GetStats().Get("stats.renderengine.total.samplecount").GetFloat() / SIZE**2
    chosen.Stop()
    picture = np.zeros((SIZE, SIZE, 3), dtype=np.float32)
    chosen.GetFilm().GetOutputFloat(pyluxcore.FilmOutputType.RGB, picture)
    # Its rows begin at the bottom.
    np.save(job["picture"], picture[::-1])
    print(json.dumps({"preparation": begun + tree, "samples": samples}), flush=True)
    # Its clean-up at the end of the interpreter aborts.
    os._exit(0)
