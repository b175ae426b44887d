"""One response of the reference, excursion by excursion.

The same march serves the exact model (Taylor series) and the linear ones (closed form, its events
bracketed by its series). The rotation is folded to one side, y = s theta > 0; time is in units of
1/p, acceleration in g.
"""

import math
from typing import NamedTuple

import numpy as np

from analytic.kernels.closed_form import free_peak, linear_state
from analytic.kernels.compiled import kernel
from analytic.kernels.forces import watch_free, watch_rest, watch_step, watch_train
from analytic.kernels.law import FloatArray, Law, Start
from analytic.kernels.polynomial import MAX_DEPTH, ORDER, highest, next_root, slope, value
from analytic.kernels.rest import (
    acceleration,
    ground,
    is_finite,
    next_uplift,
    side_after,
    time_to_rest,
)
from analytic.kernels.taylor import (
    Accuracy,
    expand_exact,
    expand_forcing,
    expand_linear,
    trusted_step,
)

AT_REST, ROCKED, OVERTURNED, TOO_LONG, BROKEN = 0, 1, 2, 3, 4
UPLIFT, IMPACT, RESTED, START = 0.0, 1.0, 2.0, 3.0
LYING = 0.5 * math.pi
"""Rotation at which the side of the block lies on the ground."""
MAX_STEPS = 2_000_000
VANISHING = 1e-15
"""A step shorter than this part of the time it starts from is lost in rounding."""
FAR = 1e3
"""A step out of an impact goes no further than this many times the excursion to be expected:
a root much closer to the step's begin than its end could be overlooked."""
LINEAR_STEP = 2.5
"""Linear step in units of the shortest time scale; its series is exact to 1e-16."""


class Notes(NamedTuple):
    """What to write down on the way; each array may be empty.

    times (n,) and samples (2, n): where to sample theta and its rate, and the samples. log
    (capacity, 4): kind, time, velocity before, velocity after; of an uplift the lead, and of a
    start off rest the rotation, in place of the velocity before. limits (2,): smallest normal
    force over weight, largest friction ratio.
    """

    times: FloatArray
    samples: FloatArray
    log: FloatArray
    limits: FloatArray


class End(NamedTuple):
    """How a march ended; `events` may exceed the capacity of the log."""

    outcome: int
    peak: float
    steps: int
    impacts: int
    events: int
    time: float


@kernel
def note(log: FloatArray, n: int, kind: float, tau: float, before: float, after: float) -> int:
    """Write an event into the log if it has room; return the number of events so far."""
    if n < log.shape[0]:
        log[n, 0] = kind
        log[n, 1] = tau
        log[n, 2] = before
        log[n, 3] = after
    return n + 1


@kernel
def workspace() -> FloatArray:
    """Return the workspace that `march` needs."""
    return np.empty((MAX_DEPTH + 12, ORDER + 1))


@kernel
def expand(
    law: Law,
    accuracy: Accuracy,
    segment: FloatArray,
    side: float,
    tau: float,
    lead: int,
    work: FloatArray,
) -> float:
    """Fill work[0] with the series of y, whose y[0] and y[1] are set; return the step it allows."""
    y, f = work[0], work[1]
    expand_forcing(segment, tau, side, accuracy.order, f)
    y[2] = 0.5 * acceleration(law, 1.0, f[0], y[0]) if lead < 3 else 0.0
    if law.linear:
        expand_linear(law, accuracy.order, f, y)
        return LINEAR_STEP / max(law.k, segment[3])
    expand_exact(law, accuracy.order, f, y, work[2], work[3])
    return trusted_step(y, accuracy)


@kernel
def first_crossing(d: FloatArray, order: int, lead: int, level: float, work: FloatArray) -> float:
    """Return where sum d[i] x^i first equals `level` in (0, 1]; 2 if nowhere.

    The first `lead` coefficients are zero, and their root at x = 0 is left out.
    """
    q = work[0]
    degree = order - lead
    q[0] = d[lead] - level
    low = q[0]
    for i in range(1, degree + 1):
        q[i] = d[i + lead]
        low += min(q[i], 0.0)
    return 2.0 if low > 0.0 else next_root(q, degree, 0.0, work[1:])


@kernel
def polish(
    law: Law,
    segment: FloatArray,
    side: float,
    tau: float,
    lead: int,
    y: float,
    v: float,
    h: float,
) -> float:
    """Return the impact near tau + h, found on the series, as the root of the closed form."""
    x = h
    for _ in range(4):
        end, rate = linear_state(law, segment, side, tau, lead, y, v, x)
        move = end / rate
        if not abs(move) < 1e-6 * h:
            break
        x -= move
        if abs(move) <= 2e-16 * x:
            break
    return x


@kernel
def sample_step(
    law: Law,
    segment: FloatArray,
    side: float,
    tau: float,
    lead: int,
    h: float,
    end: float,
    d: FloatArray,
    order: int,
    y: float,
    v: float,
    notes: Notes,
    n: int,
) -> int:
    """Sample the step from (y, v) at tau up to tau + end; return the number of samples so far."""
    times, samples = notes.times, notes.samples
    while n < times.size and times[n] <= tau + end:
        at = times[n] - tau
        if law.linear:
            theta, rate = linear_state(law, segment, side, tau, lead, y, v, at)
        else:
            theta, rate = value(d, order, at / h), slope(d, order, at / h) / h
        samples[0, n] = side * theta
        samples[1, n] = side * rate
        n += 1
    return n


