"""`render`: scenes to films."""

from __future__ import annotations

import math
import operator
import os
import time as clock
from typing import Any, Callable

from ._blocks import check_executor, render_blocks
from ._device import gpus
from ._errors import InputError, Interrupted
from ._film import Film
from ._job import Job
from ._materials import number
from ._photonmap import builtin_scenes as _builtin_scenes
from ._photonmap import check_blocks, check_writable, preset_passes
from ._progress import Progress, Reporter
from ._scene import Scene
from ._settings import Settings

__all__ = ["builtin_scenes", "render"]

DEFAULT_PRESET = "balanced"


def builtin_scenes() -> dict[str, str]:
    """Names and descriptions of the built-in scenes."""
    return dict(_builtin_scenes())


def render(
    scene: Scene | str | os.PathLike[str],
    *,
    size: tuple[int, int] | int = (512, 512),
    passes: int | None = None,
    time: float | None = None,
    target_error: float | None = None,
    share: float = 0.95,
    camera: str | None = None,
    preset: str | None = None,
    settings: Settings | None = None,
    device: str = "auto",
    threads: int | None = None,
    progress: bool | Callable[[Progress], Any] | None = None,
    film: str | os.PathLike[str] | None = None,
    grain: int | None = None,
    checkpoint: float = 300.0,
    executor: Any = None,
    window: int | None = None,
    retries: int = 3,
    overrides: str | os.PathLike[str] | None = None,
    environment: Any = None,
    **fields: Any,
) -> Film:
    """Renders a scene: a `Scene`, the name of a built-in one, or a file, to which `overrides` are applied. `environment` is light
    from all around, as the argument of `Scene.environment`: a file, "gradient", "constant", "constant:R,G,B", "sky:30,3".
    Without any light, there is "gradient" and a `SceneWarning`.

    It ends after so many `passes` (default: those of the preset, "balanced" if none is given), after `time` in seconds, or
    when the estimated relative error of the `share` of pixels is at most `target_error`, whichever comes first. With `time`
    or `target_error`, and without `passes`, `preset` and `settings`, settings that are not given are decided by the facts of a
    first pass, as in the program. `device`: "auto" is a GPU if there is one, and the CPU otherwise and with `film`, `grain` or `executor`;
    "cpu"; "gpu", which is never a software driver unless PHOTON_VK_DEVICE names one; a device by index or a part of its name, "gpu:1";
    or several, "gpu:0,1" or "gpu:all", which render blocks of `grain` passes. Further keyword arguments are fields of `Settings`, such as `photons=200_000`; they change those of `settings` or of the `preset`.
    `memory`: of the limit, half is for reading the file of a scene, whose textures are reduced if they do not fit.

    `progress`: True for a progress bar, or a function that is called with a `Progress`, and stops the render by returning
    False. Ctrl-C stops it within a pass and raises `Interrupted`, a `KeyboardInterrupt` whose `film` has the passes until then.

    `film`: a .film file, which is continued if it exists, and written every `checkpoint` seconds and at the end. `executor`: a
    `concurrent.futures.Executor`, or a function that makes one if it breaks, whose workers render blocks of `grain` passes.
    At most `window` blocks (twice the number of workers) are asked for at a time, and as many wait in memory for an earlier
    one; up to three times as many more wait in files beside `film`. A block that is lost with its worker is asked for again, up
    to `retries` times. The bits depend on scene, settings, passes and grain (default 1) alone, and so does the number of passes until a
    `target_error`: the film is examined at fixed numbers of passes, and what workers rendered beyond is discarded.
    """
    width, height = _size(size)
    if settings is not None and preset is not None:
        raise InputError("give either settings= or preset=, not both")
    if target_error is not None:
        fields.setdefault("errors", True)
    begun, given = clock.monotonic(), list(fields)
    is_open = settings is None and preset is None and passes is None and (time is not None or target_error is not None)
    if settings is not None:
        chosen = settings.replace(**fields)
    else:
        # The preset is for derived radii.
        usual = None if "estimator" in fields else DEFAULT_PRESET
        chosen = Settings(preset=preset or usual, size=(width, height), **fields)
    # The sums of blocks must not depend on the machine that renders them.
    devices = gpus(device, prefers=film is None and grain is None and executor is None)
    several = len(devices) > 1 or devices == ("all",)
    workers = 0 if threads is None else _whole("threads", threads, 4096)
    if passes is not None:
        passes = _whole("passes", passes, 2**32 - 2)
    elif time is None and target_error is None:
        passes = preset_passes(preset or DEFAULT_PRESET)
    if time is not None and not 0 < number("time", time) < math.inf:
        raise InputError(f"time is {time}, but must be above 0 and finite")
    error = None if target_error is None else (number("target_error", target_error), number("share", share))
    in_all = passes or 1
    in_blocks = film is not None or executor is not None or grain is not None or several
    if in_blocks:
        _check_blocks(time, chosen)
        if several and executor is not None:
            raise InputError(
                f'device is {device!r}: each worker of an executor uses one device; give "gpu" or one of them, or leave out '
                "the executor"
            )
        grain = 1 if grain is None else _whole("grain", grain, 2**32 - 2)
        in_all = (2**32 - 2) // grain * grain if passes is None else passes
        check_blocks(0, in_all, grain)
    if film is not None:
        _check_film(os.fspath(film))
    if executor is not None:
        check_executor(executor)
        if threads is None and not devices:
            workers = _threads_of_worker(executor)
    opened = _scene(scene, overrides, environment, chosen.memory)
    job = Job(opened, chosen.to_json(), (width, height), camera, devices, workers)
    reporter = Reporter(progress, passes)
    try:
        if in_blocks:
            raw = render_blocks(
                job,
                chosen.seed,
                in_all,
                grain or 1,
                path=None if film is None else os.fspath(film),
                checkpoint=number("checkpoint", checkpoint),
                executor=executor,
                window=None if window is None else _whole("window", window, 2**31),
                retries=operator.index(retries),
                reporter=reporter,
                target=error,
            )
        else:
            reporter.add(0)
            limit = None if time is None else number("time", time)

            def left() -> float | None:
                return None if limit is None else max(0.0, limit - (clock.monotonic() - begun))

            fixed = given if target_error is None else [*given, "bandwidth", "indirect"]
            renderer = job.renderer((left(), fixed) if is_open else None)
            rendered, interrupt = renderer.render(passes, left(), error, reporter)
            if rendered is None or interrupt is not None:
                raise Interrupted(None if rendered is None else Film(rendered)) from None
            raw = rendered
    except KeyboardInterrupt as why:
        raise (why if isinstance(why, Interrupted) else Interrupted()) from None
    finally:
        reporter.close()
    return Film(raw)


