"""The paper's own solvers (section 4): RK4 and average acceleration, with fractional time stepping.

They march with a fixed step. A step that passes through theta = 0 is taken back and
repeated in tenths, and so on, until abs(theta) is below the event tolerance at the impact.
"""

import math

from numpy.typing import ArrayLike

from analytic.block import RigidBlock
from analytic.checks import positive
from analytic.kernels.closed_form import free_peak
from analytic.kernels.compiled import kernel
from analytic.kernels.excursions import (
    AT_REST,
    BROKEN,
    IMPACT,
    LYING,
    OVERTURNED,
    RESTED,
    ROCKED,
    START,
    TOO_LONG,
    UPLIFT,
    VANISHING,
    End,
    Notes,
    note,
)
from analytic.kernels.law import Law, Start
from analytic.kernels.rest import (
    acceleration,
    ground,
    is_finite,
    next_uplift,
    side_after,
    time_to_rest,
)
from analytic.models import Model, find_model
from analytic.motion import FloatArray, Motion
from analytic.response import Response
from analytic.simulate import check_window, respond, scaled_segments
from analytic.start import REST, folded

METHODS = ("rk4", "average-acceleration")
STEP = 1e-3
"""Default step [1/p]."""
EVENT_TOLERANCE = 1e-6
"""Default tolerance of an impact [rad], the paper's."""
FRACTION = 0.1
MAX_STEPS = 50_000_000


def integrate(
    block: RigidBlock,
    motion: Motion,
    model: str | Model = "exact",
    start: tuple[float, float] = REST,
    *,
    method: str = "rk4",
    step: float = STEP,
    event_tolerance: float = EVENT_TOLERANCE,
    duration: float | None = None,
    times: ArrayLike | None = None,
) -> Response:
    """Integrate one response step by step, as the paper does.

    Parameters
    ----------
    block, motion, model, start, duration, times
        As for `simulate`. Without a duration the response is followed to its first turning point
        after the motion, where peak and outcome are decided.
    method : {"rk4", "average-acceleration"}
        Classical Runge-Kutta of order 4, or Newmark's method with beta = 1/4 and gamma = 1/2, its
        equation solved by modified Newton-Raphson.
    step : float
        Time step times p.
    event_tolerance : float
        Largest abs(theta) [rad] that counts as contact.

    Returns
    -------
    Response
        Its steps include those taken back; its history is interpolated by cubics.

    Raises
    ------
    ValueError
        If an argument is unknown or out of range.
    """
    if method not in METHODS:
        raise ValueError(f"method is {method!r}; it must be one of {', '.join(METHODS)}")
    step = positive("step", step)
    event_tolerance = positive("event_tolerance", event_tolerance)
    law = find_model(model).law(block.alpha, block.restitution)
    until, sampled = check_window(motion, duration, times)
    begin = folded(block, law, motion, start, sampled)
    segments = scaled_segments(block, motion)

    def solve(notes: Notes) -> End:
        end = until * block.p if duration is not None else 0.0
        return tread(law, segments, begin, end, notes, method == "rk4", step, event_tolerance)

    return respond(block, solve, sampled, times is not None, watched=False)


@kernel
def rk4_step(
    law: Law, segments: FloatArray, j: int, side: float, tau: float, y: float, v: float, h: float
) -> tuple[float, float]:
    """Advance (y, v) by one classical Runge-Kutta step."""
    middle = ground(segments, j, tau + 0.5 * h)
    k1 = acceleration(law, side, ground(segments, j, tau), y)
    k2 = acceleration(law, side, middle, y + 0.5 * h * v)
    k3 = acceleration(law, side, middle, y + 0.5 * h * (v + 0.5 * h * k1))
    k4 = acceleration(law, side, ground(segments, j, tau + h), y + h * (v + 0.5 * h * k2))
    return y + h * v + h * h * (k1 + k2 + k3) / 6.0, v + h * (k1 + 2.0 * (k2 + k3) + k4) / 6.0


@kernel
def average_step(
    law: Law, segments: FloatArray, j: int, side: float, tau: float, y: float, v: float, h: float
) -> tuple[float, float]:
    """Advance (y, v) by one step of constant average acceleration.

    The end's rotation is found by Newton's method with the tangent of the step's begin (modified
    Newton-Raphson).
    """
    a0, a1 = ground(segments, j, tau), ground(segments, j, tau + h)
    before = acceleration(law, side, a0, y)
    if law.linear:
        stiffness = law.k * law.k
    else:
        stiffness = math.cos(law.alpha - y) - side * a0 * math.sin(law.alpha - y)
    tangent = 1.0 - 0.25 * h * h * stiffness
    known = y + h * v + 0.25 * h * h * before
    end = known + 0.25 * h * h * before
    after = before
    for _ in range(50):
        after = acceleration(law, side, a1, end)
        move = (known + 0.25 * h * h * after - end) / tangent
        end += move
        if abs(move) <= 1e-15 * abs(end):
            break
    after = acceleration(law, side, a1, end)
    return end, v + 0.5 * h * (before + after)


