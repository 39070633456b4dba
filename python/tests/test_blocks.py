"""Renders in blocks: the same bits from one process, from workers, after losses, and from a continued file."""

import io
import os
import pickle
import signal
import time
import warnings
import zipfile
from concurrent.futures import BrokenExecutor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest

import photonmap as pm

JOB = {"scene": "cornell", "size": (16, 12), "photons": 3000, "passes": 8, "grain": 2}


def interrupt(progress):
    """Ctrl-C after five passes."""
    if progress.passes == 5:
        raise KeyboardInterrupt


def bits(film):
    """All sums, as the arrays of a film file."""
    arrays = [*film.layers.values(), film.error, film.normal, film.albedo, film.depth]
    data, _ = film._raw.to_bytes()
    with zipfile.ZipFile(io.BytesIO(data)) as file:
        sums = [file.read(name) for name in sorted(file.namelist()) if name.endswith(".npy")]
    assert len(sums) > 4
    return b"".join(sums) + b"".join(array.tobytes() for array in arrays)


@pytest.fixture(scope="module")
def expected():
    return bits(pm.render(**JOB))


def test_the_grain_decides_on_the_bits(expected):
    assert bits(pm.render(**JOB)) == expected
    assert bits(pm.render(**{**JOB, "grain": 4})) != expected
    # A grain of 1 has the bits of a render without blocks.
    without = {name: value for name, value in JOB.items() if name != "grain"}
    assert bits(pm.render(**{**JOB, "grain": 1})) == bits(pm.render(**without))


def test_blocks_backwards_have_other_bits(expected):
    """The comparison of bits notices another order."""
    from photonmap._job import Job

    settings = pm.Settings(preset="balanced", size=JOB["size"], photons=JOB["photons"]).to_json()
    renderer = Job(pm.Scene.builtin(JOB["scene"]), settings, JOB["size"], None, (), 0).renderer()
    blocks = [renderer.block(first, 2, None, None) for first in range(0, 8, 2)]

    def fold(blocks):
        first, *others = (pickle.loads(pickle.dumps(pm.Film(block))) for block in blocks)
        for other in others:
            first._raw.merge(other._raw)
        return bits(first)

    assert fold(blocks) == expected
    assert fold(blocks[::-1]) != expected
    with pytest.raises(pm.InputError, match="count twice"):
        fold([blocks[0], blocks[0]])


@pytest.mark.parametrize("workers", [1, 2, 3])
def test_workers_give_the_bits_of_one_process(expected, workers):
    context = get_context("spawn" if workers == 1 else "fork")
    with ProcessPoolExecutor(workers, mp_context=context) as pool:
        assert bits(pm.render(**JOB, executor=pool)) == expected


def test_threads_and_a_window_of_one(expected):
    with ThreadPoolExecutor(3) as pool:
        assert bits(pm.render(**JOB, executor=pool)) == expected
        seen = []
        assert bits(pm.render(**JOB, executor=pool, window=1, progress=seen.append)) == expected
        assert [progress.passes for progress in seen] == [0, 2, 4, 6, 8]


def test_a_target_stops_workers_at_the_pass_of_one_process(tmp_path):
    job = {"scene": "cornell", "size": (16, 12), "photons": 3000, "grain": 2, "share": 0.8}
    errors = {passes: _error(job, passes) for passes in (8, 16, 24, 32)}
    job["target_error"] = min(errors[16], errors[24], errors[32])
    assert job["target_error"] < errors[8]
    alone = pm.render(**job)
    assert alone.passes == next(passes for passes, error in errors.items() if error <= job["target_error"])
    for workers in (1, 2, 3):
        with ProcessPoolExecutor(workers, mp_context=get_context("fork")) as pool:
            assert bits(pm.render(**job, executor=pool)) == bits(alone)
    # Continued between two examinations; then there is nothing to do.
    path = tmp_path / "a.film"
    begun = {name: value for name, value in job.items() if name not in ("target_error", "share")}
    pm.render(**begun, errors=True, passes=10, film=path)
    assert bits(pm.render(**job, film=path)) == bits(alone)
    assert bits(pm.render(**job, film=path)) == bits(alone)
    # A limit that ends it before.
    assert pm.render(**job, passes=12).passes == 12
    with pytest.raises(pm.InputError, match="time: .*target_error"):
        pm.render(**begun, time=1)


