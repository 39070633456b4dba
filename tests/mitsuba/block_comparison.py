"""Compares pictures of any shape by channel and by block; used by random_models.py."""

import numpy as np

BLOCK = 8
LIMITS = (0.01, 0.04)


def compare(ours, theirs):
    """As exported.compare, for pictures of any shape, with dark blocks relative to a twentieth of the mean."""
    lines, differ = [], False
    for name, limit, block in zip(("channels", "blocks"), LIMITS, (None, BLOCK)):
        (a, a_error), (b, b_error) = (statistics(pictures, block) for pictures in (ours, theirs))
        base = np.maximum(b, 0.05 * theirs.mean())
        off, error = (a - b) / base, np.hypot(a_error, b_error) / base
        excess = np.abs(off) - limit - 4.5 * error
        differ |= bool((excess > 0).any())
        worst = np.unravel_index(excess.argmax(), off.shape)
        # Where only the environment is seen, the difference is rounding and the error may be 0.
        rms, z = np.sqrt((off**2).mean()), np.sqrt(((off / np.maximum(error, 5e-4)) ** 2).mean())
        lines.append(
            f"{name}: worst {100 * off[worst]:+.2f} ± {100 * error[worst]:.2f} % at {tuple(map(int, worst))}, "
            f"rms {100 * rms:.2f} %, rms z {z:.2f}, {(excess > 0).sum()} of {off.size} beyond"
        )
        if block is None:
            lines[-1] += " (" + ", ".join(f"{100 * o:+.2f} ± {100 * e:.2f}" for o, e in zip(off, error)) + ")"
    return lines, differ


def statistics(pictures, block):
    """Means and standard errors of the channels, or of those of blocks of pixels."""
    runs, height, width = pictures.shape[:3]
    means = pictures.mean(axis=(1, 2))
    if block is not None:
        means = pictures.reshape(runs, height // block, block, width // block, block, 3).mean(axis=(2, 4))
    return means.mean(axis=0), means.std(axis=0, ddof=1) / runs**0.5
