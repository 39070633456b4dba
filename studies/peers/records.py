"""What one run measured: a JSON file and a picture beside it. Runs that have both are not made again."""

import json
import os
from dataclasses import asdict, dataclass

import numpy as np

from .errors import Malformed


@dataclass(frozen=True)
class Row:
    """One picture. Times are seconds of the child process; `processor` and `preparation` add up over threads.

    `preparation` is the part of `processor` before rendering, as far as the renderer reports it.
    """

    scene: str
    renderer: str
    variant: str
    budget: float
    processor: float
    preparation: float
    wall: float
    threads: int
    version: str
    settings: str

    @property
    def net(self):
        return self.processor - self.preparation


@dataclass(frozen=True)
class Store:
    """The folder of rows and pictures."""

    folder: object

    def path(self, scene, variant, budget, extension):
        return self.folder / f"{scene}--{variant}--{budget:g}.{extension}"

    def load(self, scene, variant, budget):
        """The row, or None if the run is still to be made."""
        path = self.path(scene, variant, budget, "json")
        return read_row(path) if path.exists() else None

    def save(self, row, picture):
        """Writes the picture first: a row therefore has one."""
        self.folder.mkdir(parents=True, exist_ok=True)
        np.save(self.path(row.scene, row.variant, row.budget, "npy"), picture.astype(np.float32))
        path = self.path(row.scene, row.variant, row.budget, "json")
        partial = path.with_suffix(".partial")
        partial.write_text(json.dumps(asdict(row), indent=1) + "\n")
        os.replace(partial, path)

    def picture(self, row):
        return np.load(self.path(row.scene, row.variant, row.budget, "npy")).astype(np.float64)

    def rows(self):
        found = [read_row(path) for path in sorted(self.folder.glob("*.json"))]
        return sorted(found, key=lambda row: (row.scene, row.variant, row.budget))


def read_row(path):
    try:
        return Row(**json.loads(path.read_text()))
    except (ValueError, TypeError) as error:
        raise Malformed(f"{path}: {error}", "delete the file, and the run is made again") from None
