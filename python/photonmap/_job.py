"""A render as a value, which is sent to workers."""

from __future__ import annotations

import os
import pickle
import threading
from dataclasses import dataclass
from typing import Any

from ._errors import DeviceError
from ._film import Film
from ._photonmap import Renderer
from ._scene import Scene

__all__ = ["Job", "work"]


@dataclass(frozen=True)
class Job:
    """What the passes of a render depend on, and where they are rendered."""

    scene: Scene
    settings: str
    size: tuple[int, int]
    camera: str | None
    gpus: tuple[str, ...]
    threads: int

    def renderer(self, open: tuple[float | None, list[str]] | None = None) -> Renderer:
        """`open`: seconds and the settings that are fixed, if the others are decided by the facts of a first pass."""
        device = (list(self.gpus), self.threads)
        return Renderer(self.scene._raw(), self.scene.name, self.settings, self.size, self.camera, device, open)


# The last renderer of this process, while no thread uses it: its scene is prepared and its radii are known.
_idle: dict[tuple[int, str], Renderer] = {}
_lock = threading.Lock()


def _new_lock() -> None:
    global _lock
    _lock = threading.Lock()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_new_lock)


def work(payload: bytes, key: str, first: int, grain: int, radii: list[float] | None) -> Any:
    """Renders a block in a worker."""
    place = (os.getpid(), key)
    with _lock:
        renderer = _idle.pop(place, None)
    if renderer is None:
        renderer = pickle.loads(payload).renderer()
    block = renderer.block(first, grain, radii, None)
    with _lock:
        _idle.clear()
        _idle[place] = renderer
    if block is None:
        raise DeviceError(f"passes {first}..{first + grain} were stopped")
    return Film(block)
