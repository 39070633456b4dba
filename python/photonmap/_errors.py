"""Exceptions. Each message names what is wrong and what to do about it."""

from __future__ import annotations

import sys
import warnings
from typing import Any

__all__ = [
    "DeviceError",
    "Error",
    "FileError",
    "ForkError",
    "InputError",
    "Interrupted",
    "OutOfMemoryError",
    "SceneWarning",
    "warn",
]


class Error(Exception):
    """Base class of the exceptions of this package."""

    __module__ = "photonmap"


class InputError(Error, ValueError):
    """An argument, a scene or a setting is invalid."""

    __module__ = "photonmap"


class FileError(Error, OSError):
    """A file cannot be read or written."""

    __module__ = "photonmap"


class DeviceError(Error, RuntimeError):
    """A device or the denoiser is missing or fails, or a render was stopped before there was a picture."""

    __module__ = "photonmap"


class OutOfMemoryError(Error, MemoryError):
    """There is not enough memory."""

    __module__ = "photonmap"


class ForkError(Error, RuntimeError):
    """A forked process uses a GPU or a renderer of its parent."""

    __module__ = "photonmap"


class Interrupted(KeyboardInterrupt):
    """Ctrl-C stopped a render. `film`: the `Film` of the passes until then; None if there is none."""

    __module__ = "photonmap"

    def __init__(self, film: Any = None) -> None:
        self.film = film
        kept = "before there was a picture" if film is None else f"the attribute film has {film.passes} passes"
        super().__init__(f"interrupted; {kept}")

    def __reduce__(self) -> tuple[Any, ...]:
        return Interrupted, (self.film,)


class SceneWarning(UserWarning):
    """Something of a scene is rendered in another way than it is described, not at all, or is suspicious."""

    __module__ = "photonmap"


def warn(text: str, category: type[Warning]) -> None:
    """Warns at the line outside of this package that called it."""
    package = __name__.partition(".")[0]
    frame, level = sys._getframe(), 1
    while frame.f_back is not None and frame.f_globals.get("__name__", "").partition(".")[0] == package:
        frame, level = frame.f_back, level + 1
    warnings.warn(text, category, stacklevel=level)
