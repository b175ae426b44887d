"""What a case costs, in words: its time, and of how many runs it is the best."""

import math

from studies.measures.words import duration

LEAST_RUNS = 5
"""A time is of the best of so many runs at least, or marked."""

STEPPED = "A compiled loop over `mj_step` takes MuJoCo's steps; Python takes all others."
"""Said beside times of a step or of a case."""

OUTDATED = (
    "PyBullet's published times, but for `naive` and `recommended`, are those of a retired "
    "compiled loop, shorter than today's."
)
"""Said beside them until they are measured again."""


def cost_text(wall_s: float, runs: float, each: str = "") -> str:
    """Return a time, and what takes it, in words: "12.4 ms a case (4 runs)".

    Parameters
    ----------
    wall_s : float
        [s]; of nan the words are "-".
    runs : float
        Of how many runs it is the best; said where they are fewer than LEAST_RUNS.
    each : str, optional
        What takes the time, with a space before it.
    """
    if math.isnan(wall_s):
        return "-"
    few = f" ({runs:.0f} run{'s' if runs != 1 else ''})" if runs < LEAST_RUNS else ""
    return f"{duration(wall_s)}{each}{few}"
