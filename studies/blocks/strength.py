"""How strong a ground motion must be: the factors on it at which a block lifts and overturns.

Outcomes are looked up on a grid of factors, a hundredth apart, and the first that overturns is
followed down to the edge. Under a long record overturning begins in slivers, some no wider than
1e-5 of the factor: one that lies between two points of the grid is not seen, and what survives
further up does so at points of the grid.
"""

import math
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import groupby

from analytic.block import RigidBlock
from analytic.conditioning import scaled
from analytic.record import Record
from analytic.response import Outcome
from analytic.simulate import simulate, strongest
from studies.old.provenance import usable_cores

APART = 0.01
"""Relative distance of two factors; of a block that starts off rest, up to the onset, over it."""
MOST_ONSETS = 100.0
"""Over the factor that lifts a block: the largest that is tried."""
BEYOND = 1.25
"""Over the first factor that overturns: how far survival is looked for."""
WIDTH = 1e-6
"""Relative width to which the first edge is known."""
AT_ONCE = 4
"""Factors that each core tries before the next are."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Strength:
    """Factors on a motion.

    Attributes
    ----------
    lifts : float
        At which the block leaves its base; 0 if it starts off rest.
    margin : float
        The least that was found to overturn it, to 1e-6 of it, from above; inf if none up to
        MOST_ONSETS onsets does.
    friction : float
        That the exact solution needs at the margin, or at the largest factor tried if it is inf.
    islands : tuple of (float, float)
        Between which points of the grid the block survives again, up to BEYOND times the margin.
    """

    lifts: float
    margin: float
    friction: float
    islands: tuple[tuple[float, float], ...] = ()


class UndecidedError(Exception):
    """Why a search finds no margin."""


def strength(
    block: RigidBlock,
    motion: Record,
    start: tuple[float, float],
    limit_s: float = math.inf,
    tell: Callable[[int], object] = abs,
) -> Strength:
    """Find by which factors on a motion the exact block overturns.

    Parameters
    ----------
    block : RigidBlock
    motion : Record
        As it is at the factor 1.
    start : (float, float)
        Rotation [rad] and angular velocity [rad/s] at time 0, the same for all factors.
    limit_s : float, optional
        Wall-clock time [s] after which no further factor is tried.
    tell : callable, optional
        Called with the number of factors tried since it was called before.

    Raises
    ------
    UndecidedError
        If the time is up, or a solution failed.
    ValueError
        If the start is none (`analytic.start.folded` says which), or nothing moves.
    """
    peak = strongest(motion)
    if peak == 0.0:
        raise ValueError("the motion is zero throughout; no factor makes it stronger")
    solve = scaled(block, motion, start=start)
    end = time.monotonic() + limit_s

    def outcome(factor: float) -> Outcome:
        if time.monotonic() > end:
            raise UndecidedError(f"no margin within the time limit of {limit_s:g} s")
        found = solve(factor, 1.0)[1]
        if found is Outcome.FAILED:
            raise UndecidedError(f"no margin: the solution at the factor {factor:g} failed")
        return found

    at_rest = start == (0.0, 0.0)
    onset = math.tan(block.alpha) * block.gravity / peak
    lifts = onset if at_rest else 0.0
    factors = grid(onset, at_rest)
    found: list[Outcome] = []
    cores = usable_cores()

    def look(begin: int) -> list[Outcome]:
        return [outcome(factor) for factor in factors[begin : begin + AT_ONCE]]

    with ThreadPoolExecutor(cores) as pool:
        while not enough(factors, found):
            begins = range(len(found), len(found) + cores * AT_ONCE, AT_ONCE)
            for outcomes in pool.map(look, begins):
                found += outcomes
                tell(len(outcomes))
    if Outcome.OVERTURNED not in found:
        needs = simulate(block, motion.scaled(factors[-1]), start=start).friction_needed
        return Strength(lifts=lifts, margin=math.inf, friction=needs)
    first = found.index(Outcome.OVERTURNED)
    low, high = factors[first - 1] if first else lifts, factors[first]
    while high - low > WIDTH * high:
        middle = 0.5 * (low + high)
        falls = outcome(middle) is Outcome.OVERTURNED
        low, high = (low, middle) if falls else (middle, high)
    needs = simulate(block, motion.scaled(high), start=start).friction_needed
    again = islands(factors[first:], found[first:])
    return Strength(lifts=lifts, margin=high, friction=needs, islands=again)


def grid(onset: float, at_rest: bool) -> list[float]:
    """Return the factors that are tried: above the onset, or above 0 where a block leans."""
    count = round(math.log(MOST_ONSETS) / math.log1p(APART))
    above = [onset * (1.0 + APART) ** n for n in range(1, count + 1)]
    below = [] if at_rest else [onset * APART * n for n in range(round(1.0 / APART) + 1)]
    return below + above


def enough(factors: list[float], found: list[Outcome]) -> bool:
    """Tell whether a block overturns at one of the factors tried, and at those beyond was asked."""
    if len(found) == len(factors):
        return True
    if Outcome.OVERTURNED not in found:
        return False
    return factors[len(found) - 1] >= BEYOND * factors[found.index(Outcome.OVERTURNED)]


def islands(factors: list[float], found: list[Outcome]) -> tuple[tuple[float, float], ...]:
    """Return from which factor to which a block survives, each time that it does so."""
    pairs = zip(factors, found, strict=False)
    runs = [
        [factor for factor, _ in run]
        for falls, run in groupby(pairs, key=lambda pair: pair[1] is Outcome.OVERTURNED)
        if not falls
    ]
    return tuple((run[0], run[-1]) for run in runs)
