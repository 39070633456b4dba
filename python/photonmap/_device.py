"""Names of devices."""

from __future__ import annotations

from typing import Any

from ._errors import InputError
from ._photonmap import prefers_gpu

__all__ = ["gpu", "gpus"]


def gpus(device: Any, prefers: bool = True) -> tuple[str, ...]:
    """The GPUs of `device`, by index or a part of the name; none for the CPU. ("",) is the preferred one, ("all",) all.

    "auto", "cpu", "gpu", "gpu:1", "gpu:H200", "gpu:0,1", "gpu:all". `prefers`: whether "auto" may be a GPU.
    """
    if device == "auto":
        return ("",) if prefers and prefers_gpu() else ()
    if device == "cpu":
        return ()
    if device == "gpu":
        return ("",)
    if isinstance(device, str) and device.startswith("gpu:"):
        names = tuple(name.strip() for name in device[4:].split(","))
        if all(names) and ("all" not in names or len(names) == 1):
            return names
    raise InputError(
        f'device is {device!r}, but must be "auto", "cpu", "gpu", or GPUs by index or name, such as "gpu:1", "gpu:0,1" or "gpu:all"'
    )


def gpu(device: Any, prefers: bool = True) -> str | None:
    """The GPU of `device`, for what needs a single one; None for the CPU."""
    names = gpus(device, prefers)
    if len(names) > 1 or names == ("all",):
        raise InputError(f'device is {device!r}, but only render() uses several GPUs; give one, such as "gpu:0"')
    return names[0] if names else None
