"""The reference of a scene: the mean of two long renders of photonmap with other seeds.

Their difference shows its noise. That it has no bias of note is for the other renderers to confirm, by their means.
"""

import os
from dataclasses import dataclass

import numpy as np

from . import measures, ours
from .errors import PeersError
from .process import run
from .scene import SCENES, SIZE

SEEDS = (1000, 1001)
# Passes of each half, which take one to five minutes of processor time.
PASSES = {"cornell": 768, "cornell-glass": 256, "ring-point": 384}


@dataclass(frozen=True)
class Reference:
    """Means of the halves, the mask of caustic pixels, and the errors that noise leaves in the mean."""

    picture: np.ndarray
    caustic: np.ndarray
    noise: measures.Errors


def options(name, seed):
    """Smaller radii than any preset has, and many photons for caustics."""
    aimed = "400k" if SCENES[name] else "auto"
    settings = ["--preset", "balanced", "--photons", "100k", "--caustic-photons", aimed, "--radius-factor", "0.6"]
    return [*settings, "--passes", PASSES[name], "--seed", seed, "--size", f"{SIZE}x{SIZE}"]


def render(tools, scene, folder):
    """Makes the halves that are missing and returns the reference."""
    folder.mkdir(parents=True, exist_ok=True)
    halves = [folder / f"{scene.name}-{seed}.exr" for seed in SEEDS]
    for seed, path in zip(SEEDS, halves):
        if not path.exists():
            print(f"{scene.name}: reference, seed {seed}", flush=True)
            partial = path.with_name(f"partial-{path.name}")
            run(ours.command(tools, scene, [*options(scene.name, seed), "-o", partial]))
            os.replace(partial, path)
    return combine(*map(measures.read_layers, halves))


def combine(first, second):
    """The reference of two independent halves. The variance of their mean is a quarter of the squared difference."""
    if first["RGB"].shape != second["RGB"].shape:
        raise PeersError("the halves of a reference differ in size", "delete them, and they are rendered again")
    mean = {name: 0.5 * (first[name] + second[name]) for name in ("RGB", "caustic")}
    caustic = measures.caustic_pixels(mean)
    # The errors of `mean + half the difference` beside `mean` are those of noise as large as that of the mean.
    shifted = mean["RGB"] + 0.5 * (first["RGB"] - second["RGB"])
    return Reference(mean["RGB"], caustic, measures.errors(shifted, mean["RGB"], caustic))
