"""Leaving rest and coming to rest: uplift, and the sum of infinitely many impacts."""

import math

from analytic.kernels.compiled import kernel
from analytic.kernels.law import FloatArray, Law

ANGLE_TOLERANCE = 1e-14

ROUNDING = 1e-12
"""Part of the onset, and of the length of a straight segment, that counts as nothing."""


@kernel
def ground(segments: FloatArray, j: int, tau: float) -> float:
    """Return the ground acceleration [g] on segment j; zero after the last."""
    if j >= segments.shape[0]:
        return 0.0
    start, _, amplitude, omega, phase, offset, rate = segments[j]
    t = tau - start
    return amplitude * math.sin(omega * t + phase) + offset + rate * t


@kernel
def acceleration(law: Law, side: float, a: float, y: float) -> float:
    """Return y'' of a block at rotation y on the given side under the ground acceleration a."""
    if law.linear:
        return -law.k * law.k * (law.saddle - y + side * law.factor * a)
    return -(math.sin(law.alpha - y) + side * a * math.cos(law.alpha - y))


@kernel
def sine_uplift(segment: FloatArray, tau: float, onset: float) -> tuple[float, bool]:
    """Return when abs(amplitude sin) first exceeds the onset from tau on, and whether smoothly."""
    start, _, amplitude, omega, phase, _, _ = segment
    if abs(amplitude) <= onset:
        return math.inf, True
    angle = omega * (tau - start) + phase
    level = math.asin(onset / abs(amplitude))
    within = angle - math.pi * math.floor(angle / math.pi)
    if level + ANGLE_TOLERANCE < within < math.pi - level - ANGLE_TOLERANCE:
        return tau, False
    wait = level - within if within <= level + ANGLE_TOLERANCE else math.pi + level - within
    return tau + max(wait, 0.0) / omega, True


@kernel
def ramp_uplift(segment: FloatArray, tau: float, onset: float) -> tuple[float, bool]:
    """Return when abs(offset + slope t) first exceeds the onset from tau on, whether smoothly.

    What exceeds it by no more than ROUNDING, and falls, does not; nor what does so only in the
    last part ROUNDING of the segment: the next one, beginning there, tells.
    """
    start, end, _, _, _, offset, rate = segment
    now = offset + rate * (tau - start)
    if abs(now) > onset * (1.0 + ROUNDING):
        return tau, False
    if rate == 0.0:
        return math.inf, True
    time = tau + max(onset - math.copysign(1.0, rate) * now, 0.0) / abs(rate)
    return (time if time < end - ROUNDING * (end - start) else math.inf), True


@kernel
def next_uplift(
    segments: FloatArray, j: int, tau: float, onset: float
) -> tuple[int, float, float, int]:
    """Find the next uplift of a block at rest at `tau` on segment j or later.

    Returns
    -------
    segment : int
    time : float
        inf when the block stays at rest.
    side : float
        +1 or -1; 0 when the block stays at rest.
    lead : int
        Power of time with which the rotation grows: 3 where the ground passes through the onset,
        2 where it is beyond the onset at once.
    """
    for i in range(j, segments.shape[0]):
        begin = max(tau, segments[i, 0])
        if segments[i, 2] != 0.0:
            time, smooth = sine_uplift(segments[i], begin, onset)
        else:
            time, smooth = ramp_uplift(segments[i], begin, onset)
        if time < segments[i, 1]:
            side = -math.copysign(1.0, ground(segments, i, time))
            return i, time, side, 3 if smooth else 2
    return segments.shape[0], math.inf, 0.0, 0


@kernel
def time_to_rest(law: Law, side: float, v: float, a: float) -> float:
    """Return how long a block leaving the base at v goes on to rock; inf if it does not rest.

    The excursions last 2 v/r with the restoring accelerations r of the two sides in turn, and
    each impact multiplies the velocity by eta: a geometric series.
    """
    here = -acceleration(law, side, a, 0.0)
    there = -acceleration(law, -side, a, 0.0)
    if here <= 0.0 or there <= 0.0:
        return math.inf
    if v == 0.0:
        return 0.0
    if law.eta >= 1.0:
        return math.inf
    return 2.0 * v * (1.0 / here + law.eta / there) / (1.0 - law.eta * law.eta)


@kernel
def comes_to_rest(law: Law, side: float, now: float, later: float, wait: float) -> bool:
    """Tell whether a train of impacts may be summed.

    It must be shorter than ZENO, and the ground acceleration, `now` at its begin and `later` at
    its end, must change the restoring accelerations by less than a part ZENO in it.
    """
    if not wait < ZENO:
        return False
    here = acceleration(law, side, now, 0.0)
    there = acceleration(law, -side, now, 0.0)
    change = abs(acceleration(law, side, later, 0.0) - here)
    return change <= ZENO * min(abs(here), abs(there))


ZENO = 1e-4
"""Longest train of impacts that is summed [1/p]; the error of its length is a part ZENO of it."""
