"""What can go wrong, each with a remedy."""


class PeersError(Exception):
    """An error that names its cause and a remedy."""

    def __init__(self, cause, remedy):
        super().__init__(f"{cause}: {remedy}")
        self.cause, self.remedy = cause, remedy


class ToolMissing(PeersError):
    """A program or a Python package is not installed."""


class RunFailed(PeersError):
    """A program ended with an error, took too long, or wrote something that is no picture."""


class Unsupported(PeersError):
    """A converter meets something in a scene that it has no counterpart for."""


class Malformed(PeersError):
    """A file is not what this study writes or reads."""
