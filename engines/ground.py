"""The base's velocity as a plain function of time, cheap enough to be asked at every step."""

import bisect
import math
from collections.abc import Callable

from analytic.motion import Motion

Velocity = Callable[[float], float]


def velocity_of(motion: Motion) -> Velocity:
    """Return the base's velocity [m/s] as a function of one time [s].

    It is the integral of the analytic segments of the motion, from rest, and stays constant
    after the last one.
    """
    rows = [tuple(map(float, row)) for row in motion.segments()]
    starts = [row[0] for row in rows]
    speeds = [0.0]
    for row in rows:
        speeds.append(speeds[-1] + _gained(row, row[1]))
    end, last = rows[-1][1], speeds[-1]

    def velocity(t: float) -> float:
        if t <= starts[0]:
            return 0.0
        if t >= end:
            return last
        i = bisect.bisect_right(starts, t) - 1
        return speeds[i] + _gained(rows[i], t)

    return velocity


def _gained(row: tuple[float, ...], t: float) -> float:
    """Integrate the acceleration of one segment from its start to `t`."""
    start, _, amplitude, omega, phase, offset, slope = row
    since = t - start
    gained = since * (offset + 0.5 * slope * since)
    if amplitude != 0.0:
        half = 0.5 * omega * since
        # the integral of sin(omega t + phase); cos a - cos b loses its digits at small t
        gained += 2.0 * amplitude / omega * math.sin(half) * math.sin(half + phase)
    return gained
