"""How strong a ground motion must be: the factors on it at which a block lifts and overturns.

Outcomes are looked up on a grid of factors, a hundredth apart, and the first that overturns is
followed down to the edge. Under a long record overturning begins in slivers, some no wider than
1e-5 of the factor: one that lies between two points of the grid is not seen.
"""

import math
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

from analytic.block import RigidBlock
from analytic.conditioning import scaled
from analytic.record import Record
from analytic.response import Outcome
from analytic.simulate import simulate
from analytic.start import strongest
from studies.kit.store import usable_cores

APART = 0.01
"""Relative distance of two factors."""
MOST_ONSETS = 100.0
"""Over the onset: the largest factor tried."""
WIDTH = 1e-6
"""Relative width to which the margin is known."""
AT_ONCE = 32
"""Factors that are tried side by side."""


class Strength(NamedTuple):
    """Factors on a motion that lift and overturn, the latter inf if none up to MOST_ONSETS does.

    The friction is what the exact solution needs at the factor that overturns.
    """

    lifts: float
    margin: float
    margin_friction: float


def strength(block: RigidBlock, motion: Record) -> Strength:
    """Find by which factors on a motion the exact block overturns; RuntimeError if one fails."""
    solve = scaled(block, motion)

    def falls(factor: float) -> bool:
        outcome = solve(factor, 1.0)[1]
        if outcome is Outcome.FAILED:
            raise RuntimeError(f"no margin: the solution at the factor {factor:g} failed")
        return outcome is Outcome.OVERTURNED

    lifts = math.tan(block.alpha) * block.gravity / strongest(motion)
    count = round(math.log(MOST_ONSETS) / math.log1p(APART))
    factors = [lifts * (1.0 + APART) ** n for n in range(1, count + 1)]
    found, high = list[bool](), math.inf
    with ThreadPoolExecutor(usable_cores()) as pool:
        while not any(found) and len(found) < len(factors):
            found += pool.map(falls, factors[len(found) : len(found) + AT_ONCE])
    if True in found:
        first = found.index(True)
        low, high = factors[first - 1] if first else lifts, factors[first]
        while high - low > WIDTH * high:
            middle = 0.5 * (low + high)
            low, high = (low, middle) if falls(middle) else (middle, high)
    strongest_tried = motion.scaled(high if any(found) else factors[-1])
    needed = simulate(block, strongest_tried).friction_needed
    return Strength(lifts, high, needed)
