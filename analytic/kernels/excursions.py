"""One response of the reference, excursion by excursion.

The same march serves the exact model (Taylor series) and the linear ones (closed form, its events
bracketed by its series). Symbols and units are those of `analytic.kernels.law`.
"""

import math
from typing import NamedTuple, TypeAlias

import numpy as np

from analytic.kernels.closed_form import free_peaks, linear_state
from analytic.kernels.forces import forget_fall, watch_free, watch_rest, watch_step, watch_train
from analytic.kernels.forms import Kernel
from analytic.kernels.law import (
    IMPACT,
    RESTED,
    UPLIFT,
    FloatArray,
    Law,
    Laws,
    Notes,
    Start,
    State,
    law_of,
    note,
    sample_still,
)
from analytic.kernels.polynomial import (
    MAX_DEPTH,
    ORDER,
    bracketed_root,
    highest,
    next_root,
    slope,
    stretch,
    trend,
    value,
)
from analytic.kernels.rest import after_impact, ground, next_uplift, safe_time, segment_at, weight
from analytic.kernels.taylor import Accuracy, expand

AT_REST, ROCKED, OVERTURNED, TOO_LONG, BROKEN = 0, 1, 2, 3, 4
FREE, HIT, FALLEN, LOST = 0, 1, 2, 3
"""What a step ends with: none of these, an impact, the block on its side, an overflow."""
LYING = 0.5 * math.pi
"""Rotation at which the side of the block lies on the ground."""
MAX_STEPS = 2_000_000
VANISHING = 1e-15
"""A step shorter than this part of the time it starts from is lost in rounding."""
FAR = 1e3
"""A step out of an impact goes no further than this many times the excursion to be expected:
a root much closer to the step's begin than its end could be overlooked."""
NEAR = 1e-7
"""Part of the time gone at which an impact ahead is left to Newton's method."""
MOST_LEAPS = 10_000


Ended: TypeAlias = tuple[int, float, float, int, int, int, float, float, float]
"""The fields of an `End`, as compiled code returns them: to make a named tuple it would call
Python, where an interruption may end the call; compiled code does not see that, and crashes."""


class End(NamedTuple):
    """How a march ended: largest rotations, last state; `events` may exceed the room of the log."""

    outcome: int
    right: float
    left: float
    steps: int
    impacts: int
    events: int
    time: float
    y: float
    v: float


class Step(NamedTuple):
    """A step: what ended it, its length, the part x in (0, 1] gone, the state there, the peak."""

    kind: int
    h: float
    x: float
    tau: float
    y: float
    v: float
    peak: float


def first_crossing(d: FloatArray, order: int, lead: int, level: float, work: FloatArray) -> float:
    """Return where sum d[i] x^i first equals `level` in (0, 1], or 2; a lead is for level 0."""
    q = work[0]
    degree = order - lead
    q[0] = d[lead] - level
    low = q[0]
    for i in range(1, degree + 1):
        q[i] = d[i + lead]
        low += min(q[i], 0.0)
    return 2.0 if low > 0.0 else next_root(q, degree, 0.0, work[1:])


def polish(law: Law, segment: FloatArray, begin: State, h: float) -> float:
    """Return the time [1/p] after a state, about h, at which the closed form reaches zero."""
    x = h
    for _ in range(4):
        end, rate = linear_state(law, segment, begin, x)
        move = end / rate
        if not abs(move) < 1e-6 * h:
            break
        x -= move
        if abs(move) <= 2e-16 * x:
            break
    return x


