"""Steady states: from the end of a long response, the orbit on which it has settled."""

import math
from dataclasses import dataclass

import numpy as np

from analytic.block import RigidBlock
from analytic.motion import FloatArray, SinePulse
from analytic.response import Response

LAST_PERIODS = 48
"""Forcing periods at the end of a response that are looked at."""
SAMPLES = 256
"""Times at which each forcing period is looked at."""
LONGEST = 16
"""Longest orbit, in forcing periods, that is told from chaos."""
SAME = 1e-6
"""Two states this close, in units of alpha and alpha p, are the same."""
SETTLING = 100.0
"""States less than so many times further apart may become the same: the response still settles."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Orbit:
    """A steady state.

    Attributes
    ----------
    right, left : float
        Largest rotations [rad] to either side, the larger first.
    period : int
        Forcing periods after which the response repeats; 0 if it does not, or not yet.
    impacts : int
        Impacts in that time; 0 if it does not repeat.
    """

    right: float
    left: float
    period: int
    impacts: int


def sample_times(motion: SinePulse) -> FloatArray:
    """Return the times [s] at which a response must be sampled for its orbit to be read."""
    period = 2.0 * np.pi / motion.omega
    back = np.arange(LAST_PERIODS * SAMPLES, -1, -1)
    return np.asarray(motion.duration - back * (period / SAMPLES), dtype=np.float64)


def orbit_of(block: RigidBlock, motion: SinePulse, response: Response) -> Orbit:
    """Return the orbit on which a response has settled.

    Parameters
    ----------
    block : RigidBlock
    motion : SinePulse
        A whole number of periods, at least `LAST_PERIODS`.
    response : Response
        Sampled at `sample_times`.

    Raises
    ------
    ValueError
        If the block did not survive, or there is no history.
    """
    history = response.history
    if history is None or history.time.size < LAST_PERIODS * SAMPLES:
        raise ValueError(response.message or response.outcome.sentence)
    theta, rate = history.theta / block.alpha, history.velocity / (block.alpha * block.p)
    period = _period(np.stack([theta[::SAMPLES], rate[::SAMPLES]]))
    seen = theta[-(period or LAST_PERIODS) * SAMPLES - 2 :]
    sides = sorted((_highest(seen), _highest(-seen)), reverse=True)
    begin = motion.duration - period * 2.0 * np.pi / motion.omega
    return Orbit(
        right=sides[0] * block.alpha,
        left=sides[1] * block.alpha,
        period=period,
        impacts=sum(begin < impact.time <= motion.duration for impact in response.impacts),
    )


def _period(states: FloatArray) -> int:
    """Return after how many states they repeat; 0 if they do not, or still settle."""
    closest = math.inf
    for period in range(1, LONGEST + 1):
        missed = float(np.abs(states[:, period:] - states[:, :-period]).max())
        if missed < SAME:
            return period if closest > SETTLING * SAME else 0
        closest = min(closest, missed)
    return 0


def _highest(theta: FloatArray) -> float:
    """Return the largest of the parabolas through samples and their neighbours; 0 if none is."""
    left, top, right = theta[:-2], theta[1:-1], theta[2:]
    peak = (top >= left) & (top > right) & (top > 0.0)
    left, top, right = left[peak], top[peak], right[peak]
    crests = top - (right - left) ** 2 / (8.0 * (left - 2.0 * top + right))
    return float(crests.max(initial=0.0))
