"""What the study asks of a renderer. Each is a module of this package with the functions of `Renderer`."""

import os
import pathlib
from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True)
class Tools:
    """Programs, the number of threads of every renderer, and a folder for files in between."""

    program: pathlib.Path
    povray: str
    threads: int
    folder: pathlib.Path


@dataclass(frozen=True)
class Result:
    """A picture, processor and wall-clock seconds of the process that made it, and the settings in words."""

    picture: object
    processor: float
    preparation: float
    wall: float
    settings: str


class Renderer(Protocol):
    def version(self, tools):
        """Name and version; raises `ToolMissing` with a remedy."""

    def variants(self, scene):
        """Names of the methods that can render the scene, and a list of reasons why others are left out."""

    def render(self, tools, scene, variant, budget):
        """A `Result` for about `budget` seconds of processor time after preparation."""


def environment(**more):
    """The environment of a child, with `more` added."""
    return {**os.environ, **{name: str(value) for name, value in more.items()}}