def _error(job, passes):
    """The smallest target that so many passes reach, by bisection."""
    job = {name: value for name, value in job.items() if name != "share"}
    film = pm.render(**job, passes=passes, errors=True)._raw
    settings = pm.Settings(preset="balanced", size=job["size"], photons=job["photons"], errors=True).to_json()
    # Targets are below 1.
    low, high = 1e-3, 0.999
    while high > low * 1.001:
        middle = (low * high) ** 0.5
        low, high = (low, middle) if film.is_reached(settings, middle, 0.8, 2) else (middle, high)
    return high


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no SIGKILL")
def test_a_killed_worker_changes_nothing():
    # More blocks than may wait for an earlier one, so that some are left when the worker is killed.
    job = {**JOB, "passes": 24}
    made = []

    def make():
        made.append(ProcessPoolExecutor(2, mp_context=get_context("fork")))
        return made[-1]

    killed = []

    def kill(progress):
        if progress.passes == 2:
            process = next(iter(made[0]._processes.values()))
            os.kill(process.pid, signal.SIGKILL)
            killed.append(process.pid)
            # The blocks that remain may take less time than it takes to notice.
            deadline = time.monotonic() + 20
            while not made[0]._broken and time.monotonic() < deadline:
                time.sleep(0.01)

    film = pm.render(**job, executor=make, progress=kill, window=2)
    assert len(killed) == 1 and len(made) == 2
    assert bits(film) == bits(pm.render(**job))
    # An executor that cannot be replaced: an error that says what to do.
    with ProcessPoolExecutor(1, mp_context=get_context("fork")) as pool:
        made[:] = [pool]
        with pytest.raises(pm.DeviceError, match="a function that makes executors"):
            pm.render(**job, executor=pool, progress=kill, window=2)


class Unreliable:
    """An executor that loses blocks."""

    _max_workers = 2

    def __init__(self, losses, why):
        self.losses, self.why, self.asked = losses, why, []

    def submit(self, work, payload, key, first, *rest):
        future = Future()
        self.asked.append(first)
        if self.asked.count(first) <= self.losses:
            future.set_exception(self.why)
        else:
            future.set_result(work(payload, key, first, *rest))
        return future


def test_lost_blocks_are_asked_for_again(expected):
    class KilledWorker(Exception):
        pass

    for why in [ConnectionError("gone"), KilledWorker("gone")]:
        pool = Unreliable(2, why)
        assert bits(pm.render(**JOB, executor=pool)) == expected
        assert sorted(pool.asked) == [0] * 3 + [2] * 3 + [4] * 3 + [6] * 3
    with pytest.raises(pm.DeviceError, match="passes 0..2 were lost 4 times.*gone"):
        pm.render(**JOB, executor=Unreliable(9, ConnectionError("gone")))
    # What the input causes is final.
    pool = Unreliable(9, pm.InputError("a wrong scene"))
    with pytest.raises(pm.InputError, match="a wrong scene"):
        pm.render(**JOB, executor=pool)
    assert len(set(pool.asked)) == len(pool.asked)
    with pytest.raises(pm.DeviceError, match="function that makes"):
        pm.render(**JOB, executor=Unreliable(1, BrokenExecutor("gone")))
    for losses in [BrokenExecutor("gone"), None]:

        class Broken(Unreliable):
            def submit(self, *args):
                if losses is None:
                    raise BrokenExecutor("never worked")
                return super().submit(*args)

            def shutdown(self, **options):
                pass

        with pytest.raises(pm.DeviceError, match="were lost 4 times"):
            pm.render(**JOB, executor=lambda: Broken(9, losses))


def test_blocks_that_come_early_are_in_files(tmp_path, monkeypatch):
    """While the first block is slow, others go on: one may wait in memory, three in files, and the others are not asked for."""
    from photonmap import _early

    alone = bits(pm.render(**{**JOB, "passes": 16}, film=tmp_path / "alone.film"))
    most = []

    class Watched(_early.EarlyBlocks):
        def add(self, start, film):
            super().add(start, film)
            most.append((len(self._films), self.in_files))
            files = [name for folder in tmp_path.glob(".blocks-*") for name in os.listdir(folder)]
            assert len(files) == self.in_files

    monkeypatch.setattr("photonmap._blocks.EarlyBlocks", Watched)

    class Slow:
        asked = []

        def submit(self, work, payload, key, first, *rest):
            future = Future()
            self.asked.append(first)
            if first > 0:
                future.set_result(work(payload, key, first, *rest))
                if len(self.asked) == 8:
                    # Only now the first one.
                    self.first.set_result(work(payload, key, 0, *rest))
            else:
                self.first = future
            return future

    film = pm.render(**{**JOB, "passes": 20}, executor=Slow(), window=2, film=tmp_path / "a.film")
    assert max(memory for memory, _ in most) == 2 and max(files for _, files in most) == 6
    # With a window of two, eight blocks are asked for or wait; the ninth is asked for after the first has come.
    assert Slow.asked == list(range(0, 20, 2))
    assert bits(film) == bits(pm.render(**{**JOB, "passes": 20}))
    assert alone != bits(film)
    assert not list(tmp_path.glob(".blocks-*"))


