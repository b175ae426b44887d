"""The base's mean velocity over a step, cheap enough to be asked at every step.

A base that has its mean velocity during each step is where it should be at the end of each. An
exported scene takes this file along as it stands: it needs Python alone.
"""

import math
from collections.abc import Callable, Iterable, Sequence

Segment = Sequence[float]
Ground = Sequence[Segment]

SMALL = 0.05
"""Below this angle [rad] a series keeps more digits of 1 - sin(x)/x than the formula does."""

START, END, AMPLITUDE, OMEGA, PHASE, OFFSET, SLOPE, SPEED = range(8)
"""What a row of the ground says of a segment; the last is the velocity [m/s] at its start."""


def mean_velocity_of(segments: Iterable[Iterable[float]]) -> Callable[[float, float], float]:
    """Return the base's mean velocity [m/s] between two times [s], as a function of both."""
    rows = rows_of(segments)
    return lambda begin, finish: mean_velocity_over(rows, begin, finish)


def rows_of(segments: Iterable[Iterable[float]]) -> list[Segment]:
    """Return the ground of a motion, a row for each segment and one for the time after.

    From start to end [s] the base's acceleration is, with an amplitude in m/s2 and omega in rad/s,
    amplitude sin(omega (t - start) + phase) + offset + slope (t - start).
    """
    rows: list[Segment] = []
    speed = 0.0
    for segment in segments:
        row = (*map(float, segment), speed)
        speed += gained(row, row[END], 0.0)
        rows.append(row)
    return [*rows, (rows[-1][END], math.inf, 0.0, 1.0, 0.0, 0.0, 0.0, speed)]


def mean_velocity_over(rows: Ground, begin: float, finish: float) -> float:
    """Return the base's mean velocity [m/s] between two times [s], by exact integration."""
    first = last = segment_at(rows, begin)
    while finish > rows[last][END]:
        last += 1
    mean = within(rows[last], begin if last == first else rows[last][START], finish)
    for number in range(last - 1, first - 1, -1):
        row = rows[number]
        corner, since = row[END], begin if number == first else row[START]
        if corner > since:
            mean = (corner - since) * within(row, since, corner) + (finish - corner) * mean
            mean /= finish - since
    return mean


def segment_at(rows: Ground, time: float) -> int:
    """Return the number of the last segment that begins no later than a time [s]; 0 before all."""
    low, high = 0, len(rows)
    while low < high:
        middle = (low + high) // 2
        if time < rows[middle][START]:
            high = middle
        else:
            low = middle + 1
    return max(low - 1, 0)


def within(row: Segment, begin: float, finish: float) -> float:
    """Return the mean velocity [m/s] between two times [s] of one segment."""
    return row[SPEED] + gained(row, 0.5 * (begin + finish), finish - begin)


def gained(row: Segment, middle: float, length: float) -> float:
    """Return the velocity [m/s] gained in a segment, in the mean over `length` about `middle`."""
    since = middle - row[START]
    velocity = row[OFFSET] * since + 0.5 * row[SLOPE] * (since * since + length * length / 12.0)
    if row[AMPLITUDE] != 0.0:
        omega, phase = row[OMEGA], row[PHASE]
        half = 0.5 * omega * since
        # cos a - cos b as a product keeps its digits at small times
        swept = 2.0 * math.sin(half) * math.sin(half + phase)
        swept += math.cos(omega * since + phase) * one_minus_sinc(0.5 * omega * length)
        velocity += row[AMPLITUDE] / omega * swept
    return velocity


def one_minus_sinc(x: float) -> float:
    """Return 1 - sin(x)/x."""
    if x < SMALL:
        square = x * x
        return square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0))
    return 1.0 - math.sin(x) / x