def leap(law: Law, segment: FloatArray, begin: State, peak: float) -> Step:
    """Step as `take_step`, of a linear model under a sine, by the closed form; no peak is sought.

    It goes as far as bounds of y'' exclude an impact and a fall, and so converges to either.
    """
    start, end, amplitude, omega, phase, _, _ = segment
    left, square, push = end - begin.tau, law.k * law.k, law.factor * abs(amplitude)
    level = math.asin(min(law.saddle / push, 1.0))
    angle = omega * (begin.tau - start) + phase
    turns = math.floor(angle / math.pi)
    t, y, v = 0.0, begin.y, begin.v
    for _ in range(MOST_LEAPS):
        # turn is where the half cycle ends, in which the ground pushes inward or outward
        out = begin.side * amplitude * (1.0 - 2.0 * (turns % 2)) < 0.0
        turn = (turns + 1) * math.pi - angle
        inward, outward = (0.0, push) if out else (push, 0.0)
        clear = (turn - level) / omega - t
        if not (out and v >= 0.0 and clear >= 0.0 and omega * t >= turn + level - math.pi - NEAR):
            clear = safe_time(max(y, 0.0), v, square * (law.saddle + inward))
        most = max(square * (LYING - law.saddle + outward), VANISHING)
        stop = min(turn / omega, left)
        h = max(min(clear, safe_time(LYING - y, -v, most)), VANISHING * stop)
        turns += t + h >= stop
        t = min(t + h, stop)
        y, v = linear_state(law, segment, begin, t)
        if y >= LYING * (1.0 - VANISHING):
            return Step(FALLEN, t, 1.0, begin.tau + t, y, v, peak)
        if y <= 0.0 or (y < -NEAR * t * v and 2.0 * square * (LYING + push) * y < v * v):
            t = polish(law, segment, begin, t)
            _, v = linear_state(law, segment, begin, t)
            return Step(HIT, t, 1.0, begin.tau + t, 0.0, v, peak)
        if t >= left:
            return Step(FREE, t, 1.0, end, y, v, peak)
    return Step(LOST, t, 1.0, begin.tau, y, v, peak)


def take_step(
    law: Law, accuracy: Accuracy, segment: FloatArray, begin: State, peak: float, work: FloatArray
) -> Step:
    """Step to an impact, a fall or the end of a segment at most; `work` then holds its series."""
    series, d, spare = work[0], work[4], work[5:]
    order, lead, end = accuracy.order, begin.lead, segment[1]
    h = expand(law, accuracy, segment, begin, work)
    if not begin.tau * VANISHING < h < math.inf:
        return Step(LOST, h, 0.0, begin.tau, begin.y, begin.v, peak)
    if lead == 1 and series[2] < 0.0:
        h = min(h, -FAR * begin.v / series[2])
    whole = begin.tau + h >= end
    if whole:
        h = end - begin.tau
    stretch(series, order, h, d)

    way = trend(d, order, lead)
    if way > 0:
        x, peak = 2.0, max(peak, value(d, order, 1.0))
    elif way < 0 and lead == 0:
        x = bracketed_root(d, order, 0.0, 1.0, False) if value(d, order, 1.0) < 0.0 else 2.0
    else:
        x = first_crossing(d, order, lead, 0.0, spare)
        peak, _ = highest(d, order, lead, min(x, 1.0), peak, spare)
    kind = HIT if x <= 1.0 else FREE
    x = min(x, 1.0)
    fall = first_crossing(d, order, 0, LYING, spare) if peak >= LYING else 2.0
    if fall <= x:
        kind, x = FALLEN, fall
    elif kind == HIT and law.linear:
        x = min(polish(law, segment, begin, x * h) / h, 1.0)

    if law.linear:
        y, v = linear_state(law, segment, begin, x * h)
    else:
        y, v = value(d, order, x), slope(d, order, x) / h
    # a root within rounding of the step's end may escape the polynomial, not the state
    kind = HIT if kind == FREE and y <= 0.0 else kind
    if kind != FALLEN and not abs(y) + abs(v) < math.inf:
        kind = LOST
    tau = end if whole and x == 1.0 else begin.tau + x * h
    return Step(kind, h, x, tau, y, v, peak)


