"""How strong a motion must be: factors on it that lift a block, overturn it, or lift it off."""

import math
from typing import NamedTuple

import numpy as np

from analytic.block import RigidBlock
from analytic.conditioning import scaled
from analytic.motion import BothWays
from analytic.record import Record
from analytic.response import Outcome
from analytic.simulate import simulate
from analytic.slide import SlidingBlock
from studies.blocks.fragility import MOST_ONSETS

APART = 0.01
"""Relative distance of two factors."""
WIDTH = 1e-6
"""Relative width to which the margin is known."""


class Strength(NamedTuple):
    """Factors on a motion that lift and overturn: inf if none does, nan if it lifts off before."""

    lifts: float
    margin: float
    margin_friction: float


def bounds(block: RigidBlock | SlidingBlock, motion: Record | BothWays) -> tuple[float, float]:
    """Return the factors that lift a block, and off its base; the latter 0 where none is solved."""
    slope, solved = math.tan(block.alpha), isinstance(block, RigidBlock)
    if isinstance(motion, Record):
        return slope * block.gravity / motion.peak, math.inf
    pulls = np.abs(motion.acceleration(motion.breakpoints))
    pulls -= slope * motion.upward.acceleration(motion.breakpoints)
    falls = max(-motion.lowest, 1e-300)
    return slope * block.gravity / float(pulls.max()), solved * block.gravity / falls


def strength(block: RigidBlock, motion: Record | BothWays) -> Strength:
    """Find by which factors on a motion the exact block overturns; RuntimeError if one fails."""
    # under a long record overturning begins in slivers, some no wider than 1e-5 of the factor: one
    # between two points of the grid is not seen
    solve, (lifts, most) = scaled(block, motion), bounds(block, motion)

    def falls(factor: float) -> bool:
        outcome = Outcome.OVERTURNED if factor >= most else solve(factor, 1.0)[1]
        if outcome is Outcome.FAILED:
            raise RuntimeError(f"no margin: the solution at the factor {factor:g} failed")
        return outcome is Outcome.OVERTURNED

    count = round(math.log(MOST_ONSETS) / math.log1p(APART))
    factors = [lifts * (1.0 + APART) ** n for n in range(count + 1)]
    high = next(filter(falls, factors[1:]), math.inf)
    low = max(factor for factor in factors if factor < high)
    while high - low > WIDTH * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if falls(middle) else (middle, high)
    if most <= high < math.inf:
        return Strength(lifts, math.nan, math.nan)
    needed = simulate(block, motion.scaled(min(high, factors[-1]))).friction_needed
    return Strength(lifts, high, needed)
