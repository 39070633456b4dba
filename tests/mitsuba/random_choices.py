"""What the scenes of random_models.py have, by seed."""

import numpy as np

# Without "room" there is a floor under an environment map.
FEATURES = """room lights gloss rough-texture base-texture second-set wraps transform vertex-colors smooth normal-map tangents
glass thin tint absorption mask blend hierarchy mirrored instance emitter emission-texture both-sides single-sided orthographic
wide tall roll standard-units gather camera-in-glass light-in-glass scattered-environment""".split()
GLASS = {"glass", "thin", "absorption", "camera-in-glass", "light-in-glass"}
# Walls have lower numbers, objects higher ones.
LIGHT = 10


class Choices:
    """What a seed has: each question has random numbers of its own, so that no answer depends on another."""

    def __init__(self, seed, without):
        self.seed = seed
        self.on = {name for number, name in enumerate(FEATURES) if self.rng(0, number).random() < 0.5} - without
        if "lights" in self.on:
            self.on -= GLASS
        if "glass" not in self.on:
            self.on -= {"absorption", "light-in-glass"}

    def rng(self, *place):
        return np.random.default_rng([self.seed, *place])

    def has(self, name, place):
        """Whether the object of this number has the feature."""
        return name in self.on and self.rng(1, FEATURES.index(name), place).random() < 0.7
