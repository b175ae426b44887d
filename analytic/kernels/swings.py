"""One swing of a block under a pulse, from an impact or an uplift to its end, for maps.

A map needs no peak and no history, so a swing is followed by as few evaluations as will do. Symbols
and units are those of `analytic.kernels.law`.

Half cycles of the pulse are counted as whole numbers, from the one in which the swing begins, and
an angle in [0, pi] tells the place in the present one: so no digit is lost and no half cycle
miscounted, however long the pulse. The first half cycle of a swing counts as positive; where it is
negative, the swing is the mirror image of one on the other side.

No impact is stepped over: from (y, v) the block cannot land before y + v h - M h^2/2 = 0 where M
bounds -y'', and the steps that this allows converge to the impact quadratically; the linear models
know more about theirs. In the same way no step passes beyond the rotation at which the block lies.
"""

import math
from typing import NamedTuple

from analytic.kernels.closed_form import linear_state
from analytic.kernels.compiled import inner, spend
from analytic.kernels.excursions import LYING, MAX_STEPS
from analytic.kernels.law import FloatArray, Law, State
from analytic.kernels.polynomial import slope, value
from analytic.kernels.taylor import expand_exact, part

LANDED, TOPPLED, LEFT_OVER, STUCK = 0, 1, 2, 3
"""How a swing ends: an impact, overturned, still up when the pulse ends, too many steps."""

MAP_ORDER = 16
"""Degree of the Taylor series; a power of two, so that its root is a chain of square roots."""
MAP_TOLERANCE = 1e-13
"""Truncation error of a step, relative to the rotation that it covers."""
LONGEST = 4.0
CONTACT = 1e-13
"""Part of the height of a swing below which a falling block has landed."""
ROUNDING = 1e-15
"""Of the terms of the closed form."""
SHORT = 0.3
"""Swings shorter than this part of the shortest time scale need `linear_state`."""


class Swing(NamedTuple):
    """How a swing ended: its kind, half cycles and angle, rotation, velocity; its steps.

    Steps are evaluations of the closed form, or of the Taylor series.
    """

    end: int
    half_cycles: int
    angle: float
    y: float
    v: float
    steps: int


class Pulse(NamedTuple):
    """What is left of a pulse: amplitude [g] > 0, omega/p, half cycles with the present one."""

    amplitude: float
    omega: float
    half_cycles: int


@inner
def parity(half_cycles: int) -> float:
    """Return the sign of the ground acceleration so many half cycles after a positive one."""
    return 1.0 - 2.0 * (half_cycles % 2)


@inner
def whole_half_cycles(angle: float) -> tuple[int, float]:
    """Return the half cycles in an angle and what is left of it, in [0, pi)."""
    if angle < math.pi:
        return 0, angle
    rest = angle % math.pi
    return round((angle - rest) / math.pi), rest


@inner
def strongest_ahead(angle: float) -> float:
    """Return the largest sin from an angle to the end of its half cycle."""
    return 1.0 if angle < 0.5 * math.pi else math.sin(angle)


@inner
def safe_fall(y: float, v: float, most: float) -> float:
    """Return the time before which a block at (y, v) cannot land while -y'' is below `most`."""
    return (v + math.sqrt(v * v + 2.0 * most * y)) / most


@inner
def safe_rise(y: float, v: float, most: float) -> float:
    """Return the time before which a block at (y, v) cannot lie while y'' is below `most`."""
    room = LYING - y
    return 2.0 * room / (v + math.sqrt(v * v + 2.0 * most * room))


class Arc(NamedTuple):
    """A swing of a linear model from (0, v) at an angle, y = c + w sin + P e^(k t) + Q e^(-k t)."""

    start: float
    side: float
    v: float
    lead: int
    wave: float
    rising: float
    falling: float


@inner
def begin_arc(law: Law, pulse: Pulse, start: float, v: float, side: float) -> Arc:
    """Return the closed form of a swing (paper, equations 6 to 10 and 17 to 21, corrected)."""
    k, omega = law.k, pulse.omega
    wave = side * law.factor * pulse.amplitude * k * k / (k * k + omega * omega)
    total = -law.saddle - wave * math.sin(start)
    gap = (v - wave * omega * math.cos(start)) / k
    pushed = law.factor * pulse.amplitude * abs(math.sin(start))
    lead = 3 if v == 0.0 and pushed <= law.saddle * (1.0 + CONTACT) else 1
    return Arc(start, side, v, lead, wave, 0.5 * (total + gap), 0.5 * (total - gap))


