"""Sweeps of a sustained harmonic motion: each point starts where the last one ended."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from analytic import simulate
from analytic.block import RigidBlock
from analytic.motion import SinePulse
from analytic.response import Outcome, Response
from studies.measures.orbits import LAST_PERIODS, orbit_of, sample_times

COSINE = 0.5 * math.pi
"""Phase [rad]: the motion a_p cos(omega t) lifts the block at once."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Shaking:
    """A block under a_p cos(omega t).

    Attributes
    ----------
    block : RigidBlock
    onsets : float
        a_p over g tan alpha.
    omega_over_p : float
    """

    block: RigidBlock
    onsets: float
    omega_over_p: float

    def motion(self, periods: int) -> SinePulse:
        """Return the ground motion during a number of periods."""
        return SinePulse(
            amplitude=self.onsets * self.block.gravity * math.tan(self.block.alpha),
            omega=self.omega_over_p * self.block.p,
            half_cycles=2 * periods,
            phase=COSINE,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class State:
    """Where a response stands: theta [rad] and its rate [rad/s], and what it settled on."""

    outcome: str
    right: float
    left: float
    period: int
    impacts: int
    start: tuple[float, float]


def settle(shaking: Shaking, start: tuple[float, float], periods: int) -> State:
    """Return the state after a number of periods, from a start.

    A block that overturned has no state to go on from; its rotations are infinite.
    """
    motion = shaking.motion(periods)
    response = solve(shaking, motion, start)
    if response.outcome is Outcome.OVERTURNED or response.history is None:
        return State(
            outcome=response.outcome.value,
            right=math.inf,
            left=math.inf,
            period=0,
            impacts=0,
            start=(0.0, 0.0),
        )
    orbit = orbit_of(shaking.block, motion, response)
    end = (float(response.history.theta[-1]), float(response.history.velocity[-1]))
    return State(
        outcome=response.outcome.value,
        right=orbit.right,
        left=orbit.left,
        period=orbit.period,
        impacts=orbit.impacts,
        start=end,
    )


def solve(shaking: Shaking, motion: SinePulse, start: tuple[float, float]) -> Response:
    """Return the exact response, sampled where its orbit is read."""
    return simulate(
        shaking.block,
        motion,
        start=start,
        duration=motion.duration,
        times=sample_times(motion),
    )


def sweep(
    points: Sequence[Shaking], start: tuple[float, float], periods: int
) -> Iterator[tuple[Shaking, State]]:
    """Yield the settled states of points in their order, each from the state of the one before.

    Where a block overturned the next point begins at `start` again.
    """
    at = start
    for shaking in points:
        state = settle(shaking, at, max(periods, 2 * LAST_PERIODS))
        yield shaking, state
        at = state.start if state.outcome == Outcome.ROCKED.value else start
