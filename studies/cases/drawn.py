"""Random blocks and pulses, and which of them the reference is sure of."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import count

import numpy as np

from analytic import simulate
from analytic.block import GRAVITY, RigidBlock
from analytic.motion import SinePulse
from analytic.response import Response

LEAST_NORMAL = 0.2
"""Cases are kept where the reference's normal force stays above this part of the weight.

That of a block that overturns until it passes the critical rotation for good.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class RandomCase:
    """A block and a pulse drawn at random."""

    case: int
    aspect: float
    width_m: float
    half_cycles: int
    amplitude_g: float
    omega_over_p: float

    @property
    def block(self) -> RigidBlock:
        """The block."""
        return RigidBlock(width=self.width_m, height=self.aspect * self.width_m)

    @property
    def motion(self) -> SinePulse:
        """The pulse."""
        return SinePulse(
            amplitude=self.amplitude_g * GRAVITY,
            omega=self.omega_over_p * self.block.p,
            half_cycles=self.half_cycles,
        )


def draw(seed: int) -> Iterator[RandomCase]:
    """Yield random cases without end, the same ones for the same seed.

    H/B from 1.2 to 12, B from 0.02 to 10 m, 1 to 4 half cycles, amplitudes from 1.02 to 4 onsets
    and omega/p from 0.3 to 12, width and frequency with uniform logarithms; only where the
    reference's normal force stays above LEAST_NORMAL weights.
    """
    kept = (drawn for drawn, exact in everything(seed) if exact.min_normal > LEAST_NORMAL)
    for case, drawn in enumerate(kept):
        yield replace(drawn, case=case)


def everything(seed: int) -> Iterator[tuple[RandomCase, Response]]:
    """Yield all that is drawn, numbered from 0, with its exact response."""
    generator = np.random.default_rng(seed)
    for number in count():
        aspect = float(generator.uniform(1.2, 12.0))
        drawn = RandomCase(
            case=number,
            aspect=aspect,
            width_m=math.exp(generator.uniform(math.log(0.02), math.log(10.0))),
            half_cycles=int(generator.integers(1, 5)),
            amplitude_g=float(generator.uniform(1.02, 4.0)) / aspect,
            omega_over_p=math.exp(generator.uniform(math.log(0.3), math.log(12.0))),
        )
        yield drawn, simulate(drawn.block, drawn.motion)