@inner
def arc_at(
    law: Law,
    pulse: Pulse,
    segment: FloatArray,
    arc: Arc,
    t: float,
    half_cycles: int,
    angle: float,
) -> tuple[float, float, float]:
    """Return rotation [rad], velocity [rad p] and rounding error [rad] in a swing.

    Where the terms of the closed form would cancel, in short swings, by `linear_state`.

    Parameters
    ----------
    law, pulse, segment
        As for `swing_linear`.
    arc : Arc
    t : float, time since the begin of the swing [1/p]
    half_cycles, angle : int, float, the same time as half cycles since, and the angle [rad] in the
        last one
    """
    k, omega = law.k, pulse.omega
    if t * max(k, omega) < SHORT:
        begin = State(arc.side, arc.start / omega, arc.lead, 0.0, arc.v)
        y, v = linear_state(law, segment, begin, t)
        return y, v, 0.0
    grown = math.exp(k * t)
    rising, falling = arc.rising * grown, arc.falling / grown
    wave = parity(half_cycles) * arc.wave
    y = law.saddle + wave * math.sin(angle) + rising + falling
    v = wave * omega * math.cos(angle) + k * (rising - falling)
    return y, v, ROUNDING * (law.saddle + abs(rising))


@inner
def stretch(out: bool, angle: float, level: float) -> tuple[bool, float]:
    """Tell whether the ground lifts from an angle on, and until which angle.

    It lifts where it pushes `out` and is beyond the onset, `level` from the ends of a half cycle.
    """
    if out and angle < level:
        return False, level
    if out and angle < math.pi - level:
        return True, math.pi - level
    return False, math.pi


@inner
def swing_linear(
    law: Law, pulse: Pulse, start: float, v: float, side: float, level: float, segment: FloatArray
) -> Swing:
    """Follow a swing of a linear model from its base, by the closed form.

    Where the ground lifts, y is convex: tangents never pass the impact, and a block that moves up
    goes on to. Where it does not lift, a block that would be below the ground accelerates
    downwards and does not return: a positive end is proof that there was no impact, and from a
    negative one tangents lead back to it without passing it.

    Parameters
    ----------
    law : Law
    pulse : Pulse, what is left of it
    start : float, angle in the present half cycle [rad], in [0, pi]
    v : float, rate at y = 0 [rad p]
    side : float, -1 where the present half cycle, which counts as positive, pushes outward, else 1
    level : float, angle at which a half cycle reaches the onset [rad]
    segment : ndarray (7,), the sine of the pulse from time 0 on, for `linear_state`
    """
    c, omega = law.saddle, pulse.omega
    arc = begin_arc(law, pulse, start, v, side)
    push, square = law.factor * pulse.amplitude, law.k * law.k
    t, angle, y, top, noise = 0.0, start, 0.0, 0.0, 0.0
    n = steps = 0
    out = side < 0.0
    while steps < MAX_STEPS:
        spend()
        lifts, stop = stretch(out, angle, level)
        onward = out and c <= LYING and n == pulse.half_cycles - 1
        if onward and y >= c and v >= 0.0:
            return Swing(TOPPLED, n, angle, y, v, steps)
        if lifts:
            h = math.inf if v >= 0.0 else max(y, 0.0) / -v
        else:
            # as if the acceleration stayed: any guess will do
            fall = square * (c - y - push * math.sin(angle) * (1.0 if out else -1.0))
            h = safe_fall(max(y, 0.0), v, fall) if fall > 0.0 else math.inf
        if not (onward or (lifts and v >= 0.0)):
            force = push * strongest_ahead(angle) if out else 0.0
            h = min(h, safe_rise(y, v, square * max(LYING - c + force, 0.0)))
        t += max(h, CONTACT * t)
        angle = max(start + omega * t - n * math.pi, angle)
        if angle >= stop:
            t, angle = (n * math.pi + stop - start) / omega, stop
        steps += 1
        y, v, noise = arc_at(law, pulse, segment, arc, t, n, angle)
        top = max(top, y)
        if LYING - y <= CONTACT:
            return Swing(TOPPLED, n, angle, y, v, steps)
        contact = max(CONTACT * top, noise)
        while y < -contact and v < 0.0 and not lifts and steps < MAX_STEPS:
            steps += 1
            t -= y / v
            angle = start + omega * t - n * math.pi
            y, v, noise = arc_at(law, pulse, segment, arc, t, n, angle)
            contact = max(CONTACT * max(abs(v) * t, top), noise)
        if y <= contact and v <= 0.0:
            return Swing(LANDED, n, angle, 0.0, v, steps)
        if angle >= math.pi:
            n, angle, out = n + 1, 0.0, not out
            if n == pulse.half_cycles:
                return Swing(LEFT_OVER, n, angle, y, v, steps)
    return Swing(STUCK, n, angle, y, v, steps)


@inner
def sixteenth_root(x: float) -> float:
    """Return x^(1/16)."""
    return math.sqrt(math.sqrt(math.sqrt(math.sqrt(x))))


@inner
def map_step(y: FloatArray) -> float:
    """Return the step over which a series of degree MAP_ORDER is accurate.

    As `taylor.trusted_step`, but a root of one degree serves both last terms.
    """
    most = max(abs(y[MAP_ORDER]), abs(y[MAP_ORDER - 1]))
    if most == 0.0:
        return LONGEST
    h = 1.0
    for _ in range(2):
        size = max(max(abs(y[0]), abs(y[1]) * h), max(abs(y[2]), abs(y[3]) * h) * h * h)
        h = min(LONGEST, sixteenth_root(MAP_TOLERANCE * size / most))
    return h


