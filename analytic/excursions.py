"""One response, excursion by excursion: uplift, impacts, turning points, rest, overturning.

The same march serves the exact model (Taylor series) and the linear ones (closed form, its events
bracketed by its series). The rotation is folded to one side, y = s theta > 0; time is in units of
1/p, acceleration in g.
"""

import math

import numpy as np

from analytic.closed_form import free_peak, linear_state, turning_rotation, work_to
from analytic.compiled import kernel
from analytic.motion import FloatArray
from analytic.polynomial import MAX_DEPTH, ORDER, next_root, slope, to_bernstein, value
from analytic.taylor import expand_exact, expand_forcing, expand_linear, trusted_step

AT_REST, ROCKED, OVERTURNED, FAILED = 0.0, 1.0, 2.0, 3.0
UPLIFT, IMPACT, REST = 0.0, 1.0, 2.0
LYING = 0.5 * math.pi
MAX_STEPS = 2_000_000
LINEAR_STEP = 2.5
"""Linear step in units of the shortest time scale: its series is exact to 1e-16."""
ZENO = 1e-4
"""A train of impacts shorter than this [1/p], under forcing that hardly changes, is summed."""
ROWS = MAX_DEPTH + 9
"""Rows of the workspace that `march` needs, each ORDER + 1 wide."""


@kernel
def ground(segments: FloatArray, j: int, tau: float) -> float:
    """Return the ground acceleration [g] on segment j; zero after the last."""
    if j >= segments.shape[0]:
        return 0.0
    start, _, amplitude, omega, phase, offset, rate = segments[j]
    t = tau - start
    return amplitude * math.sin(omega * t + phase) + offset + rate * t


@kernel
def sine_uplift(segment: FloatArray, tau: float, onset: float) -> tuple[float, bool]:
    """Return when abs(amplitude sin) first exceeds the onset from tau on, and whether smoothly."""
    start, _, amplitude, omega, phase, _, _ = segment
    if abs(amplitude) <= onset:
        return math.inf, True
    angle = omega * (tau - start) + phase
    level = math.asin(onset / abs(amplitude))
    within = angle - math.pi * math.floor(angle / math.pi)
    if level + 1e-14 < within < math.pi - level - 1e-14:
        return tau, False
    wait = level - within if within <= level + 1e-14 else math.pi + level - within
    return tau + max(wait, 0.0) / omega, True


@kernel
def ramp_uplift(segment: FloatArray, tau: float, onset: float) -> tuple[float, bool]:
    """Return when abs(offset + slope t) first exceeds the onset from tau on, whether smoothly."""
    start, _, _, _, _, offset, rate = segment
    now = offset + rate * (tau - start)
    if abs(now) > onset:
        return tau, False
    if rate == 0.0:
        return math.inf, True
    return tau + (onset - math.copysign(1.0, rate) * now) / abs(rate), True


@kernel
def next_uplift(
    segments: FloatArray, j: int, tau: float, onset: float
) -> tuple[int, float, float, bool]:
    """Return (segment, time, side, smooth) of the next uplift of a resting block; side 0: none."""
    for i in range(j, segments.shape[0]):
        begin = max(tau, segments[i, 0])
        if segments[i, 2] != 0.0:
            time, smooth = sine_uplift(segments[i], begin, onset)
        else:
            time, smooth = ramp_uplift(segments[i], begin, onset)
        if time < segments[i, 1]:
            # a smooth uplift happens at the onset itself, where rounding must not choose the sign
            return i, time, -math.copysign(1.0, ground(segments, i, time)), smooth
    return segments.shape[0], math.inf, 0.0, True


@kernel
def restoring(
    linear: bool, k: float, saddle: float, factor: float, alpha: float, side: float, a: float
) -> float:
    """Return -y'' of a block at y = 0 on the given side under the ground acceleration a."""
    if linear:
        return k * k * (saddle + side * factor * a)
    return math.sin(alpha) + side * a * math.cos(alpha)


