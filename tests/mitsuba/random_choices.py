"""What the scenes of random_models.py have, by seed."""

import numpy as np

# Without "room" there is a floor under an environment map.
FEATURES = """room lights gloss rough-texture base-texture second-set wraps transform vertex-colors smooth normal-map tangents
glass thin tint absorption mask blend hierarchy mirrored instance emitter emission-texture both-sides single-sided orthographic
wide tall roll standard-units gather camera-in-glass light-in-glass scattered-environment""".split()
GLASS = {"glass", "thin", "absorption", "camera-in-glass", "light-in-glass"}
# What a feature excludes, also where it is left out itself: removing one feature brings no other back.
EXCLUDED = {"lights": GLASS, "wide": {"tall"}, "orthographic": {"camera-in-glass"}, "room": {"scattered-environment"}}
# Walls have lower numbers, objects higher ones.
LIGHT = 10


class Choices:
    """What a seed has: each question has random numbers of its own, so that no answer depends on another."""

    def __init__(self, seed, without):
        self.seed, self.used = seed, {}
        self.on = {name for number, name in enumerate(FEATURES) if self.rng(0, number).random() < 0.5}
        for name in self.on & set(EXCLUDED):
            self.on -= EXCLUDED[name]
        self.drawn = set(self.on)
        self.on -= without
        if "glass" not in self.on:
            self.on -= {"absorption", "light-in-glass"}

    def rng(self, *place):
        return np.random.default_rng([self.seed, *place])

    def has(self, name, place):
        """Whether the object of this number has the feature, which is noted: to be asked where it has an effect."""
        return self.would_have(name, place) and self.uses(name, place)

    def first(self, names, place):
        """The first of the features that the object has, None if that is left out."""
        first = next((name for name in names if name in self.drawn and self.draws(name, place)), None)
        return first if first in self.on and self.uses(first, place) else None

    def would_have(self, name, place):
        """As `has`, but not noted."""
        return bool(name in self.on and self.draws(name, place))

    def draws(self, name, place):
        return self.rng(1, FEATURES.index(name), place).random() < 0.7

    def uses(self, name, place=None):
        """Notes what an object has, or the scene as a whole."""
        self.used.setdefault(place, []).append(name)
        return True

    def described(self):
        """All that is used, and what each object has."""
        everywhere = {name for names in self.used.values() for name in names} & set(FEATURES)
        lines = [" ".join(sorted(everywhere)), *(name for name in self.used.get(None, []) if name not in FEATURES)]
        for place in sorted(place for place in self.used if place is not None):
            lines.append(f"{place}: {' '.join(dict.fromkeys(self.used[place]))}")
        return lines