@kernel
def march(
    law: Law,
    accuracy: Accuracy,
    segments: FloatArray,
    start: Start,
    until: float,
    notes: Notes,
    work: FloatArray,
) -> End:
    """Follow one response.

    Parameters
    ----------
    law : Law
    accuracy : Accuracy
        Of the exact model; for a linear one the order is that of the series that brackets events.
    segments : ndarray, shape (m, 7)
        The ground motion: rows of `motion.SEGMENT_COLUMNS` in units of 1/p and g.
    start : Start
        State at time zero.
    until : float
        Time to follow the response to, at least to the end of the ground motion. The outcome and
        the peak of what comes after follow from energy.
    notes : Notes
    work : ndarray
        From `workspace()`.
    """
    series, d, spare = work[0], work[4], work[5:]
    order = accuracy.order
    last = max(until, segments[-1, 1])
    still = np.zeros(7)
    if not is_finite(segments):
        return End(BROKEN, 0.0, 0, 0, 0, 0.0)
    side, y, v = start
    tau, peak = 0.0, y
    j = steps = impacts = events = n = 0
    lead = 1 if y == 0.0 else 0
    if side != 0.0:
        events = note(notes.log, events, START, tau, side * y, side * v)
    while True:
        if side == 0.0:
            resting = j
            j, rise, side, lead = next_uplift(segments, j, tau, law.onset)
            while n < notes.times.size and notes.times[n] <= min(rise, last):
                notes.samples[:, n] = 0.0
                n += 1
            if notes.limits.size > 0:
                watch_rest(notes.limits, segments, resting, tau, rise)
            if side == 0.0:
                outcome = AT_REST if events == 0 else ROCKED
                return End(outcome, peak, steps, impacts, events, last)
            tau = rise
            events = note(notes.log, events, UPLIFT, tau, float(lead), 0.0)
        while j < len(segments) and tau >= segments[j, 1]:
            j += 1
        if tau >= last:
            ahead = free_peak(law, y, v)
            if notes.limits.size > 0:
                watch_free(notes.limits, law, y, v)
            outcome = OVERTURNED if ahead == math.inf else ROCKED
            return End(outcome, max(peak, ahead), steps, impacts, events, last)
        if steps == MAX_STEPS:
            return End(TOO_LONG, peak, steps, impacts, events, tau)

        steps += 1
        segment = segments[j] if j < len(segments) else still
        boundary = segment[1] if j < len(segments) else last
        series[0], series[1] = y, v
        h = expand(law, accuracy, segment, side, tau, lead, work)
        if not tau * VANISHING < h < math.inf:
            return End(BROKEN, peak, steps, impacts, events, tau)
        if lead == 1 and series[2] < 0.0:
            h = min(h, -FAR * v / series[2])
        landed = tau + h >= boundary
        if landed:
            h = boundary - tau
        scale = 1.0
        for i in range(order + 1):
            d[i] = series[i] * scale
            scale *= h

        x = first_crossing(d, order, lead, 0.0, spare)
        hit = x <= 1.0
        x = min(x, 1.0)
        peak, _ = highest(d, order, lead, x, peak, spare)
        fallen = peak >= LYING and first_crossing(d, order, 0, LYING, spare) <= x
        if fallen:
            x = first_crossing(d, order, 0, LYING, spare)
        elif hit and law.linear:
            x = min(polish(law, segment, side, tau, lead, y, v, x * h) / h, 1.0)
        n = sample_step(law, segment, side, tau, lead, h, x * h, d, order, y, v, notes, n)
        if notes.limits.size > 0:
            watch_step(notes.limits, order, h, x, work)
        if fallen:
            return End(OVERTURNED, peak, steps, impacts, events, tau + x * h)

        if law.linear:
            y, v = linear_state(law, segment, side, tau, lead, y, v, x * h)
        else:
            y, v = value(d, order, x), slope(d, order, x) / h
        if not abs(y) + abs(v) < math.inf:
            return End(BROKEN, peak, steps, impacts, events, tau)
        # a root within rounding of the step's end may escape the polynomial, not the state
        hit = hit or y <= 0.0
        tau = boundary if landed and x == 1.0 else tau + x * h
        lead = 0
        if not hit:
            continue

        impacts += 1
        events = note(notes.log, events, IMPACT, tau, side * v, side * law.eta * v)
        side, y, v, lead = -side, 0.0, -law.eta * v, 1
        a = ground(segments, j, tau)
        wait = time_to_rest(law, side, v, a)
        onward = side_after(law, side, v, a, ground(segments, j, tau + wait), wait)
        if onward == 0.0:
            if notes.limits.size > 0:
                watch_train(notes.limits, law, side, a, v)
            tau += wait
            events = note(notes.log, events, RESTED, tau, 0.0, 0.0)
            v = 0.0
        elif v == 0.0:
            lead = 2
        side = onward