@inner
def expand_pulse(pulse: Pulse, angle: float, side: float, f: FloatArray) -> None:
    """Write the Taylor coefficients of side x ground acceleration into f[0..MAP_ORDER]."""
    f[0] = side * pulse.amplitude * math.sin(angle)
    f[1] = side * pulse.amplitude * pulse.omega * math.cos(angle)
    square = pulse.omega * pulse.omega
    for i in range(2, MAP_ORDER + 1):
        f[i] = -square * part(i) * part(i - 1) * f[i - 2]


@inner
def lands(y: FloatArray, x: float, end: float, most: float, top: float) -> tuple[float, bool]:
    """Return where on [x, end] the series first reaches zero, and whether it does.

    Parameters
    ----------
    y : ndarray (MAP_ORDER + 1,), series of the rotation
    x, end : float, times since its begin [1/p]
    most : float, a bound of -y'' there [rad p^2]
    top : float, how high the swing has been [rad]
    """
    for _ in range(1000):
        now, rate = value(y, MAP_ORDER, x), slope(y, MAP_ORDER, x)
        top = max(top, now)
        if now <= CONTACT * top and rate <= 0.0 and x > 0.0:
            return x, True
        if x >= end:
            return end, False
        x = min(x + max(safe_fall(max(now, 0.0), rate, most), CONTACT * x), end)
    return x, True


@inner
def reaches(y: FloatArray, end: float, most: float) -> bool:
    """Tell whether the series reaches the rotation at which the block lies, on [0, end]."""
    x = 0.0
    for _ in range(200):
        now = value(y, MAP_ORDER, x)
        if LYING - now <= CONTACT:
            return True
        if x >= end:
            return False
        x = min(x + safe_rise(now, slope(y, MAP_ORDER, x), most), end)
    return True


@inner
def highest_bound(y: FloatArray, h: float) -> float:
    """Return an upper bound of the series on [0, h]."""
    total = 0.0
    for i in range(MAP_ORDER, 0, -1):
        total = (total + max(y[i], 0.0)) * h
    return total + y[0]


@inner
def lowest_bound(y: FloatArray, h: float) -> float:
    """Return a lower bound of the series on [0, h]."""
    total = 0.0
    for i in range(MAP_ORDER, 0, -1):
        total = (total + min(y[i], 0.0)) * h
    return total + y[0]


@inner
def swing_exact(
    law: Law, pulse: Pulse, start: float, v: float, side: float, lifted: float, work: FloatArray
) -> Swing:
    """Follow a swing of the exact model from its base by Taylor steps of degree MAP_ORDER.

    Parameters
    ----------
    law, pulse, start, v, side
        As for `swing_linear`.
    lifted : float, time since the begin of the swing [1/p] until which the ground lifts the block
    work : ndarray (5, MAP_ORDER + 1), spare
    """
    series, f = work[0], work[1]
    alpha, omega = law.alpha, pulse.omega
    low, high = math.sin(alpha), math.cos(alpha)
    t, angle, y, top = 0.0, start, 0.0, 0.0
    n = steps = 0
    while steps < MAX_STEPS:
        spend()
        steps += 1
        out, last = side < 0.0, n >= pulse.half_cycles - 1
        expand_pulse(pulse, angle, side, f)
        series[0], series[1] = y, v
        # where the ground passes through the onset the second derivative starts from zero
        smooth = y == 0.0 and v == 0.0 and abs(low + f[0] * high) <= CONTACT * low
        series[2] = 0.0 if smooth else -0.5 * (math.sin(alpha - y) + f[0] * math.cos(alpha - y))
        expand_exact(law, MAP_ORDER, work)
        ahead = max(((pulse.half_cycles - n) * math.pi - angle) / omega, 0.0)
        h = map_step(series)
        ended = h >= ahead
        h = min(h, ahead)
        straddles = not last and angle + omega * h > math.pi
        force = pulse.amplitude if straddles else pulse.amplitude * strongest_ahead(angle)
        clear = min(max(lifted - t, 0.0), h)
        landed = False
        if clear < h and lowest_bound(series, h) <= 0.0:
            most = low + (0.0 if out and not straddles else force)
            h, landed = lands(series, clear, h, most, top)
        if not (out and last) and highest_bound(series, h) >= LYING:
            most = high + (force if out or straddles else 0.0)
            if reaches(series, h, most):
                return Swing(TOPPLED, n, angle, y, v, steps)
        y, v = value(series, MAP_ORDER, h), slope(series, MAP_ORDER, h)
        top = max(top, y)
        turned, angle = whole_half_cycles(angle + omega * h)
        t, n, side = t + h, n + turned, side * parity(turned)
        if landed:
            return Swing(LANDED, n, angle, 0.0, v, steps)
        if ended or n >= pulse.half_cycles:
            return Swing(LEFT_OVER, n, angle, y, v, steps)
        if side < 0.0 and n == pulse.half_cycles - 1 and y >= alpha and v >= 0.0:
            return Swing(TOPPLED, n, angle, y, v, steps)
    return Swing(STUCK, n, angle, y, v, steps)
