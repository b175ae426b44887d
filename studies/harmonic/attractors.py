"""Attractors of a sustained harmonic motion: from a grid of starts, and followed to either side."""

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from analytic import simulate
from analytic.block import RigidBlock
from analytic.motion import SinePulse
from analytic.response import Outcome
from studies.measures.orbits import LAST_PERIODS, orbit_of, sample_times

COSINE = 0.5 * math.pi
"""Phase [rad]: the motion a_p cos(omega t) lifts the block at once."""

WIDEST = 0.9
"""Largest rotation and rate of the grid of starts, in units of alpha and alpha p."""

PATIENCE = 4
"""Times that a response which does not repeat yet goes on, each time for twice as long."""

APART = 1e-3
"""Orbits of one period whose rotations are further apart than this, relative, are two."""


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

    def starts(self, count: int) -> Iterator[tuple[float, float]]:
        """Yield the grid of starts: so many rotations [rad] by as many rates [rad/s]."""
        alpha, p = self.block.alpha, self.block.p
        steps = WIDEST * (2.0 * np.arange(count) - count + 1) / max(count - 1, 1)
        for theta, rate in itertools.product(steps.tolist(), repeat=2):
            yield theta * alpha, rate * alpha * p


@dataclass(frozen=True, slots=True, kw_only=True)
class Attractor:
    """What responses settle on: an orbit, or overturning; and where the first of them stands.

    Attributes
    ----------
    outcome : str
        Value of an `Outcome`.
    right, left : float
        Largest rotations [rad] to either side, the larger first; inf of a block that overturned,
        nan of a response that failed.
    period, impacts : int
        Forcing periods after which the response repeats, and impacts in that time; 0 if it does
        not.
    end : (float, float)
        theta [rad] and rate [rad/s] at the end of the motion.
    starts : int
        How many of the grid's starts settle on it; 0 if it was found from a neighbour alone.
    """

    outcome: str
    right: float
    left: float
    period: int = 0
    impacts: int = 0
    end: tuple[float, float] = (0.0, 0.0)
    starts: int = 0

    def is_like(self, other: "Attractor") -> bool:
        """Say whether both are on one orbit, or on its mirror image half a period later.

        All that do not repeat count as one.
        """
        if (self.outcome, self.period) != (other.outcome, other.period):
            return False
        if not self.period:
            return True
        sizes = ((self.right, self.left), (other.right, other.left))
        return all(abs(a - b) <= APART * max(a, b) for a, b in zip(*sizes, strict=True))


def settle(shaking: Shaking, start: tuple[float, float], periods: int) -> Attractor:
    """Return what a response settles on, from a start.

    It is given a number of periods and, where its orbit does not repeat by then, more of them. A
    block that overturned has infinite rotations and no state to go on from.
    """
    for more in range(PATIENCE + 1):
        found = _shaken(shaking, start, max(periods * 2**more, 2 * LAST_PERIODS))
        if found.period or found.outcome != Outcome.ROCKED.value:
            break
        start = found.end
    return found


def _shaken(shaking: Shaking, start: tuple[float, float], periods: int) -> Attractor:
    motion = shaking.motion(periods)
    times = sample_times(motion)
    response = simulate(shaking.block, motion, start=start, duration=motion.duration, times=times)
    if response.outcome is Outcome.OVERTURNED or response.history is None:
        lost = math.inf if response.outcome is Outcome.OVERTURNED else math.nan
        return Attractor(outcome=response.outcome.value, right=lost, left=lost)
    orbit = orbit_of(shaking.block, motion, response)
    return Attractor(
        outcome=(Outcome.ROCKED if orbit.right else Outcome.AT_REST).value,
        right=orbit.right,
        left=orbit.left,
        period=orbit.period,
        impacts=orbit.impacts,
        end=(float(response.history.theta[-1]), float(response.history.velocity[-1])),
    )


def attractors(points: Sequence[Shaking], starts: int, periods: int) -> list[list[Attractor]]:
    """Return the attractors at each point, those first on which most of the grid's starts settle.

    The whole grid of starts is tried at every point; then each orbit is followed to the points
    before and after it, as far as it goes, which finds it where none of the grid's starts do.

    Parameters
    ----------
    points : sequence of Shaking
        In the order of what is swept.
    starts : int
        Rotations in the grid of starts, and rates at each; at least 1.
    periods : int
        Forcing periods from each start before its orbit is read, at least 1; twice `LAST_PERIODS`
        are taken in any case, and more where the orbit does not repeat by then.

    Returns
    -------
    list of list of Attractor
        One list for each point.
    """
    found: list[list[Attractor]] = []
    for shaking in points:
        here: list[Attractor] = []
        for start in shaking.starts(starts):
            _count(here, settle(shaking, start, periods), 1)
        found.append(here)
    for order in (range(len(points)), range(len(points))[::-1]):
        for before, after in itertools.pairwise(order):
            for known in list(found[before]):
                if known.outcome == Outcome.ROCKED.value:
                    beside = settle(points[after], known.end, periods)
                    if beside.outcome == Outcome.ROCKED.value:
                        _count(found[after], beside, 0)
    return [sorted(here, key=lambda one: -one.starts) for here in found]


def _count(found: list[Attractor], settled: Attractor, starts: int) -> None:
    """Add so many starts to the attractor that a response settled on, which may be a new one."""
    for place, known in enumerate(found):
        if known.is_like(settled):
            found[place] = replace(known, starts=known.starts + starts)
            return
    found.append(replace(settled, starts=starts))
