"""Renders in blocks of passes, which are added in order: into film files, and by workers of an executor.

The film depends on scene, settings, passes and grain alone, not on the number of workers, nor on which of them died.
"""

from __future__ import annotations

import concurrent.futures as futures
import hashlib
import itertools
import os
import pickle
import time
from collections import Counter
from typing import Any, Callable, Generator

from ._early import SPILLED, EarlyBlocks
from ._errors import DeviceError, Error, FileError, InputError, Interrupted, warn
from ._film import Film
from ._job import Job, work
from ._photonmap import RawFilm, add_blocks
from ._progress import Reporter

__all__ = ["render_blocks"]

# A worker that is lost, or the connection to it: the block is asked for again. What a block itself raises is final.
_LOST = (futures.BrokenExecutor, futures.CancelledError, ConnectionError, EOFError, TimeoutError)
# Such exceptions of engines that need not be installed: Dask, Ray.
_LOST_NAMES = {"KilledWorker", "CommClosedError", "FutureCancelledError", "WorkerCrashedError", "NodeDiedError"}


def render_blocks(
    job: Job,
    seed: int,
    passes: int,
    grain: int,
    *,
    path: str | None,
    checkpoint: float,
    executor: Any,
    window: int | None,
    retries: int,
    reporter: Reporter,
    target: tuple[float, float] | None = None,
) -> RawFilm:
    """The film of all passes; `path`: a film file that is continued, and written every `checkpoint` seconds.

    `target`: it ends when the estimated error of this share of the pixels is small enough, `(error, share)`. That is decided
    when the film has a fixed number of passes, whatever the workers have rendered by then.
    """
    film = RawFilm.load(path) if path is not None and os.path.exists(path) else None
    first, radii = 0, None
    if film is not None and path is not None:
        first, radii = film.next_pass(0, passes, grain, seed, path), film.radii()
        if first == passes or target is not None:
            _check_complete(job, film, path, grain)
        if first == passes or _is_reached(film, job, target, grain):
            reporter.add(first)
            return film
    reporter.add(first)
    if executor is None:
        return _local(job, film, (first, passes), grain, target, path, checkpoint, reporter)
    blocks = _remote(job, range(first, passes, grain), grain, radii, executor, window, retries, path)
    unsaved, written, is_checked = False, time.monotonic(), film is None
    try:
        for block in blocks:
            if film is None:
                film = block
            else:
                if not is_checked and path is not None:
                    film.check_key(block, path)
                    is_checked = True
                film.merge(block)
            unsaved = path is not None
            if path is not None and time.monotonic() - written >= checkpoint:
                try:
                    film.save(path)
                    unsaved = False
                except FileError as why:
                    warn(f"{why}; rendering goes on", RuntimeWarning)
                written = time.monotonic()
            if not reporter.add(grain) or _is_reached(film, job, target, grain):
                break
    except KeyboardInterrupt:
        raise _interrupted(film) from None
    finally:
        # Blocks that were finished before an error or Ctrl-C are kept.
        blocks.close()
        if unsaved and film is not None and path is not None:
            film.save(path)
    if film is None:
        raise DeviceError(_NOTHING)
    return film


def _interrupted(film: RawFilm | None) -> Interrupted:
    return Interrupted(Film(film) if film is not None and film.passes > 0 else None)


_NOTHING = "stopped before a block of passes was finished"


def _is_reached(film: RawFilm, job: Job, target: tuple[float, float] | None, grain: int) -> bool:
    return target is not None and film.is_reached(job.settings, *target, grain)


def _check_complete(job: Job, film: RawFilm, path: str, grain: int) -> None:
    """A complete film must be of this render too: the key of a renderer tells."""
    film.check_key(job.renderer().empty(grain, film.radii()), path)


