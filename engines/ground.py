"""The base's mean velocity over a step, cheap enough to be asked at every step.

A base that has its mean velocity during each step is where it should be at the end of each.
"""

import bisect
import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from analytic.motion import Motion

MeanVelocity = Callable[[float, float], float]

LEAST_SAMPLES = 256
"""Samples at least in which the base's acceleration is looked through."""

SMALL = 0.05
"""Below this angle [rad] a series keeps more digits of 1 - sin(x)/x than the formula does."""


def mean_velocity_of(motion: Motion) -> MeanVelocity:
    """Return the base's mean velocity [m/s] between two times [s], as a function of both.

    It is the integral of the analytic segments of the motion, from rest; after the last segment
    the base keeps its velocity.
    """
    rows = [tuple(map(float, row)) for row in motion.segments()]
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


class Load(NamedTuple):
    """A time [s] during which the base accelerates enough to lift a resting block, and whither."""

    begin: float
    end: float
    side: float


def loads_of(motion: Motion, onset: float, dt_s: float) -> list[Load]:
    """Return the times during which abs(u_g'') exceeds `onset` [m/s2], seen every dt_s/4 [s]."""
    samples = max(4 * math.ceil(motion.duration / dt_s), LEAST_SAMPLES) + 1
    grid = np.union1d(np.linspace(0.0, motion.duration, samples), motion.breakpoints)
    acceleration = motion.acceleration(grid)
    loads = []
    for side in (-1.0, 1.0):
        excess = -side * acceleration - onset
        changes = np.nonzero((excess[1:] > 0.0) != (excess[:-1] > 0.0))[0]
        corners = [_crossing(motion, -side, onset, *map(float, grid[i : i + 2])) for i in changes]
        if excess[0] > 0.0:
            corners.insert(0, 0.0)
        if len(corners) % 2:
            corners.append(motion.duration)
        loads += [Load(*pair, side) for pair in zip(corners[::2], corners[1::2], strict=True)]
    return sorted(loads)


def _crossing(motion: Motion, sign: float, onset: float, low: float, high: float) -> float:
    """Bisect for the time [s] at which sign u_g'' passes `onset` between two times."""

    def above(time: float) -> bool:
        return sign * float(motion.acceleration(time)) > onset

    first = above(low)
    while low < (middle := 0.5 * (low + high)) < high:
        low, high = (middle, high) if above(middle) is first else (low, middle)
    return float(high)
