"""Exceptions. Each message names what is wrong and what to do about it."""

__all__ = ["DeviceError", "Error", "FileError", "ForkError", "InputError", "OutOfMemoryError"]


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
    """A device is missing or fails, or a render was stopped before there was a picture."""

    __module__ = "photonmap"


class OutOfMemoryError(Error, MemoryError):
    """There is not enough memory."""

    __module__ = "photonmap"


class ForkError(Error, RuntimeError):
    """A forked process uses a GPU or a renderer of its parent."""

    __module__ = "photonmap"
