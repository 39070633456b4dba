"""Progress of a render."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from typing import Any, Callable

from ._errors import InputError, warn

__all__ = ["Progress"]


@dataclass(frozen=True)
class Progress:
    """What a progress function is called with.

    `passes`: those that are finished. `total`: how many there will be; None if that depends on time or error. `fraction`: how
    much of the photons of the present pass are traced. `error`: the last estimate of the relative error, if there is one.
    """

    passes: int
    total: int | None
    fraction: float
    error: float | None


class Reporter:
    """Receives the events of a renderer, and shows the progress or calls a function with it."""

    def __init__(self, progress: Any, total: int | None) -> None:
        self._show = _show(progress, total)
        self._total = total
        self._passes = 0
        self._error: float | None = None

    def __call__(self, kind: str, number: int, count: int, value: float, text: str) -> bool:
        """False stops the render."""
        if kind == "warning":
            warn(text, RuntimeWarning)
            return True
        if kind == "error":
            self._error = value
        if kind == "pass":
            self._passes += 1
        return self.report(value if kind == "photons" else 0.0)

    def add(self, passes: int) -> bool:
        """Counts passes that were rendered elsewhere."""
        self._passes += passes
        return self.report(0.0)

    def report(self, fraction: float) -> bool:
        return self._show(Progress(self._passes, self._total, fraction, self._error)) is not False

    def close(self) -> None:
        """Ends a progress bar."""
        close = getattr(self._show, "close", None)
        if close is not None:
            close()


def _show(progress: Any, total: int | None) -> Callable[[Progress], Any]:
    if progress is None or progress is False:
        return lambda progress: None
    if progress is True:
        return _Bar(total)
    if callable(progress):
        return progress
    raise InputError(f"progress is {progress!r}, but must be True or a function of a photonmap.Progress")


class _Bar:
    """A bar by tqdm, or without it a line of text."""

    def __init__(self, total: int | None) -> None:
        try:
            from tqdm.auto import tqdm  # type: ignore[import-untyped, unused-ignore]
        except ImportError:
            self._bar = None
        else:
            self._bar = tqdm(total=total, unit="pass")
        self._total = total

    def __call__(self, progress: Progress) -> None:
        # Tenths of passes: a pass may take long.
        done = round(progress.passes + progress.fraction, 1)
        if self._bar is not None:
            self._bar.n = done
            if progress.error is not None:
                self._bar.set_postfix_str(f"error {progress.error:.3f}", refresh=False)
            self._bar.update(0)
            self._bar.refresh()
        else:
            of = "" if self._total is None else f" of {self._total}"
            sys.stderr.write(f"\r{done:g}{of} passes")
            sys.stderr.flush()

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()
        else:
            sys.stderr.write("\n")