def sample_step(
    law: Law,
    segment: FloatArray,
    begin: State,
    d: FloatArray,
    order: int,
    step: Step,
    notes: Notes,
    n: int,
) -> int:
    """Sample a step; return the number of samples so far."""
    h = step.h
    while n < len(notes.times) and notes.times[n] <= begin.tau + step.x * h:
        at = notes.times[n] - begin.tau
        if law.linear:
            theta, rate = linear_state(law, segment, begin, at)
        else:
            theta, rate = value(d, order, at / h), slope(d, order, at / h) / h
        notes.samples[0, n], notes.samples[1, n] = begin.side * theta, begin.side * rate
        n += 1
    return n


def march(
    laws: Laws,
    accuracy: Accuracy,
    moving: FloatArray,
    start: Start,
    above: float,
    notes: Notes,
    work: FloatArray,
) -> Ended:
    """Follow one response to the end of the last segment, on which nothing moves; then by energy.

    The order of the accuracy is 0 where nobody asks for the peak of a linear model under a pulse.
    Peaks are looked for above a rotation [rad]; work is a `workspace`.
    """
    last, limits = moving[-1][1], notes.limits
    side, y, v = start
    tau, lead = 0.0, 1 if y == 0.0 else 0
    right = max(y, above) if side > 0.0 else above
    left = max(y, above) if side < 0.0 else above
    j = steps = impacts = events = n = 0
    while steps < MAX_STEPS:
        if side == 0.0:
            resting = j
            j, rise, side, lead = next_uplift(moving, j, tau, laws)
            n = sample_still(notes, min(rise, last), n, 0.0, 0.0)
            watch_rest(limits, moving, resting, tau, rise, work)
            if side == 0.0:
                outcome = AT_REST if events == 0 and start.side == 0.0 else ROCKED
                return outcome, right, left, steps, impacts, events, last, 0.0, 0.0
            tau = rise
            events = note(notes.log, events, UPLIFT, tau, 0.0, 0.0)
        j, law = segment_at(moving, j, tau), law_of(laws, side)
        if tau >= last:
            sample_still(notes, last, n, side * y, side * v)  # of a motion without length
            ahead = free_peaks(laws, side, y, v)
            watch_free(limits, law, y, v)
            right, left = max(right, ahead[0]), max(left, ahead[1])
            outcome = OVERTURNED if max(right, left) == math.inf else ROCKED
            return outcome, right, left, steps, impacts, events, last, y, v
        steps += 1
        segment, begin = moving[j], State(side, tau, lead, y, v)
        peak = left if side < 0.0 else right
        if accuracy.order == 0:
            step = leap(law, segment, begin, peak)
        else:
            step = take_step(law, accuracy, segment, begin, peak, work)
        if step.kind == LOST:
            return BROKEN, right, left, steps, impacts, events, tau, y, v
        n = sample_step(law, segment, begin, work[4], accuracy.order, step, notes, n)
        watch_step(limits, law, accuracy.order, step.h, step.x, work, step.y)
        tau, y, v, lead = step.tau, step.y, step.v, 0
        right, left = (right, step.peak) if side < 0.0 else (step.peak, left)
        if step.kind == FALLEN:
            forget_fall(limits)
            return OVERTURNED, right, left, steps, impacts, events, tau, y, v
        if step.kind == HIT:
            impacts += 1
            events = note(notes.log, events, IMPACT, tau, side * v, side * law.eta * v)
            turned, y, v = -side, 0.0, -law.eta * v
            side, wait = after_impact(laws, moving, j, tau, turned, v)
            lead = 1 if v != 0.0 else 2
            if side == 0.0:
                heavy = weight(moving, j, tau)
                watch_train(limits, law, turned, ground(moving, j, tau), v, heavy)
                tau, v = tau + wait, 0.0
                events = note(notes.log, events, RESTED, tau, 0.0, 0.0)
    return TOO_LONG, right, left, steps, impacts, events, tau, y, v


MARCH = Kernel(march)


def workspace() -> FloatArray:
    """Return the spare numbers that `march` needs."""
    work = np.zeros((MAX_DEPTH + 13, ORDER + 1))
    work[-1, 0] = 1.0
    return work
