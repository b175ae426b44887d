"""Leaving rest and coming to rest: uplift, and the sum of infinitely many impacts.

Symbols and units are those of `analytic.kernels.law`.
"""

import math

from analytic.kernels.law import FloatArray, Law, Laws, law_of

ANGLE_TOLERANCE = 1e-14

EQUAL = 1e-15
"""Part of the onset that the rounding of data makes: more of it lifts a block, if it lasts."""
MOMENT = 1e-12
"""Part of a time that counts as nothing: an excess over the onset that lasts no longer."""


def ground(segments: FloatArray, j: int, tau: float) -> float:
    """Return the ground acceleration [g] on a segment; zero after the last."""
    return shaking(segments[j], tau) if j < len(segments) else 0.0


def shaking(segment: FloatArray, tau: float) -> float:
    """Return the ground acceleration [g] on a segment."""
    start, _, amplitude, omega, phase, offset, rate = segment[:7]
    t = tau - start
    return amplitude * math.sin(omega * t + phase) + offset + rate * t


def changing(segment: FloatArray, tau: float) -> float:
    """Return the rate [g p] of the ground acceleration on a segment."""
    start, _, amplitude, omega, phase, _, rate = segment[:7]
    return amplitude * omega * math.cos(omega * (tau - start) + phase) + rate


def weight(segments: FloatArray, j: int, tau: float) -> float:
    """Return the weight over m g on a segment: 1 and the upward acceleration [g]."""
    if j < len(segments) and len(segments[j]) > 7:
        return 1.0 + shaking(segments[j][7:], tau)
    return 1.0


def segment_at(segments: FloatArray, j: int, tau: float) -> int:
    """Return on which segment a time is; their number after the last."""
    while j < len(segments) and tau >= segments[j][1]:
        j += 1
    return j


def strongest_between(segments: FloatArray, j: int, begin: float, end: float) -> float:
    """Return the largest abs(acceleration) between two times, from segment j on, in any units."""
    most = 0.0
    for i in range(j, len(segments)):
        first, last = max(begin, segments[i][0]), min(end, segments[i][1])
        if first > last:
            break
        most = max(most, abs(ground(segments, i, first)), abs(ground(segments, i, last)))
        start, _, amplitude, omega, phase, _, _ = segments[i][:7]
        # a crest lies between two times that an odd number of quarter cycles divides
        quarter = phase - 0.5 * math.pi
        before = math.floor((omega * (first - start) + quarter) / math.pi)
        if before < math.floor((omega * (last - start) + quarter) / math.pi):
            most = max(most, abs(amplitude))
    return most


def acceleration(law: Law, side: float, a: float, y: float, weight: float = 1.0) -> float:
    """Return y'' [rad p^2] by the equation of motion (EQUATIONS.md, "From (1) and (2)")."""
    if law.linear:
        return -law.k * law.k * (law.saddle - y + side * law.factor * a)
    z = law.alpha - y
    return -law.k * law.k * (weight * math.sin(z) + side * a * math.cos(z))


def sine_uplift(segment: FloatArray, tau: float, laws: Laws) -> tuple[float, bool]:
    """Return when abs(amplitude sin) exceeds an onset from tau on, and whether smoothly."""
    start, _, amplitude, omega, phase, _, _ = segment
    angle = omega * (tau - start) + phase
    begun = math.floor(angle / math.pi)
    within = angle - math.pi * begun
    for ahead in range(3):
        onset = law_of(laws, -amplitude if (begun + ahead) % 2 == 0 else amplitude).onset
        if abs(amplitude) <= onset:
            continue
        level = math.asin(onset / abs(amplitude))
        if ahead == 0 and level + ANGLE_TOLERANCE < within < math.pi - level - ANGLE_TOLERANCE:
            return tau, False
        if ahead > 0 or within <= level + ANGLE_TOLERANCE:
            return tau + max(ahead * math.pi + level - within, 0.0) / omega, True
    return math.inf, True


def ramp_uplift(segment: FloatArray, tau: float, laws: Laws) -> tuple[float, bool]:
    """Return when abs(offset + slope t) first exceeds the onset from tau on, whether smoothly.

    An excess of a part EQUAL of the onset, or for a part MOMENT of the segment, is rounding. Of two
    onsets, the ground counts from midway between them.
    """
    start, end, _, _, _, offset, rate = segment
    onset = 0.5 * (laws[1].onset + laws[0].onset)
    midway = 0.5 * (laws[1].onset - laws[0].onset)
    now, moment = offset + rate * (tau - start) - midway, MOMENT * (end - start)
    excess = abs(now) - onset
    falls = now * rate < 0.0
    if excess > EQUAL * onset and not (falls and excess <= moment * abs(rate)):
        return tau, False
    if rate == 0.0:
        return math.inf, True
    time = tau + max(onset - math.copysign(1.0, rate) * now, 0.0) / abs(rate)
    return (time if time < end - moment else math.inf), True


