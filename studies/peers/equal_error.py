"""Equal-error times: how long a renderer takes for the error that another one reached."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Ratio:
    """A ratio of times; `sign` is `>` or `<` if it is only a bound, else empty."""

    value: float
    sign: str = ""

    def __str__(self):
        return f"{self.sign} {self.value:.2g}".strip()


def time_for(error, ladder):
    """Seconds after which a ladder of (seconds, error) reaches `error`, by straight lines between logarithms.

    A bound where the ladder begins below `error` (`<`), or where it does not get there (`>`).
    """
    ladder = sorted(ladder)
    if error >= ladder[0][1]:
        return Ratio(ladder[0][0], "" if error == ladder[0][1] else "<")
    for (t0, e0), (t1, e1) in zip(ladder, ladder[1:]):
        if e1 <= error < e0:
            share = math.log(e0 / error) / math.log(e0 / e1)
            return Ratio(t0 * (t1 / t0) ** share)
    return Ratio(ladder[-1][0], ">")


def ratio(point, ladder):
    """How many times as long `point`, (seconds, error), took as the ladder for that error; above 1 it is slower."""
    seconds, error = point
    ours = time_for(error, ladder)
    return Ratio(seconds / ours.value, {"<": ">", ">": "<", "": ""}[ours.sign])