@kernel
def cubic(y: float, v: float, end: float, rate: float, h: float, x: float) -> tuple[float, float]:
    """Return value and slope at x h of the cubic through (y, v) at 0 and (end, rate) at h."""
    rise = end - y
    c2 = 3.0 * rise - h * (2.0 * v + rate)
    c3 = h * (v + rate) - 2.0 * rise
    return y + x * (h * v + x * (c2 + x * c3)), v + x * (2.0 * c2 + 3.0 * x * c3) / h


@kernel
def turning_value(y: float, v: float, end: float, rate: float, h: float) -> float:
    """Return the maximum of the cubic through (y, v > 0) at 0 and (end, rate <= 0) at h."""
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        if cubic(y, v, end, rate, h, middle)[1] > 0.0:
            low = middle
        else:
            high = middle
    return cubic(y, v, end, rate, h, low)[0]


@kernel
def tread(
    law: Law,
    segments: FloatArray,
    start: Start,
    until: float,
    notes: Notes,
    rk4: bool,
    step: float,
    tolerance: float,
) -> End:
    """Follow one response with a fixed step; arguments as for `excursions.march`.

    With `until` before the end of the ground motion the march ends when the peak is decided.
    """
    if not is_finite(segments):
        return End(BROKEN, 0.0, 0, 0, 0, 0.0)
    times, samples = notes.times, notes.samples
    moving = segments[-1, 1]
    last = max(until, moving)
    side, y, v = start
    tau, peak, h = 0.0, y, step
    j = steps = impacts = events = n = 0
    if side != 0.0:
        events = note(notes.log, events, START, tau, side * y, side * v)
    while True:
        if side == 0.0:
            j, rise, side, _ = next_uplift(segments, j, tau, law.onset)
            while n < times.size and times[n] <= min(rise, last):
                samples[:, n] = 0.0
                n += 1
            if side == 0.0:
                outcome = AT_REST if events == 0 else ROCKED
                return End(outcome, peak, steps, impacts, events, last)
            tau, h = rise, step
            events = note(notes.log, events, UPLIFT, tau, 0.0, 0.0)
        while j < len(segments) and tau >= segments[j, 1]:
            j += 1
        if until > moving and tau >= until:
            ahead = free_peak(law, y, v)
            outcome = OVERTURNED if ahead == math.inf else ROCKED
            return End(outcome, max(peak, ahead), steps, impacts, events, tau)
        if steps == MAX_STEPS:
            return End(TOO_LONG, peak, steps, impacts, events, tau)

        steps += 1
        boundary = segments[j, 1] if j < len(segments) else (until if until > moving else math.inf)
        landed = tau + h >= boundary
        length = boundary - tau if landed else h
        if rk4:
            end, rate = rk4_step(law, segments, j, side, tau, y, v, length)
        else:
            end, rate = average_step(law, segments, j, side, tau, y, v, length)
        if not (abs(end) + abs(rate) < math.inf and length > tau * VANISHING):
            return End(BROKEN, peak, steps, impacts, events, tau)
        if end < -tolerance and length > 1e-15:
            h = FRACTION * length
            continue

        if v > 0.0 and rate <= 0.0:
            peak = max(peak, turning_value(y, v, end, rate, length))
        peak = max(peak, end)
        while n < times.size and times[n] <= tau + length:
            theta, speed = cubic(y, v, end, rate, length, (times[n] - tau) / length)
            samples[0, n] = side * theta
            samples[1, n] = side * speed
            n += 1
        turned = v > 0.0 and rate <= 0.0 and end < law.saddle
        tau = boundary if landed else tau + length
        y, v = end, rate
        decided = until <= moving < tau
        if y >= LYING or (decided and y > law.saddle and v >= 0.0):
            return End(OVERTURNED, peak, steps, impacts, events, tau)
        if decided and turned:
            return End(ROCKED, peak, steps, impacts, events, tau)
        if not (y <= tolerance and v < 0.0):
            h = step if v > 0.0 else h
            continue

        impacts += 1
        events = note(notes.log, events, IMPACT, tau, side * v, side * law.eta * v)
        side, y, v, h = -side, 0.0, -law.eta * v, step
        while j < len(segments) and tau >= segments[j, 1]:
            j += 1
        a = ground(segments, j, tau)
        wait = time_to_rest(law, side, v, a)
        # what stays below the tolerance cannot be told from rest
        unseen = wait < math.inf and 0.5 * v * v < -tolerance * acceleration(law, side, a, 0.0)
        onward = side_after(law, side, v, a, ground(segments, j, tau + wait), wait)
        side = 0.0 if unseen else onward
        if side == 0.0:
            tau, v = tau + wait, 0.0
            events = note(notes.log, events, RESTED, tau, 0.0, 0.0)