def _scene(scene: Any, overrides: str | os.PathLike[str] | None, environment: Any, memory: int | None) -> Scene:
    if isinstance(scene, Scene):
        if overrides is not None:
            raise InputError("overrides= is for files; give it to Scene.load")
        if environment is not None:
            raise InputError("environment= is for files and names; call the scene's method environment")
        return scene
    if not isinstance(scene, (str, os.PathLike)):
        raise InputError(f"scene is {scene!r}, but must be a Scene, a name or a path")
    name = os.fspath(scene)
    if os.path.splitext(name)[1]:
        # The other half is for the tables that are made of the scene, and for photons.
        half = None if memory is None else max(1, memory // 2)
        return Scene.load(name, overrides, environment=environment, memory=half)
    opened = Scene.builtin(name)
    if overrides is not None:
        opened._call("overrides", os.path.abspath(os.fspath(overrides)))
    return opened if environment is None else opened.environment(environment)


def _check_blocks(time: float | None, settings: Settings) -> None:
    """What would make passes depend on time, or on each other."""
    if time is not None:
        raise InputError(
            "time: with film, grain, executor or several devices, the passes must not depend on when and where they are rendered; give "
            "passes or target_error instead"
        )
    if settings.bandwidth == "per-pixel":
        raise InputError(
            'bandwidth "per-pixel": passes then depend on all passes before them; with film, grain, executor or several devices, use '
            'bandwidth="shared"'
        )


def _check_film(name: str) -> None:
    if not name.lower().endswith(".film"):
        raise InputError(f"{name}: the name of a film file ends in .film")
    check_writable(name)


def _threads_of_worker(executor: Any) -> int:
    """Threads of a worker: those of a local pool share the cores."""
    workers = getattr(executor, "_max_workers", None)
    return max(1, (os.cpu_count() or 1) // workers) if isinstance(workers, int) and workers > 0 else 0


def _size(size: Any) -> tuple[int, int]:
    try:
        width, height = (size, size) if isinstance(size, (int, float)) else size
        return _whole("size", width, 2**31), _whole("size", height, 2**31)
    except (TypeError, ValueError) as why:
        if isinstance(why, InputError):
            raise
        raise InputError(f"size is {size!r}, but must be width and height, such as (640, 480)") from None


def _whole(name: str, value: Any, most: int) -> int:
    try:
        # 1e5 is a float.
        number = int(value) if isinstance(value, float) and value.is_integer() else operator.index(value)
    except TypeError:
        number = 0
    if not 1 <= number <= most:
        raise InputError(f"{name} is {value!r}, but must be a whole number from 1 to {most}")
    return number
