"""Mitsuba 3: its path tracer, and its particle tracer for point lights, which a path tracer cannot hit.

`main` runs in a process of its own: it adds up pictures of a few samples until the time is used.
"""

import importlib.metadata
import importlib.util
import json
import time

import numpy as np

from . import process
from .errors import ToolMissing
from .renderer import Result
from .scene import SIZE

# Samples of a pixel in each of the pictures that are added up.
CHUNK = 8


def version(tools):
    if importlib.util.find_spec("mitsuba") is None:
        raise ToolMissing("Mitsuba 3 is not installed", "pip install mitsuba")
    return f"Mitsuba {importlib.metadata.version('mitsuba')}"


def variants(scene):
    if not scene.lights:
        return ["mitsuba-path"], []
    reason = "mitsuba-path: point lights cannot be hit, so that it has no caustics and no light seen in mirrors"
    return ["mitsuba-ptracer"], [reason]


def render(tools, scene, variant, budget):
    picture = tools.folder / "mitsuba.npy"
    kind = variant.removeprefix("mitsuba-")
    job = {"scene": str(scene.xml), "kind": kind, "budget": budget, "threads": tools.threads, "picture": str(picture)}
    usage, found = process.run_module("mitsuba3", job)
    settings = f"{found['variant']}, {found['samples']} samples a pixel"
    return Result(np.load(picture), usage.processor, found["preparation"], usage.wall, settings)


def main(job):
    import drjit
    import mitsuba as mi

    try:
        # Vectorised by LLVM, and twice as fast as the scalar variant.
        mi.set_variant("llvm_ad_rgb")
        drjit.eval(mi.Float(1.0) + 1.0)
    except Exception:
        mi.set_variant("scalar_rgb")
    drjit.set_thread_count(job["threads"])
    scene = mi.load_file(job["scene"])
    integrator = mi.load_dict({"type": job["kind"], "max_depth": -1})
    # The first picture compiles the kernels.
    np.array(mi.render(scene, integrator=integrator, spp=CHUNK, seed=0))
    preparation = time.process_time()
    total, chunks = np.zeros((SIZE, SIZE, 3)), 0
    while chunks == 0 or time.process_time() - preparation < job["budget"]:
        chunks += 1
        total += np.array(mi.render(scene, integrator=integrator, spp=CHUNK, seed=chunks), dtype=np.float64)
    np.save(job["picture"], total / chunks)
    print(json.dumps({"preparation": preparation, "samples": chunks * CHUNK, "variant": mi.variant()}))
