"""Where a response starts: at rest, tilted, or turning, at the time zero of the ground motion."""

import math
from collections.abc import Sequence

from analytic.block import Rocker
from analytic.checks import sized
from analytic.kernels.law import Law, Start
from analytic.kernels.rest import strongest_between
from analytic.motion import FloatArray, Motion

LEAST_TILT = 1e-30
"""Tilt over alpha, below which the time to the first impact is lost in a step of the solution."""

REST = (0.0, 0.0)
"""Rotation [rad] and angular velocity [rad/s] of a block at rest on its base."""


def folded(
    block: Rocker,
    law: Law,
    motion: Motion,
    start: tuple[float, float],
    times: Sequence[float] | FloatArray = (),
) -> Start:
    """Return the start of a block, checked and folded to one side, in units of 1/p.

    Parameters
    ----------
    block : Rocker, of which p is used
    law : Law, of the model
    motion : Motion
    start : (float, float), theta [rad] and theta' [rad/s]
    times : sequence of float, optional, where the response is to be sampled [s]

    Raises
    ------
    ValueError
        If they are not two finite numbers, abs(theta) is pi/2 or more, where the side of the block
        lies on the ground, or the block would balance for ever: at rest at the saddle of the
        model, and no motion to disturb it; or if the first of the times is before a start off rest.
    """
    try:
        theta, rate = start
    except (TypeError, ValueError):
        raise ValueError(f"start is {start!r}; it must be theta [rad] and theta' [rad/s]") from None
    theta, rate = (
        sized("theta of the start", theta, LEAST_TILT * block.alpha),
        sized("rate of the start", rate),
    )
    if abs(theta) >= 0.5 * math.pi:
        raise ValueError(f"theta of the start is {theta!r}; it must be between -pi/2 and pi/2 rad")
    balanced = abs(theta) == law.saddle and rate == 0.0
    if balanced and strongest_between(motion.segments().tolist(), 0, 0.0, motion.duration) == 0.0:
        raise ValueError(
            f"start is {start!r}; it must not be the unstable equilibrium where nothing moves"
        )
    leaning = theta if theta != 0.0 else rate
    side = math.copysign(1.0, leaning) if leaning != 0.0 else 0.0
    if side != 0.0 and len(times) and times[0] < 0.0:
        raise ValueError(f"times begin at {times[0]}; they must not be before the start, at 0")
    return Start(side, abs(theta), side * rate / block.p)