def test_files_of_early_blocks_are_removed_after_an_error(tmp_path):
    class Failing:
        count = 0

        def submit(self, work, payload, key, first, *rest):
            future = Future()
            self.count += 1
            if self.count == 5:
                future.set_exception(ValueError("a defect"))
            elif first > 0:
                future.set_result(work(payload, key, first, *rest))
            return future

    with pytest.raises(ValueError, match="a defect"):
        pm.render(**{**JOB, "passes": 20}, executor=Failing(), window=2, film=tmp_path / "a.film")
    assert not list(tmp_path.glob(".blocks-*"))


def test_a_film_is_continued(expected, tmp_path):
    path = tmp_path / "a.film"
    assert bits(pm.render(**{**JOB, "passes": 4}, film=path)) != expected
    with ThreadPoolExecutor(2) as pool:
        assert bits(pm.render(**JOB, film=path, executor=pool, checkpoint=0)) == expected
    assert bits(pm.Film.load(path)) == expected
    # Nothing is left to do.
    assert bits(pm.render(**JOB, film=path)) == expected
    for other, words in [
        ({"passes": 4}, "more passes"),
        ({"passes": 10, "grain": 5}, "block|grain"),
        ({"passes": 10, "size": (12, 16)}, "size"),
        ({"passes": 10, "photons": 2000}, "photons"),
        ({"photons": 2000}, "photons"),
        ({"passes": 10, "scene": "two-rooms"}, "scene"),
        ({"passes": 10, "alpha": 0.5}, "alpha"),
        ({"passes": 10, "seed": 1}, "seed"),
    ]:
        before = path.read_bytes()
        with pytest.raises(pm.InputError, match=words):
            pm.render(**{**JOB, **other}, film=path)
        assert path.read_bytes() == before, other


def test_what_was_finished_before_ctrl_c_is_kept(expected, tmp_path):
    path = tmp_path / "a.film"
    with pytest.raises(KeyboardInterrupt):
        pm.render(**JOB, film=path, progress=interrupt)
    assert pm.Film.load(path).passes == 4
    assert bits(pm.render(**JOB, film=path)) == expected


@pytest.mark.parametrize("workers", [0, 1])
def test_a_checkpoint_that_fails_stops_nothing(tmp_path, expected, workers):
    out, away = tmp_path / "out", tmp_path / "away"
    out.mkdir()

    def watch(progress):
        """The folder of the film is not there when the second block is written."""
        if progress.passes == 2 + (workers == 0) and not away.exists():
            os.rename(out, away)
        if progress.passes == 4 + (workers == 0) and away.exists():
            os.rename(away, out)

    job = dict(JOB, film=out / "a.film", checkpoint=0, progress=watch)
    pool = ThreadPoolExecutor(1) if workers else None
    with pytest.warns(RuntimeWarning, match="out.a.film.*rendering goes on") as caught:
        film = pm.render(**job, executor=pool)
    assert caught[0].filename == __file__
    assert bits(film) == expected == bits(pm.Film.load(out / "a.film"))
    # Warnings may be errors: then it ends.
    os.remove(out / "a.film")
    with warnings.catch_warnings(), pytest.raises((RuntimeWarning, pm.FileError), match="a.film"):
        warnings.simplefilter("error")
        pm.render(**job, executor=pool)
    assert pm.Film.load(away / "a.film").passes == 2


def test_a_film_counts_the_photons_of_all_passes(tmp_path):
    path = tmp_path / "a.film"
    pm.render(**{**JOB, "passes": 4}, film=path)
    with ThreadPoolExecutor(2) as pool:
        film = pm.render(**JOB, film=path, executor=pool)
    counts = pm.Film.load(path).counts
    assert counts == film.counts == pm.render(**JOB).counts == pickle.loads(pickle.dumps(film)).counts
    paths = counts["paths"]
    assert (counts["passes"], paths.pop("emitted")) == (8, 8 * JOB["photons"])
    assert sum(paths.values()) == 8 * JOB["photons"] and counts["stored"]["global"] > 0
    assert counts["aimed_paths"]["emitted"] == 0
    assert pm.render(**{**JOB, "passes": 6}).counts != counts


@pytest.fixture
def dask():
    """A client of two processes."""
    distributed = pytest.importorskip("distributed", reason="Dask is not installed")
    with distributed.Client(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as client:
        yield client


def test_dask(expected, dask):
    assert bits(pm.render(**JOB, executor=dask.get_executor(retries=3))) == expected


def test_a_killed_worker_of_dask_changes_nothing(expected, dask):
    killed = []

    def kill(progress):
        if progress.passes == 2 and not killed:
            killed.append(next(iter(dask.run(os.getpid).values())))
            os.kill(killed[0], signal.SIGKILL)

    film = pm.render(**JOB, executor=dask.get_executor(retries=3), progress=kill, window=2)
    assert len(killed) == 1 and bits(film) == expected
