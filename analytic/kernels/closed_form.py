"""Closed forms of the kernels: the linear models on a segment, and free rocking.

Symbols and units are those of `analytic.kernels.law`. Free rocking keeps v^2/2 minus `work_to`, and
the energy at y = 0 is multiplied by eta^2 at each impact.
"""

import math

from analytic.kernels.law import FloatArray, Law, Laws, State, law_of

SERIES_BELOW = 1.0
"""Below this argument the two differences of functions are summed from their series."""
LOST = 1e-17
"""Part of a sum below which a term, and the smaller ones after it, change no digit."""


def square(x: float) -> float:
    """Return x^2, as a product: Python's power would round otherwise than a compiled one."""
    return x * x


def sine_minus_sinh(x: float, u: float) -> float:
    """Return sin(x)/x - sinh(u)/u without cancellation."""
    if max(x, u) > SERIES_BELOW:
        first = math.sin(x) / x if x > 0.0 else 1.0
        return first - math.sinh(u) / u
    return difference(x, u, 1)


def cosh_minus_cosine(x: float, u: float) -> float:
    """Return (cosh(u) - 1)/u^2 - (1 - cos(x))/x^2 without cancellation."""
    if max(x, u) > SERIES_BELOW:
        second = 2.0 * square(math.sin(0.5 * x) / x) if x > 0.0 else 0.5
        return 2.0 * square(math.sinh(0.5 * u) / u) - second
    return -difference(x, u, 2)


def difference(x: float, u: float, first: int) -> float:
    """Return the sum of ((-x^2)^i - u^(2 i))/(2 i + first)! from i = 1 on; first is 1 or 2."""
    total = 0.0
    px, pu, factorial = 1.0, 1.0, float(first)
    for i in range(1, 11):
        px *= -x * x
        pu *= u * u
        factorial *= (2 * i + first - 1) * (2 * i + first)
        total += (px - pu) / factorial
        if abs(px) + pu <= LOST * factorial * abs(total):
            break
    return total


def linear_state(law: Law, segment: FloatArray, begin: State, h: float) -> tuple[float, float]:
    """Return rotation and rate, h > 0 after a state, of y'' = -k^2 [saddle - y + side factor a].

    The paper's equations (6)-(10) and (17)-(21), corrected (EQUATIONS.md, "From (1) and (2)", "A
    record"), with the terms grouped so that short steps lose no digits.
    """
    start, _, amplitude, omega, phase, offset, slope = segment
    side, tau, lead, y, v = begin
    k, force = law.k, side * law.factor
    psi = omega * (tau - start) + phase
    sine, cosine = math.sin(psi), math.cos(psi)
    D = law.saddle + force * (offset + slope * (tau - start) + amplitude * sine)
    if lead == 3:
        D = 0.0  # a smooth uplift: y starts from zero to its second derivative
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


def work_to(law: Law, y: float) -> float:
    """Return the work [p^2] from 0 to y: k^2 y (2c - y)/2, or k^2 [cos(alpha - y) - cos(alpha)]."""
    if law.linear:
        return 0.5 * law.k * law.k * y * (2.0 * law.saddle - y)
    return 2.0 * law.k * law.k * math.sin(law.alpha - 0.5 * y) * math.sin(0.5 * y)


def turning_rotation(law: Law, work: float) -> float:
    """Return the rotation at which a free block has lost `work`; inf if it passes the saddle."""
    barrier = work_to(law, law.saddle)
    if work >= barrier:
        return math.inf
    if law.linear:
        scaled = 2.0 * work / (law.k * law.k)
        return scaled / (law.saddle + math.sqrt(law.saddle * law.saddle - scaled))
    stiffness = law.k * law.k
    y = law.alpha - 2.0 * math.asin(math.sqrt(0.5 * (barrier - work) / stiffness))
    # the difference of two angles loses digits when y is small, where Newton's method is safe
    if y < 0.5 * law.alpha:
        for _ in range(3):
            y -= (work_to(law, y) - work) / (stiffness * math.sin(law.alpha - y))
    return y


def free_peaks(laws: Laws, side: float, y: float, v: float) -> tuple[float, float]:
    """Return a free block's peaks, of its next two swings, on its right and left; inf: a fall."""
    law = law_of(laws, side)
    work = 0.5 * v * v + work_to(law, y)
    if is_lost(law, y, v):
        work = math.inf
    elif v < 0.0:
        work, side = work * law.eta * law.eta, -side
    law, other = law_of(laws, side), law_of(laws, -side)
    here = turning_rotation(law, work)
    there = 0.0 if here == math.inf else turning_rotation(other, work * law.eta * law.eta)
    return (there, here) if side < 0.0 else (here, there)


def is_lost(law: Law, y: float, v: float) -> bool:
    """Say whether a free block has passed the saddle, from where a fast one may come back."""
    if y < law.saddle:
        return False
    return v >= 0.0 or 0.5 * v * v + work_to(law, y) <= work_to(law, law.saddle)