@kernel
def impacts_left(eta: float, v: float, here: float, there: float) -> float:
    """Return the time until rest of a block leaving the base at v; inf if it does not rest.

    The excursions last 2 v/r with the restoring accelerations r here and there in turn, and the
    velocity falls by eta at each impact: a geometric series.
    """
    if v == 0.0 and here > 0.0 and there > 0.0:
        return 0.0
    if eta >= 1.0 or here <= 0.0 or there <= 0.0:
        return math.inf
    return 2.0 * v * (1.0 / here + eta / there) / (1.0 - eta * eta)


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
def highest(d: FloatArray, lead: int, end: float, above: float, work: FloatArray) -> float:
    """Return the maximum of sum d[i] x^i on [0, end] if it exceeds `above`, else `above`."""
    b = work[0]
    to_bernstein(d, ORDER, b)
    bound = b[0]
    for i in range(1, ORDER + 1):
        bound = max(bound, b[i])
    if bound <= above:
        return above
    top = max(above, value(d, ORDER, end))
    rate = work[1]
    shift = max(lead - 1, 0)
    degree = ORDER - 1 - shift
    for i in range(degree + 1):
        rate[i] = (i + shift + 1) * d[i + shift + 1]
    x = next_root(rate, degree, 0.0, work[2:])
    while x < end:
        top = max(top, value(d, ORDER, x))
        x = next_root(rate, degree, x, work[2:]) if x < 1.0 else 2.0
    return top


@kernel
def first_zero(d: FloatArray, lead: int, level: float, work: FloatArray) -> float:
    """Return where sum d[i] x^i first equals `level` in (0, 1]; 2 if nowhere.

    The first `lead` coefficients are zero and their root at x = 0 is left out.
    """
    q = work[0]
    degree = ORDER - lead
    low = 0.0
    for i in range(degree + 1):
        q[i] = d[i + lead]
        low += min(q[i], 0.0) if i > 0 else 0.0
    if lead == 0:
        q[0] -= level
    if q[0] + low > 0.0:
        return 2.0
    return next_root(q, degree, 0.0, work[1:])


@kernel
def forces(alpha: float, side: float, a: float, y: float, v: float) -> tuple[float, float]:
    """Return (normal, horizontal) contact force over weight, by the exact equation of motion."""
    z = alpha - y
    sine, cosine = math.sin(z), math.cos(z)
    acceleration = -(sine + side * a * cosine)
    horizontal = a + 0.75 * side * (v * v * sine + acceleration * cosine)
    normal = 1.0 + 0.75 * (acceleration * sine - v * v * cosine)
    return normal, horizontal


@kernel
def watch_forces(
    limits: FloatArray, alpha: float, side: float, a: float, y: float, v: float
) -> None:
    """Keep the smallest normal force and the largest friction ratio in `limits`."""
    normal, horizontal = forces(alpha, side, a, y, v)
    limits[0] = min(limits[0], normal)
    limits[1] = max(limits[1], abs(horizontal) / normal if normal > 0.0 else math.inf)


@kernel
def watch_free_forces(limits: FloatArray, alpha: float, side: float, y: float, v: float) -> None:
    """Watch the forces from the end of the ground motion to the next impact of a survivor."""
    work = 0.5 * v * v + work_to(False, 1.0, alpha, alpha, y)
    top = turning_rotation(False, 1.0, alpha, alpha, work)
    if top == math.inf:
        return
    for i in range(17):
        height = top * i / 16.0
        rate = math.sqrt(max(2.0 * (work - work_to(False, 1.0, alpha, alpha, height)), 0.0))
        watch_forces(limits, alpha, side, 0.0, height, rate)


@kernel
def polish(
    k: float,
    saddle: float,
    factor: float,
    segment: FloatArray,
    side: float,
    tau: float,
    lead: int,
    y: float,
    v: float,
    h: float,
    x: float,
) -> float:
    """Return the impact at x h, found on the series, as the root of the closed form."""
    for _ in range(4):
        end, rate = linear_state(k, saddle, factor, segment, side, tau, lead, y, v, x * h)
        move = end / (rate * h)
        if not abs(move) < 1e-6 * x:
            break
        x -= move
        if abs(move) <= 2e-16 * x:
            break
    return min(x, 1.0)


