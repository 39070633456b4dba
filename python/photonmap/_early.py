"""Blocks that wait for an earlier one: a few in memory, further ones in files."""

from __future__ import annotations

import os
import tempfile

from ._photonmap import RawFilm

__all__ = ["EarlyBlocks"]

# Blocks that may be asked for or wait, for each one that may be in memory: while one worker is slow, others go on.
SPILLED = 4


class EarlyBlocks:
    """Films by the number of their first pass. At most `room` are in memory; of more, the last ones are in film files.

    The files are in a temporary folder beside `path`, or that of the system, which `close` removes.
    """

    def __init__(self, room: int, path: str | None) -> None:
        self._room = max(room, 1)
        self._beside = None if path is None else os.path.dirname(os.path.abspath(path))
        self._films: dict[int, RawFilm] = {}
        self._files: dict[int, str] = {}
        self._folder: tempfile.TemporaryDirectory[str] | None = None

    def __contains__(self, start: int) -> bool:
        return start in self._films or start in self._files

    def __len__(self) -> int:
        return len(self._films) + len(self._files)

    @property
    def in_files(self) -> int:
        """How many of them are in files."""
        return len(self._files)

    def add(self, start: int, film: RawFilm) -> None:
        """Keeps a block; if that is one too many in memory, the one that will be needed last is written to a file."""
        self._films[start] = film
        if len(self._films) > self._room:
            if self._folder is None:
                self._folder = tempfile.TemporaryDirectory(prefix=".blocks-", dir=self._beside)
            last = max(self._films)
            name = os.path.join(self._folder.name, f"{last}.film")
            self._films[last].save(name)
            self._files[last] = name
            del self._films[last]

    def pop(self, start: int) -> RawFilm:
        """Returns a block, and forgets it."""
        if start in self._films:
            return self._films.pop(start)
        name = self._files.pop(start)
        film = RawFilm.load(name)
        os.remove(name)
        return film

    def close(self) -> None:
        """Removes the files."""
        self._files.clear()
        if self._folder is not None:
            self._folder.cleanup()
            self._folder = None
