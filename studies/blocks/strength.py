"""How strong a ground motion must be: the factors on it at which a block lifts and overturns.

Outcomes are looked up on a grid of factors, a hundredth apart, and the first that overturns is
followed down to the edge. Under a long record overturning begins in slivers, some no wider than
1e-5 of the factor: one that lies between two points of the grid is not seen.
"""

import math
from typing import NamedTuple

from analytic.block import RigidBlock
from analytic.conditioning import scaled
from analytic.record import Record
from analytic.response import Outcome
from analytic.simulate import simulate
from analytic.start import strongest

APART = 0.01
"""Relative distance of two factors."""
MOST_ONSETS = 100.0
"""Over the onset: the largest factor tried."""
WIDTH = 1e-6
"""Relative width to which the margin is known."""


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
    found = next((n for n, factor in enumerate(factors) if falls(factor)), None)
    high = math.inf if found is None else factors[found]
    if found is not None:
        low = factors[found - 1] if found else lifts
        while high - low > WIDTH * high:
            middle = 0.5 * (low + high)
            low, high = (low, middle) if falls(middle) else (middle, high)
    needed = simulate(block, motion.scaled(min(high, factors[-1]))).friction_needed
    return Strength(lifts, high, needed)
