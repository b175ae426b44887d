"""The base's mean velocity over a step, cheap enough to be asked at every step.

A base that has its mean velocity during each step is where it should be at the end of each. An
exported scene takes this file along as it stands: it needs Python alone.
"""

import bisect
import math
from collections.abc import Callable, Iterable

MeanVelocity = Callable[[float, float], float]

SMALL = 0.05
"""Below this angle [rad] a series keeps more digits of 1 - sin(x)/x than the formula does."""


def mean_velocity_of(segments: Iterable[Iterable[float]]) -> MeanVelocity:
    """Return the base's mean velocity [m/s] between two times [s], as a function of both.

    Parameters
    ----------
    segments : iterable of seven numbers each
        start, end [s], amplitude [m/s2], omega [rad/s], phase [rad], offset [m/s2], slope [m/s3]:
        from start to end the base's acceleration is
        amplitude sin(omega (t - start) + phase) + offset + slope (t - start). The base is at rest
        before the first, and keeps its velocity after the last.
    """
    rows = [tuple(map(float, row)) for row in segments]
    end = rows[-1][1]
    rows.append((end, math.inf, 0.0, 1.0, 0.0, 0.0, 0.0))
    starts = [row[0] for row in rows]
    speeds = [0.0]
    for row in rows[:-1]:
        speeds.append(speeds[-1] + _gained(row, row[1], 0.0))

    def mean_velocity(begin: float, finish: float) -> float:
        i = max(bisect.bisect_right(starts, begin) - 1, 0)
        if finish <= rows[i][1]:
            return speeds[i] + _gained(rows[i], 0.5 * (begin + finish), finish - begin)
        corner = rows[i][1]
        before = (corner - begin) * mean_velocity(begin, corner) if corner > begin else 0.0
        after = (finish - corner) * mean_velocity(corner, finish)
        return (before + after) / (finish - begin)

    return mean_velocity


def _gained(row: tuple[float, ...], middle: float, length: float) -> float:
    """Velocity [m/s] gained in a segment, in the mean over `length` [s] about `middle` [s]."""
    start, _, amplitude, omega, phase, offset, slope = row
    since = middle - start
    gained = offset * since + 0.5 * slope * (since * since + length * length / 12.0)
    if amplitude != 0.0:
        half = 0.5 * omega * since
        # cos a - cos b as a product keeps its digits at small times
        swept = 2.0 * math.sin(half) * math.sin(half + phase)
        swept += math.cos(omega * since + phase) * _one_minus_sinc(0.5 * omega * length)
        gained += amplitude / omega * swept
    return gained


def _one_minus_sinc(x: float) -> float:
    if x < SMALL:
        square = x * x
        return square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0))
    return 1.0 - math.sin(x) / x