def _local(
    job: Job,
    film: RawFilm | None,
    passes: tuple[int, int],
    grain: int,
    target: tuple[float, float] | None,
    path: str | None,
    checkpoint: float,
    reporter: Reporter,
) -> RawFilm:
    """Blocks by the devices of this process."""
    renderer = job.renderer()
    film = renderer.empty(grain) if film is None else film
    file = None if path is None else (path, checkpoint)
    try:
        has_passes = add_blocks(film, renderer, passes, grain, target, file, reporter)
    except KeyboardInterrupt:
        raise _interrupted(film) from None
    if not has_passes:
        raise DeviceError(_NOTHING)
    return film


def _remote(
    job: Job,
    starts: range,
    grain: int,
    radii: list[float] | None,
    executor: Any,
    window: int | None,
    retries: int,
    path: str | None,
) -> Generator[RawFilm, None, None]:
    """Blocks in order. At most `window` blocks wait for an earlier one in memory, and are being rendered, at a time."""
    payload = pickle.dumps(job, protocol=pickle.HIGHEST_PROTOCOL)
    key = hashlib.sha256(payload).hexdigest()
    make: Callable[[], Any] | None = None if hasattr(executor, "submit") else executor
    pool = executor if make is None else make()
    room = window or 2 * _workers(pool)
    upcoming = iter(starts)
    # Blocks to ask for before these: those that were lost, the first one last.
    waiting: list[int] = []
    running: dict[Any, int] = {}
    early = EarlyBlocks(room, path)
    losses: Counter[int] = Counter()

    def lose(lost: list[int], why: BaseException) -> None:
        for start in lost:
            losses[start] += 1
            if losses[start] > retries:
                raise DeviceError(
                    f"passes {start}..{start + grain} were lost {losses[start]} times, the last time by {why!r}; if "
                    "workers run out of memory, use fewer of them or a smaller picture"
                ) from why
        waiting.extend(lost)
        waiting.sort(reverse=True)

    try:
        for expected in starts:
            while expected not in early:
                try:
                    while len(running) < room and len(running) + len(early) < SPILLED * room:
                        if not waiting:
                            waiting.extend(itertools.islice(upcoming, 1))
                        if not waiting:
                            break
                        running[pool.submit(work, payload, key, waiting[-1], grain, radii)] = waiting[-1]
                        waiting.pop()
                    done, _ = futures.wait(list(running), timeout=1.0, return_when=futures.FIRST_COMPLETED)
                    for future in done:
                        film = future.result()._raw
                        early.add(running.pop(future), film)
                except Exception as why:
                    if isinstance(why, Error) or not (isinstance(why, _LOST) or type(why).__name__ in _LOST_NAMES):
                        raise
                    if isinstance(why, futures.BrokenExecutor):
                        # All of its blocks are lost, also those of workers that live.
                        lost = sorted(running.values())
                        running.clear()
                        if make is None:
                            raise DeviceError(
                                f"the executor is broken ({why}); give a function that makes executors, such as "
                                "executor=lambda: ProcessPoolExecutor(4), and another one is made"
                            ) from why
                        # If it was broken before it had any, the next block counts, so that this ends.
                        lose(lost or [waiting.pop()], why)
                        pool.shutdown(wait=False, cancel_futures=True)
                        pool = make()
                    else:
                        lost = [start for future, start in running.items() if _is_lost(future)]
                        running = {future: start for future, start in running.items() if not _is_lost(future)}
                        lose(lost, why)
            yield early.pop(expected)
    finally:
        early.close()
        for future in running:
            future.cancel()
        if make is not None:
            pool.shutdown(wait=True, cancel_futures=True)


def _is_lost(future: Any) -> bool:
    if not future.done():
        return False
    return future.cancelled() or future.exception() is not None


def _workers(pool: Any) -> int:
    workers = getattr(pool, "_max_workers", None) or os.cpu_count() or 1
    return workers if isinstance(workers, int) else 1


def check_executor(executor: Any) -> None:
    """Checks the type of an executor."""
    if not (hasattr(executor, "submit") or callable(executor)):
        raise InputError(
            f"executor is {executor!r}, but must be a concurrent.futures.Executor or a function that makes one"
        )
