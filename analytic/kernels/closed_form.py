"""Closed forms: the linear models on a segment, free rocking, overturning criteria.

In the kernels the rotation is folded to one side, y = s theta > 0, time is in units of 1/p and
acceleration in g. The public functions take radians and the units they name.
"""

import math

from analytic.kernels.compiled import inner
from analytic.kernels.law import FloatArray, Law, State

SERIES_BELOW = 1.0
"""Below this argument the two differences of functions are summed from their series."""
LOST = 1e-17
"""Part of a sum below which a term, and the smaller ones after it, change no digit."""


@inner
def square(x: float) -> float:
    """Return x^2, as a product: Python's power would round otherwise than a compiled one."""
    return x * x


@inner
def sine_minus_sinh(x: float, u: float) -> float:
    """Return sin(x)/x - sinh(u)/u without cancellation."""
    if max(x, u) > SERIES_BELOW:
        first = math.sin(x) / x if x > 0.0 else 1.0
        return first - math.sinh(u) / u
    total = 0.0
    px, pu, factorial = 1.0, 1.0, 1.0
    for i in range(1, 11):
        px *= -x * x
        pu *= u * u
        factorial *= 2 * i * (2 * i + 1)
        total += (px - pu) / factorial
        if abs(px) + pu <= LOST * factorial * abs(total):
            break
    return total


@inner
def cosh_minus_cosine(x: float, u: float) -> float:
    """Return (cosh(u) - 1)/u^2 - (1 - cos(x))/x^2 without cancellation."""
    if max(x, u) > SERIES_BELOW:
        second = 2.0 * square(math.sin(0.5 * x) / x) if x > 0.0 else 0.5
        return 2.0 * square(math.sinh(0.5 * u) / u) - second
    total = 0.0
    px, pu, factorial = 1.0, 1.0, 2.0
    for i in range(1, 11):
        px *= -x * x
        pu *= u * u
        factorial *= (2 * i + 1) * (2 * i + 2)
        total += (pu - px) / factorial
        if abs(px) + pu <= LOST * factorial * abs(total):
            break
    return total


@inner
def linear_state(law: Law, segment: FloatArray, begin: State, h: float) -> tuple[float, float]:
    """Return rotation and rate, h > 0 after a state, of y'' = -k^2 [saddle - y + side factor a].

    The paper's equations (6)-(10) and (17)-(21), corrected, with the terms grouped so that short
    steps lose no digits. With a lead of 3, after a smooth uplift, y'' starts from zero.

    Parameters
    ----------
    law : Law
        A linear one.
    segment : ndarray, shape (7,)
        The ground motion: a row of `motion.SEGMENT_COLUMNS` in units of 1/p and g.
    begin : State
    h : float
    """
    start, _, amplitude, omega, phase, offset, slope = segment
    side, tau, lead, y, v = begin
    k, force = law.k, side * law.factor
    psi = omega * (tau - start) + phase
    sine, cosine = math.sin(psi), math.cos(psi)
    D = law.saddle + force * (offset + slope * (tau - start) + amplitude * sine)
    if lead == 3:
        D = 0.0
    rate = force * slope
    C = force * amplitude * k * k / (k * k + omega * omega)
    u, x = k * h, omega * h
    sinh, cosh_1 = math.sinh(u), 2.0 * square(math.sinh(0.5 * u))
    g3 = sine_minus_sinh(x, u)
    forced = C * x * (x * sine * cosh_minus_cosine(x, u) + cosine * g3)
    end = y * (1.0 + cosh_1) + v / k * sinh - D * cosh_1 + rate * (h - sinh / k) + forced
    shaken = C * omega * (x * sine * g3 + cosine * (2.0 * square(math.sin(0.5 * x)) + cosh_1))
    velocity = k * (y - D) * sinh + v * (1.0 + cosh_1) - rate * cosh_1 - shaken
    return end, velocity


@inner
def work_to(law: Law, y: float) -> float:
    """Return half the squared velocity that a free block loses between rotations 0 and y."""
    if law.linear:
        return 0.5 * law.k * law.k * y * (2.0 * law.saddle - y)
    return 2.0 * math.sin(law.alpha - 0.5 * y) * math.sin(0.5 * y)


@inner
def turning_rotation(law: Law, work: float) -> float:
    """Return the rotation at which a free block has lost `work`; inf if it passes the saddle."""
    barrier = work_to(law, law.saddle)
    if work >= barrier:
        return math.inf
    if law.linear:
        scaled = 2.0 * work / (law.k * law.k)
        return scaled / (law.saddle + math.sqrt(law.saddle * law.saddle - scaled))
    y = law.alpha - 2.0 * math.asin(math.sqrt(0.5 * (barrier - work)))
    # the difference of two angles loses digits when y is small, where Newton's method is safe
    if y < 0.5 * law.alpha:
        for _ in range(3):
            y -= (work_to(law, y) - work) / math.sin(law.alpha - y)
    return y


@inner
def free_peak(law: Law, y: float, v: float) -> float:
    """Return the largest rotation still to come of a free block, inf when it overturns.

    From (y, v) at the end of the ground motion; an inward motion passes through one impact.
    """
    if is_lost(law, y, v):
        return math.inf
    work = 0.5 * v * v + work_to(law, y)
    if v < 0.0:
        work *= law.eta * law.eta
    return turning_rotation(law, work)


@inner
def is_lost(law: Law, y: float, v: float) -> bool:
    """Say whether a free block in the state (y, v) has passed the saddle for good."""
    if y < law.saddle:
        return False
    return v >= 0.0 or 0.5 * v * v + work_to(law, y) <= work_to(law, law.saddle)
