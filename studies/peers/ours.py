"""photonmap, as its command line offers it: a time limit, and two presets with as many passes as the time allows."""

import json

from . import measures
from .errors import RunFailed
from .process import run
from .renderer import Result
from .scene import SIZE

# Passes of the short render from which the number of passes for a given time follows.
SHORT = 4


def version(tools):
    return run([tools.program, "--version"]).output.strip()


def variants(scene):
    return ["ours-time", "ours-balanced", "ours-final"], []


def command(tools, scene, options):
    return [tools.program, "render", scene.source, "--backend", "cpu", "--threads", tools.threads, *options]


def measure(tools, scene, options):
    """Usage, preparation and layers of a render. Loading and building the tree of the scene count as preparation;
    photonmap reports their wall-clock time, which is less than their processor time on an idle machine."""
    picture, report = tools.folder / "ours.exr", tools.folder / "ours.json"
    options = ["--size", f"{SIZE}x{SIZE}", *options]
    usage = run(command(tools, scene, [*options, "-o", picture, "--json", report]))
    seconds = json.loads(report.read_text())["seconds"]
    return usage, seconds["load"] + seconds["prepare"] + seconds["bvh"], measures.read_layers(picture)


def settings(tools, scene, variant, budget):
    if variant == "ours-time":
        return ["--time", f"{budget / tools.threads:g}"]
    preset = ["--preset", variant.removeprefix("ours-")]
    usage, prepared, _ = measure(tools, scene, [*preset, "--passes", SHORT])
    each = (usage.processor - prepared) / SHORT
    if each <= 0.0:
        raise RunFailed(f"{SHORT} passes of {scene.name} took no time", "the report of photonmap is wrong")
    return [*preset, "--passes", max(1, round(budget / each))]


def render(tools, scene, variant, budget):
    options = settings(tools, scene, variant, budget)
    usage, prepared, layers = measure(tools, scene, options)
    words = " ".join(map(str, options))
    return Result(layers["RGB"], usage.processor, prepared, usage.wall, words)
