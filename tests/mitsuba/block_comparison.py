"""Compares pictures of any shape by channel and by block; used by random_models.py."""

import numpy as np

BLOCK = 8
# Of the means of channels, and of blocks.
LIMITS = (0.01, 0.04)


def compare(ours, theirs):
    """As exported.compare, for pictures of any shape, with dark blocks relative to a twentieth of the mean."""
    broken = [int((~np.isfinite(pictures)).sum()) for pictures in (ours, theirs)]
    if any(broken):
        return [f"{broken[0]} values of ours and {broken[1]} of theirs are infinite or not a number"], True
    lines, differ = [], False
    for name, limit, block in zip(("channels", "blocks"), LIMITS, (None, BLOCK)):
        off, error, excess = differences(ours, theirs, limit, block)
        # Not `excess > 0`, which NaN passes.
        differ |= not bool((excess <= 0).all())
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


def unnoticed(ours, theirs):
    """Names the errors that `compare` would pass if these pictures had them; an empty list if it notices all."""
    missed = []
    for name, value in (("NaN", np.nan), ("an infinite value", np.inf)):
        for whose, pictures in (("ours", ours), ("theirs", theirs)):
            broken = pictures.copy()
            broken[-1, -1, -1, -1] = value
            pair = (broken, theirs) if whose == "ours" else (ours, broken)
            missed += [] if compare(*pair)[1] else [f"{name} in {whose}"]
    # By the channels alone, and by the blocks alone.
    if not (differences(ours * [1.1, 1.0, 1.0], theirs, LIMITS[0], None)[2] > 0).any():
        missed.append("a picture 10 % too bright in red")
    if np.median(differences(ours * 1.25, theirs, LIMITS[1], BLOCK)[2]) <= 0:
        missed.append("25 % in more than half of the blocks")
    return missed


def differences(ours, theirs, limit, block):
    """Relative differences, their standard errors, and by how much they exceed the limit and 4.5 of these."""
    (a, a_error), (b, b_error) = (statistics(pictures, block) for pictures in (ours, theirs))
    base = np.maximum(b, 0.05 * theirs.mean())
    off, error = (a - b) / base, np.hypot(a_error, b_error) / base
    return off, error, np.abs(off) - limit - 4.5 * error


def statistics(pictures, block):
    """Means and standard errors of the channels, or of those of blocks of pixels."""
    runs, height, width = pictures.shape[:3]
    means = pictures.mean(axis=(1, 2))
    if block is not None:
        means = pictures.reshape(runs, height // block, block, width // block, block, 3).mean(axis=(2, 4))
    return means.mean(axis=0), means.std(axis=0, ddof=1) / runs**0.5