@kernel
def march(
    linear: bool,
    k: float,
    saddle: float,
    factor: float,
    alpha: float,
    eta: float,
    segments: FloatArray,
    until: float,
    times: FloatArray,
    samples: FloatArray,
    log: FloatArray,
    limits: FloatArray,
    work: FloatArray,
) -> tuple[float, float, int, int, int, float]:
    """Follow one response from rest.

    Parameters
    ----------
    linear, k, saddle, factor
        The model (see `analytic.models`).
    alpha, eta : float
        Slenderness [rad] and velocity ratio at impacts.
    segments : ndarray, shape (m, 7)
        The ground motion: rows of `motion.SEGMENT_COLUMNS` in units of 1/p and g.
    until : float
        Time to follow the response to; where the ground still moves, to the end of that. The
        outcome and the peak of what comes after follow from energy.
    times, samples : ndarray, shapes (n,) and (2, n)
        Where to sample theta and its rate, and the samples; n may be 0.
    log : ndarray, shape (capacity, 4)
        Filled with (kind, time, velocity before, velocity after); capacity may be 0.
    limits : ndarray, shape (2,) or (0,)
        Smallest normal force over weight, largest friction ratio.
    work : ndarray, shape (ROWS, ORDER + 1)

    Returns
    -------
    outcome, peak, steps, impacts, events, end
        End is the time up to which the response was followed.
    """
    y_series, f, sine, cosine, d = work[0], work[1], work[2], work[3], work[4]
    spare = work[5:]
    onset = saddle / factor if linear else math.tan(alpha)
    m = segments.shape[0]
    last = max(until, segments[m - 1, 1])
    free = np.zeros(7)
    tau = y = v = side = peak = 0.0
    j = lead = steps = impacts = events = sample = 0
    lifted = False
    while True:
        if side == 0.0:
            j, rise, side, smooth = next_uplift(segments, j, tau, onset)
            while sample < times.size and times[sample] <= min(rise, last):
                samples[0, sample] = samples[1, sample] = 0.0
                sample += 1
            if side == 0.0:
                return (ROCKED if lifted else AT_REST), peak, steps, impacts, events, last
            tau = rise
            lead = 3 if smooth else 2
            lifted = True
            events = note(log, events, UPLIFT, tau, 0.0, 0.0)
        while j < m and tau >= segments[j, 1]:
            j += 1
        if tau >= last:
            ahead = free_peak(linear, k, saddle, alpha, eta, y, v)
            if limits.size > 0:
                watch_free_forces(limits, alpha, side, y, v)
            outcome = OVERTURNED if ahead == math.inf else ROCKED
            return outcome, max(peak, ahead), steps, impacts, events, last
        if steps >= MAX_STEPS:
            return FAILED, peak, steps, impacts, events, tau

        segment = segments[j] if j < m else free
        boundary = segments[j, 1] if j < m else last
        steps += 1
        y_series[0], y_series[1] = y, v
        expand_forcing(segment, tau, side, f)
        if linear:
            expand_linear(k, saddle, factor, f, lead, y_series)
            h = LINEAR_STEP / max(k, segment[3])
        else:
            expand_exact(alpha, f, lead, y_series, sine, cosine)
            h = trusted_step(y_series)
        landed = tau + h >= boundary
        if landed:
            h = boundary - tau
        scale = 1.0
        for i in range(ORDER + 1):
            d[i] = y_series[i] * scale
            scale *= h

        x = first_zero(d, lead, 0.0, spare)
        hit = x <= 1.0
        if hit and linear:
            x = polish(k, saddle, factor, segment, side, tau, lead, y, v, h, x)
        end = min(x, 1.0)
        peak = highest(d, lead, end, peak, spare)
        fallen = False
        if peak >= LYING:
            x = first_zero(d, 0, LYING, spare)
            fallen = x <= end
            end = min(x, end)

        while sample < times.size and times[sample] <= tau + end * h:
            at = times[sample] - tau
            if linear and at > 0.0:
                theta, rate = linear_state(k, saddle, factor, segment, side, tau, lead, y, v, at)
            else:
                theta = value(d, ORDER, at / h)
                rate = slope(d, ORDER, at / h) / h
            samples[0, sample] = side * theta
            samples[1, sample] = side * rate
            sample += 1
        if limits.size > 0:
            for i in range(17):
                at = end * i / 16.0
                height, rate = value(d, ORDER, at), slope(d, ORDER, at) / h
                a = ground(segments, j, tau + at * h)
                watch_forces(limits, alpha, side, a, height, rate)
        if fallen:
            return OVERTURNED, peak, steps, impacts, events, tau + end * h

        if linear:
            y, v = linear_state(k, saddle, factor, segment, side, tau, lead, y, v, end * h)
        else:
            y, v = value(d, ORDER, end), slope(d, ORDER, end) / h
        tau = boundary if landed and not hit else tau + end * h
        lead = 0
        if not hit:
            continue

        impacts += 1
        events = note(log, events, IMPACT, tau, side * v, side * eta * v)
        side, y, v, lead = -side, 0.0, -eta * v, 1
        a = ground(segments, j, tau)
        here = restoring(linear, k, saddle, factor, alpha, side, a)
        there = restoring(linear, k, saddle, factor, alpha, -side, a)
        wait = impacts_left(eta, v, here, there)
        if wait < ZENO:
            a = ground(segments, j, tau + wait)
            later = restoring(linear, k, saddle, factor, alpha, side, a)
            if abs(later - here) <= ZENO * min(here, there):
                tau += wait
                side = v = 0.0
                events = note(log, events, REST, tau, 0.0, 0.0)
        elif v == 0.0:
            # no velocity left, but the ground pushes the block up at once
            side = 1.0 if a < 0.0 else -1.0
            lead = 2
