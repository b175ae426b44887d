"""Random cases that survive: some find the factors, others test them."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import islice

from analytic import simulate
from analytic.response import Outcome
from studies.cases.drawn import RandomCase, draw

CALIBRATE, TEST = "calibrate", "test"
"""What a case is for: to find the factors, or to hold them against errors that they never saw."""


def survivors(seed: int) -> Iterator[RandomCase]:
    """Yield without end the random cases in which the exact solution rocks and survives."""
    kept = (
        drawn
        for drawn in draw(seed)
        if simulate(drawn.block, drawn.motion).outcome is Outcome.ROCKED
    )
    for number, drawn in enumerate(kept):
        yield replace(drawn, case=number)


def both_sets(cases: int, tests: int, seed: int) -> Iterator[tuple[str, RandomCase]]:
    """Yield so many cases that test and so many that calibrate, each with what it is for.

    Those that test are drawn with the seed, those that calibrate with the next one.
    """
    for use, first, count in ((TEST, seed, tests), (CALIBRATE, seed + 1, cases)):
        for case in islice(survivors(first), count):
            yield use, case
