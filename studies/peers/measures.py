"""Error measures of a picture beside a reference; both are arrays (height, width, 3) of radiance."""

import math
from dataclasses import dataclass

import numpy as np

from .errors import Malformed, RunFailed, ToolMissing

# Pixels count as caustic if more than this share of the reference's light is in its caustic layer.
CAUSTIC_SHARE = 0.2
# The means of a channel may differ by this share plus 4.5 standard errors.
MEAN_LIMIT = 0.01
# What the mean test has to refuse, or the picture is too noisy to be tested.
BRIGHTENED = 1.05


def read_layers(path):
    """The layers of an EXR file by name, as float64; `RGB` is the picture."""
    try:
        import OpenEXR
    except ImportError:
        raise ToolMissing("OpenEXR is not installed", "pip install OpenEXR") from None
    channels = OpenEXR.File(str(path)).channels()
    if "RGB" not in channels:
        raise Malformed(f"{path}: has no channels R, G, B", "render it again")
    return {name: np.asarray(channel.pixels, dtype=np.float64) for name, channel in channels.items()}


def checked(picture, size, name):
    """The picture as float64, if it has size × size pixels and all its values are finite."""
    picture = np.asarray(picture, dtype=np.float64)
    if picture.shape != (size, size, 3):
        raise RunFailed(f"{name}: a picture of the shape {picture.shape}", f"{size} × {size} × 3 was asked for")
    bad = int(np.count_nonzero(~np.isfinite(picture).all(axis=2)))
    if bad:
        raise RunFailed(f"{name}: {bad} pixels are not finite", "report it to its authors; the run is left out")
    return picture


def squared_errors(picture, reference):
    """(x − y)²/(y² + ȳ²/100) of each pixel, with x and y the means of RGB; their mean is relMSE."""
    x, y = picture.mean(axis=2), reference.mean(axis=2)
    return (x - y) ** 2 / (y**2 + 0.01 * y.mean() ** 2)


def relmse(picture, reference):
    """As `photonmap compare` has it."""
    return float(squared_errors(picture, reference).mean())


def caustic_pixels(layers):
    """A mask of the pixels that have more than a fifth of their light from caustics."""
    return layers["caustic"].mean(axis=2) > CAUSTIC_SHARE * layers["RGB"].mean(axis=2)


@dataclass(frozen=True)
class Errors:
    """relMSE over all pixels, over caustic ones (None without these), and the median of the pixels' squared errors."""

    all: float
    caustic: float | None
    median: float


def errors(picture, reference, caustic):
    each = squared_errors(picture, reference)
    return Errors(float(each.mean()), float(each[caustic].mean()) if caustic.any() else None, float(np.median(each)))


@dataclass(frozen=True)
class Means:
    """Ratio of the means to those of the reference by channel, its standard error, and what follows."""

    ratio: tuple
    error: tuple
    verdict: str


def differs(picture, reference):
    """Ratios of the means and their standard errors by channel, and whether a ratio is too far from 1.

    The standard error is that of the mean of the differences, as if those of pixels were independent.
    """
    off = (picture - reference).reshape(-1, 3)
    mean = reference.mean(axis=(0, 1))
    ratio = 1.0 + off.mean(axis=0) / mean
    error = off.std(axis=0, ddof=1) / math.sqrt(len(off)) / mean
    return ratio, error, bool((np.abs(ratio - 1.0) > MEAN_LIMIT + 4.5 * error).any())


def shifted(picture, reference):
    """Whether the picture fits the reference better when it is moved by a pixel.

    Errors count as 1 at most, so that a few bright pixels do not decide, and a tenth of their mean as noise.
    """

    def misfit(down, right):
        moved = np.roll(picture, (down, right), axis=(0, 1))[1:-1, 1:-1]
        return np.minimum(squared_errors(moved, reference[1:-1, 1:-1]), 1.0).mean()

    here = misfit(0, 0)
    return any(misfit(down, right) < 0.9 * here for down in (-1, 0, 1) for right in (-1, 0, 1))


def compare_means(picture, reference):
    """`shifted`, `differs`, `agrees`, or `too noisy` if the picture would agree with a reference that has a channel 5 %
    brighter or darker."""
    ratio, error, far = differs(picture, reference)
    verdict = "differs" if far else "agrees"
    if shifted(picture, reference):
        verdict = "shifted"
    elif not far:
        for channel in range(3):
            for factor in (BRIGHTENED, 1.0 / BRIGHTENED):
                other = np.ones(3)
                other[channel] = factor
                if not differs(picture, reference * other)[2]:
                    verdict = "too noisy"
    return Means(tuple(map(float, ratio)), tuple(map(float, error)), verdict)


def block_differences(picture, reference, block=32):
    """Root mean squares over blocks of pixels: of the relative difference of their means, and of its standard error, as
    if errors of pixels were independent. Where the first is not larger, no bias is seen."""
    height, width = picture.shape[:2]
    off, mean = (x.mean(axis=2) for x in (picture - reference, reference))
    shape = (height // block, block, width // block, block)
    cells, means = (x.reshape(shape).swapaxes(1, 2).reshape(-1, block * block) for x in (off, mean))
    difference = cells.mean(axis=1) / means.mean(axis=1)
    error = cells.std(axis=1, ddof=1) / block / means.mean(axis=1)
    return math.sqrt((difference**2).mean()), math.sqrt((error**2).mean())
