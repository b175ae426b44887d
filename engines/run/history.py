"""A response at chosen times, from the steps that were taken."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from analytic.response import History


def sample(rows: NDArray[np.float64], times: Sequence[float]) -> History:
    """Sample a response at those of some times that it reached.

    Over a step, the rotation is a parabola through both ends. Its curvature comes from the step
    before or the step after, whichever gives less, so that it does not reach across an impact. The
    rows (n, 4) are a `watch.Row` each: the start, and the ends of all steps.
    """
    time, rate_s, theta, rate = rows.T
    wanted = np.asarray(times, dtype=np.float64)
    wanted = wanted[wanted <= time[-1]]
    # rows[0] is the start, so that step i leads from row i - 1 to row i
    step = np.clip(np.searchsorted(time, wanted), 1, len(time) - 1)
    bend = _bends(rate_s[1:], rate[1:])[step - 1]
    since, left = wanted - time[step - 1], time[step] - wanted
    chord = (theta[step] - theta[step - 1]) / (time[step] - time[step - 1])
    return History(
        time=wanted,
        theta=theta[step - 1] + chord * since - 0.5 * bend * since * left,
        velocity=rate[step] + bend * (wanted - rate_s[step]),
    )


def _bends(rate_s: NDArray[np.float64], rate: NDArray[np.float64]) -> NDArray[np.float64]:
    """Angular acceleration [rad/s2] of each step, from its calmer neighbour."""
    if len(rate) == 1:
        return np.zeros(1)
    between = np.diff(rate) / np.diff(rate_s)
    before = np.concatenate((between[:1], between))
    after = np.concatenate((between, between[-1:]))
    return np.where(np.abs(before) < np.abs(after), before, after)
