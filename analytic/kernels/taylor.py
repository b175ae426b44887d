"""Taylor series of a step of rocking, and how far it can be trusted.

Symbols and units are those of `analytic.kernels.law`; the method and its error are in EQUATIONS.md,
"How the numbers are computed".
"""

import math
from typing import NamedTuple

from analytic.kernels.law import FloatArray, Law, State
from analytic.kernels.polynomial import ORDER
from analytic.kernels.rest import acceleration

LEAST_ORDER = 6
LONGEST_STEP = 4.0
"""In units of 1/p."""
LINEAR_STEP = 2.5
"""Linear step in units of the shortest time scale; its series is exact to 1e-16."""

TOLERANCE = 1e-16
"""Default truncation error of a step, relative to the rotation it covers."""


class Accuracy(NamedTuple):
    """Degree of the series and truncation error of a step, relative to the rotation it covers."""

    order: int
    tolerance: float


def accuracy(tolerance: float) -> Accuracy:
    """Return the degree that suits a tolerance, at most ORDER.

    The cost is least near 1 - ln(tolerance)/2 (Jorba and Zou 2005, section 3.1); two more degrees
    save steps, which events make dearer than series.
    """
    order = math.ceil(3.0 - 0.5 * math.log(tolerance))
    return Accuracy(min(max(order, LEAST_ORDER), ORDER), tolerance)


def expand_forcing(segment: FloatArray, tau: float, side: float, order: int, f: FloatArray) -> None:
    """Write the series of f, side x ground acceleration [g], into f[0..order]."""
    start, _, amplitude, omega, phase, offset, slope = segment[:7]
    angle = omega * (tau - start) + phase
    f[0] = side * amplitude * math.sin(angle)
    f[1] = side * amplitude * omega * math.cos(angle)
    square = omega * omega
    for i in range(2, order + 1):
        f[i] = -square * (1.0 / i) * (1.0 / (i - 1)) * f[i - 2]
    f[0] += side * (offset + slope * (tau - start))
    f[1] += side * slope


def expand_weight(segment: FloatArray, tau: float, order: int, weight: FloatArray) -> None:
    """Write the series of the weight over m g, 1 where the base does not move vertically."""
    if len(segment) > 7:
        expand_forcing(segment[7:], tau, 1.0, order, weight)
        weight[0] += 1.0


def expand_exact(law: Law, order: int, work: FloatArray, heavy: bool) -> None:
    """Extend the series of y by y'' = -k^2 [w sin z + f cos z]; w is 1 unless it is `heavy`."""
    stiffness = law.k * law.k
    y, f, sine, cosine, rate = work[0], work[1], work[2], work[3], work[4]
    sine[0] = math.sin(law.alpha - y[0])
    cosine[0] = math.cos(law.alpha - y[0])
    for i in range(order - 1):
        # three sums at a time, of the forcing now and of the next sine and cosine, and the terms
        # that were known last at the end: else every addition would wait for the one before
        rate[i + 1] = (i + 1) * y[i + 1]
        forced = s = c = 0.0
        for j in range(1, i):
            forced += f[j] * cosine[i - j]
            s += rate[j + 1] * cosine[i - j]
            c += rate[j + 1] * sine[i - j]
        if i > 0:
            s += rate[1] * cosine[i]
            c += rate[1] * sine[i]
            forced += f[i] * cosine[0]
            weighed = sine[i]
            if heavy:
                weighed *= work[-1][0]
                for j in range(1, i + 1):
                    weighed += work[-1][j] * sine[i - j]
            pull = weighed + (forced + f[0] * cosine[i])
            y[i + 2] = -stiffness * pull * (1.0 / (i + 1)) * (1.0 / (i + 2))
        sine[i + 1] = -(s + rate[i + 1] * cosine[0]) * (1.0 / (i + 1))
        cosine[i + 1] = (c + rate[i + 1] * sine[0]) * (1.0 / (i + 1))


def expand_linear(law: Law, order: int, f: FloatArray, y: FloatArray) -> None:
    """Extend a series by a linear model, y'' = -k^2 [saddle - y + q f]."""
    for i in range(1, order - 1):
        y[i + 2] = law.k * law.k * (y[i] - law.factor * f[i]) * (1.0 / (i + 1)) * (1.0 / (i + 2))


def logarithm(x: float) -> float:
    """Return ln(x), of zero, too."""
    return math.log(x) if x != 0.0 else -math.inf


def trusted_step(y: FloatArray, accuracy: Accuracy) -> float:
    """Return the step [1/p] over which a series is accurate (Jorba and Zou 2005, section 3.2)."""
    order, tolerance = accuracy
    last, before = logarithm(abs(y[order]) / tolerance), logarithm(abs(y[order - 1]) / tolerance)
    h = 1.0
    for _ in range(2):
        size = logarithm(max(max(abs(y[0]), abs(y[1]) * h), max(abs(y[2]), abs(y[3]) * h) * h * h))
        h = min(LONGEST_STEP, math.exp(min((size - last) / order, (size - before) / (order - 1))))
    return h


def expand(
    law: Law, accuracy: Accuracy, segment: FloatArray, begin: State, work: FloatArray
) -> float:
    """Fill work[0] with the series of y from a state; return the step [1/p] it allows."""
    y, f = work[0], work[1]
    y[0], y[1] = begin.y, begin.v
    expand_forcing(segment, begin.tau, begin.side, accuracy.order, f)
    expand_weight(segment, begin.tau, accuracy.order, work[-1])
    y[2] = 0.5 * acceleration(law, 1.0, f[0], y[0], work[-1][0]) if begin.lead < 3 else 0.0
    if law.linear:
        expand_linear(law, accuracy.order, f, y)
        return LINEAR_STEP / max(law.k, segment[3])
    expand_exact(law, accuracy.order, work, len(segment) > 7)
    return trusted_step(y, accuracy)
