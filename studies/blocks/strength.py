"""How strong a ground motion must be: the factors on it at which a block lifts and overturns.

Outcomes are looked up on a grid of factors, a hundredth apart, and the first that overturns is
followed down to the edge. Under a long record overturning begins in slivers, some no wider than
1e-5 of the factor: one that lies between two points of the grid is not seen, and what survives
further up does so at points of the grid.
"""

import math
from concurrent.futures import ThreadPoolExecutor
from itertools import groupby
from typing import NamedTuple

from analytic.block import RigidBlock
from analytic.conditioning import scaled
from analytic.record import Record
from analytic.response import Outcome
from analytic.simulate import simulate, strongest
from studies.kit.store import usable_cores

APART = 0.01
"""Relative distance of two factors; of a block that starts off rest, up to the onset, over it."""
MOST_ONSETS, BEYOND = 100.0, 1.25
"""Over the onset: the largest factor tried. Over the margin: how far survival is looked for."""
WIDTH = 1e-6
"""Relative width to which the margin is known."""
AT_ONCE = 32
"""Factors that are tried side by side."""


class Strength(NamedTuple):
    """Factors on a motion: those that lift and overturn, and where the block survives again.

    The margin is inf where none up to MOST_ONSETS onsets overturns; the friction is what the exact
    solution needs there. Islands are in words: "1.02-1.04 1.2".
    """

    lifts: float
    margin: float
    margin_friction: float
    islands: str


def strength(block: RigidBlock, motion: Record, start: tuple[float, float]) -> Strength:
    """Find by which factors on a motion the exact block overturns; RuntimeError if one fails."""
    solve = scaled(block, motion, start=start)

    def falls(factor: float) -> bool:
        outcome = solve(factor, 1.0)[1]
        if outcome is Outcome.FAILED:
            raise RuntimeError(f"no margin: the solution at the factor {factor:g} failed")
        return outcome is Outcome.OVERTURNED

    def needed(factor: float) -> float:
        return simulate(block, motion.scaled(factor), start=start).friction_needed

    onset, at_rest = math.tan(block.alpha) * block.gravity / strongest(motion), start == (0.0, 0.0)
    lifts, found = onset if at_rest else 0.0, list[bool]()
    count = round(math.log(MOST_ONSETS) / math.log1p(APART))
    factors = [onset * (1.0 + APART) ** n for n in range(1, count + 1)]
    if not at_rest:
        factors = [onset * APART * n for n in range(round(1.0 / APART) + 1)] + factors
    with ThreadPoolExecutor(usable_cores()) as pool:
        while len(found) < len(factors):
            found += pool.map(falls, factors[len(found) : len(found) + AT_ONCE])
            if True in found and factors[len(found) - 1] >= BEYOND * factors[found.index(True)]:
                break
    if True not in found:
        return Strength(lifts, math.inf, needed(factors[-1]), "")
    first = found.index(True)
    low, high = factors[first - 1] if first else lifts, factors[first]
    while high - low > WIDTH * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if falls(middle) else (middle, high)
    tried = [*zip(factors, found, strict=False)][first:]
    near = (pair for pair in tried if pair[0] <= BEYOND * factors[first])
    runs = [[*run] for fell, run in groupby(near, key=lambda pair: pair[1]) if not fell]
    ends = (dict.fromkeys(f"{run[end][0]:.4g}" for end in (0, -1)) for run in runs)
    return Strength(lifts, high, needed(high), " ".join(map("-".join, ends)))
