"""What a case costs, in words: its time, of how many runs, and who took the steps."""

import math
from collections.abc import Iterable

from studies.measures.words import duration

LEAST_RUNS = 5
"""A time is of the best of so many runs at least, or marked."""

LOOPS = {"compiled": "stepped by a compiled loop", "python": "stepped from Python"}
"""Who takes an engine's steps one after the other, in words."""


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


def loop_of(drivers: Iterable[str]) -> str:
    """Return who took the steps of several runs, a key of LOOPS: python if it was so in any."""
    return max((driver.partition(":")[0] for driver in drivers), default="")