def safe_time(gap: float, away: float, most: float) -> float:
    """Return when a gap that opens at a rate closes, pulled by no more than `most`."""
    root = math.sqrt(max(away * away + 2.0 * most * gap, 0.0))
    if away >= 0.0:
        return (away + root) / most if most > 0.0 else math.inf
    return 2.0 * gap / (root - away)


def heavy_uplift(segment: FloatArray, tau: float, side: float, onset: float) -> tuple[float, bool]:
    """Return what `ramp_uplift` does where the onset grows with the weight, step by safe step."""
    start, end, amplitude, omega = segment[:4]
    most = abs(amplitude) * omega * omega + onset * abs(segment[9]) * segment[10] * segment[10]
    moment, t = MOMENT * (end - start), tau
    while t < end - moment:
        gap = onset * (1.0 + shaking(segment[7:], t)) + side * shaking(segment, t)
        away = onset * changing(segment[7:], t) + side * changing(segment, t)
        if gap < -EQUAL * onset and not -gap <= moment * away:
            return t, t > tau
        h = safe_time(max(gap, 0.0), away, most)
        if away < 0.0 and (gap <= EQUAL * onset or t + h == t):
            return t, True
        t += max(h, moment)
    return math.inf, True


def next_uplift(
    segments: FloatArray, j: int, tau: float, laws: Laws
) -> tuple[int, float, float, int]:
    """Find the next uplift: segment, time (inf if none), side, and lead, 3 if smooth, else 2."""
    for i in range(j, len(segments)):
        begin = max(tau, segments[i][0])
        if len(segments[i]) > 7:
            time, smooth = heavy_uplift(segments[i], begin, 1.0, laws[0].onset)
            other, gentle = heavy_uplift(segments[i], begin, -1.0, laws[1].onset)
            time, smooth = (time, smooth) if time < other else (other, gentle)
        elif segments[i][2] != 0.0:
            time, smooth = sine_uplift(segments[i], begin, laws)
        else:
            time, smooth = ramp_uplift(segments[i], begin, laws)
        if time < segments[i][1]:
            side = -math.copysign(1.0, ground(segments, i, time))
            return i, time, side, 3 if smooth else 2
    return len(segments), math.inf, 0.0, 0


def after_impact(
    laws: Laws, segments: FloatArray, j: int, tau: float, side: float, v: float
) -> tuple[float, float]:
    """Return the side of a block that leaves its base at v, 0 where it rests, and `time_to_rest`.

    A train of impacts is summed if it is shorter than ZENO, and the restoring accelerations change
    by less than a part ZENO in it.
    """
    this, other = law_of(laws, side), law_of(laws, -side)
    now, heavy = ground(segments, j, tau), weight(segments, j, tau)
    here = -acceleration(this, side, now, 0.0, heavy)
    there = -acceleration(other, -side, now, 0.0, heavy)
    wait = time_to_rest(here, there, this.eta, other.eta, v)
    end = tau + wait if wait < math.inf else tau
    later = acceleration(this, side, ground(segments, j, end), 0.0, weight(segments, j, end))
    if wait < ZENO and abs(later + here) <= ZENO * min(abs(here), abs(there)):
        return 0.0, wait
    # where no velocity is left the ground lifts the block again at once
    return side if v != 0.0 else -math.copysign(1.0, now), wait


def time_to_rest(here: float, there: float, eta: float, other: float, v: float) -> float:
    """Return how long [1/p] a block leaving the base rocks, by a geometric series; inf: no rest.

    Excursions last 2 v/r with the restoring accelerations r, here and there in turn.
    """
    if here <= 0.0 or there <= 0.0:
        return math.inf
    if v == 0.0:
        return 0.0
    if eta * other >= 1.0:
        return math.inf
    return 2.0 * v * (1.0 / here + eta / there) / (1.0 - eta * other)


ZENO = 1e-4
"""Longest train of impacts that is summed [1/p]; the error of its length is a part ZENO of it."""
