"""The paper's own solvers (section 4): RK4 and average acceleration, with fractional time stepping.

They march with a fixed step. A step that passes through theta = 0 is taken back and
repeated in tenths, and so on, until abs(theta) is below the event tolerance at the impact. Symbols
and units of the kernels are those of `analytic.kernels.law`.
"""

import math
from typing import NamedTuple

from numpy.typing import ArrayLike

from analytic.block import RigidBlock
from analytic.checks import positive
from analytic.frame import Rocker
from analytic.kernels import excursions
from analytic.kernels.closed_form import free_peaks
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
from analytic.kernels.rest import (
    acceleration,
    after_impact,
    ground,
    next_uplift,
    segment_at,
    shaking,
)
from analytic.models import Model
from analytic.motion import Motion
from analytic.response import Response
from analytic.simulate import as_response
from analytic.start import REST, check_vertical, pose

METHODS = ("rk4", "average-acceleration")
STEP = 1e-3
"""Default step [1/p]."""
EVENT_TOLERANCE = 1e-6
"""Default tolerance of an impact [rad], the paper's."""
FRACTION = 0.1
MAX_STEPS = 50_000_000
SOME = 10
"""Steps that take about as long as one of the exact solution."""


def integrate(
    block: Rocker,
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
        after the motion, where peak and outcome are decided and its history ends.
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

    Examples
    --------
    >>> block = RigidBlock(width=0.5, height=1.5)
    >>> pulse = SinePulse.in_g(0.4, omega=6.2832, half_cycles=2)
    >>> round(integrate(block, pulse, method="rk4").peak_ratio, 4)
    0.3851
    """
    if method not in METHODS:
        raise ValueError(f"method is {method!r}; it must be one of {', '.join(METHODS)}")
    step = positive("step", step)
    event_tolerance = positive("event_tolerance", event_tolerance)
    if isinstance(block, RigidBlock) and not block.is_even:
        raise ValueError(f"offset is {block.offset!r}; it must be 0 for a fixed step")
    check_vertical(block, motion)
    posed = pose(block, motion, model, start, duration, times)
    solver = Solver(method == "rk4", step, event_tolerance)
    ended = float(posed.segments[-1, 1])
    followed = duration is not None and posed.until > ended
    moving = posed.then_still(posed.until if followed else math.inf)
    tread = TREAD.few(1, posed.until / step / SOME)

    def solve(notes: Notes) -> excursions.Ended:
        return tread(posed.laws, moving, posed.start, followed, notes, solver)

    return as_response(block, posed, solve, times is not None, watched=False)


class Solver(NamedTuple):
    """How to step: by RK4 or by average acceleration; the step [1/p]; the event tolerance [rad]."""

    rk4: bool
    step: float
    tolerance: float


class Cubic(NamedTuple):
    """A step as the cubic through (y, v) at its begin and (end, rate) at its end, h later."""

    y: float
    v: float
    end: float
    rate: float
    h: float


def take_step(law: Law, segment: FloatArray, begin: State, h: float, rk4: bool) -> Cubic:
    """Advance by one step, of classical Runge-Kutta or of average acceleration."""
    if not rk4:
        return average_step(law, segment, begin, h)
    side, tau, _, y, v = begin
    middle = shaking(segment, tau + 0.5 * h)
    k1 = acceleration(law, side, shaking(segment, tau), y)
    k2 = acceleration(law, side, middle, y + 0.5 * h * v)
    k3 = acceleration(law, side, middle, y + 0.5 * h * (v + 0.5 * h * k1))
    k4 = acceleration(law, side, shaking(segment, tau + h), y + h * (v + 0.5 * h * k2))
    end = y + h * v + h * h * (k1 + k2 + k3) / 6.0
    return Cubic(y, v, end, v + h * (k1 + 2.0 * (k2 + k3) + k4) / 6.0, h)


def average_step(law: Law, segment: FloatArray, begin: State, h: float) -> Cubic:
    """Advance by one step of constant average acceleration, by modified Newton-Raphson."""
    side, tau, _, y, v = begin
    a0, a1 = shaking(segment, tau), shaking(segment, tau + h)
    before = acceleration(law, side, a0, y)
    if law.linear:
        stiffness = law.k * law.k
    else:
        stiffness = law.k * law.k * (math.cos(law.alpha - y) - side * a0 * math.sin(law.alpha - y))
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
    return Cubic(y, v, end, v + 0.5 * h * (before + after), h)


def cubic_at(path: Cubic, x: float) -> tuple[float, float]:
    """Return value and slope of a step at the part x of it."""
    y, v, end, rate, h = path
    rise = end - y
    c2 = 3.0 * rise - h * (2.0 * v + rate)
    c3 = h * (v + rate) - 2.0 * rise
    return y + x * (h * v + x * (c2 + x * c3)), v + x * (2.0 * c2 + 3.0 * x * c3) / h


def turns(path: Cubic) -> bool:
    """Tell whether the block turns back within a step."""
    return path.v > 0.0 and path.rate <= 0.0


def turning_value(path: Cubic) -> float:
    """Return the maximum of a step that turns."""
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        if cubic_at(path, middle)[1] > 0.0:
            low = middle
        else:
            high = middle
    return cubic_at(path, low)[0]


def sample_cubic(path: Cubic, begin: State, notes: Notes, n: int) -> int:
    """Sample a step from a state; return the number of samples so far."""
    while n < len(notes.times) and notes.times[n] <= begin.tau + path.h:
        theta, speed = cubic_at(path, (notes.times[n] - begin.tau) / path.h)
        notes.samples[0, n], notes.samples[1, n] = begin.side * theta, begin.side * speed
        n += 1
    return n


UNDECIDED = -1


def verdict(law: Law, path: Cubic, free: bool) -> int:
    """Return whether a block is ROCKED, OVERTURNED or UNDECIDED; `free` if no ground moves it."""
    y, v = path.end, path.rate
    if y >= excursions.LYING or (free and y > law.saddle and v >= 0.0):
        return excursions.OVERTURNED
    return excursions.ROCKED if free and turns(path) and y < law.saddle else UNDECIDED


def next_side(
    laws: Laws, segments: FloatArray, j: int, tau: float, side: float, v: float, tolerance: float
) -> tuple[float, float]:
    """Return what `after_impact` does, but 0 for what stays below the tolerance, as at rest."""
    onward, wait = after_impact(laws, segments, j, tau, side, v)
    pull = -acceleration(law_of(laws, side), side, ground(segments, j, tau), 0.0)
    unseen = wait < math.inf and 0.5 * v * v < tolerance * pull
    return 0.0 if unseen else onward, wait


def tread(
    laws: Laws, moving: FloatArray, start: Start, followed: bool, notes: Notes, solver: Solver
) -> excursions.Ended:
    """Follow one response with a fixed step as `excursions.march`, to the end if `followed`."""
    ended = moving[-1][0]
    last = moving[-1][1] if followed else ended
    side, y, v = start
    tau, right, left, h = 0.0, y if side > 0.0 else 0.0, y if side < 0.0 else 0.0, solver.step
    j = steps = impacts = events = n = 0
    while steps < MAX_STEPS:
        if side == 0.0:
            j, rise, side, _ = next_uplift(moving, j, tau, laws)
            n = sample_still(notes, min(rise, last), n, 0.0, 0.0)
            if side == 0.0:
                outcome = (
                    excursions.AT_REST if events == 0 and start.side == 0.0 else excursions.ROCKED
                )
                return outcome, right, left, steps, impacts, events, last, 0.0, 0.0
            tau, h = rise, solver.step
            events = note(notes.log, events, UPLIFT, tau, 0.0, 0.0)
        j, law = segment_at(moving, j, tau), law_of(laws, side)
        if followed and tau >= last:
            ahead = free_peaks(laws, side, y, v)
            right, left = max(right, ahead[0]), max(left, ahead[1])
            outcome = excursions.OVERTURNED if max(right, left) == math.inf else excursions.ROCKED
            return outcome, right, left, steps, impacts, events, tau, y, v
        steps += 1
        segment, begin = moving[j], State(side, tau, 0, y, v)
        landed = tau + h >= segment[1]
        length = segment[1] - tau if landed else h
        path = take_step(law, segment, begin, length, solver.rk4)
        if not (abs(path.end) + abs(path.rate) < math.inf and length > tau * excursions.VANISHING):
            return excursions.BROKEN, right, left, steps, impacts, events, tau, y, v
        if path.end < -solver.tolerance and length > 1e-15:
            h = FRACTION * length
            continue

        peak = max(turning_value(path) if turns(path) else path.end, path.end)
        right = max(right, peak) if side > 0.0 else right
        left = max(left, peak) if side < 0.0 else left
        n = sample_cubic(path, begin, notes, n)
        tau = segment[1] if landed else tau + length
        y, v = path.end, path.rate
        found = verdict(law, path, not followed and tau > ended)
        if found != UNDECIDED:
            return found, right, left, steps, impacts, events, tau, y, v
        h = solver.step if v > 0.0 else h
        if y <= solver.tolerance and v < 0.0:
            impacts += 1
            events = note(notes.log, events, IMPACT, tau, side * v, side * law.eta * v)
            j = segment_at(moving, j, tau)
            turned, y, v, h = -side, 0.0, -law.eta * v, solver.step
            side, wait = next_side(laws, moving, j, tau, turned, v, solver.tolerance)
            if side == 0.0:
                tau, v = tau + wait, 0.0
                events = note(notes.log, events, RESTED, tau, 0.0, 0.0)
    return excursions.TOO_LONG, right, left, steps, impacts, events, tau, y, v


TREAD = Kernel(tread)
