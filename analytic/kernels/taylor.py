"""Taylor series of a step of rocking, and how far it can be trusted.

The rotation is folded to one side, y = s theta > 0; time is in units of 1/p, acceleration in g.
"""

import math
from typing import NamedTuple

from analytic.kernels.compiled import kernel
from analytic.kernels.law import FloatArray, Law
from analytic.kernels.polynomial import ORDER

LEAST_ORDER = 6
LONGEST_STEP = 4.0
"""In units of 1/p."""

TOLERANCE = 1e-16
"""Default truncation error of a step, relative to the rotation it covers."""


class Accuracy(NamedTuple):
    """Degree of the series and truncation error of a step, relative to the rotation it covers."""

    order: int
    tolerance: float


def accuracy(tolerance: float) -> Accuracy:
    """Return the degree that suits a tolerance, at most ORDER.

    Where the series of a step converges by e^-2 a term, the cost of a solution to a tolerance is
    least near the degree 1 - ln(tolerance)/2 (Jorba and Zou 2005, section 3.1); two more save
    steps, which events make dearer than series.
    """
    order = math.ceil(3.0 - 0.5 * math.log(tolerance))
    return Accuracy(min(max(order, LEAST_ORDER), ORDER), tolerance)


@kernel
def expand_forcing(segment: FloatArray, tau: float, side: float, order: int, f: FloatArray) -> None:
    """Write the Taylor coefficients at `tau` of side x ground acceleration into f[0..order].

    `segment` is a row of `motion.SEGMENT_COLUMNS`, in units of 1/p and g.
    """
    start, _, amplitude, omega, phase, offset, slope = segment
    angle = omega * (tau - start) + phase
    f[0] = side * amplitude * math.sin(angle)
    f[1] = side * amplitude * omega * math.cos(angle)
    for i in range(2, order + 1):
        f[i] = -omega * omega * f[i - 2] / (i * (i - 1))
    f[0] += side * (offset + slope * (tau - start))
    f[1] += side * slope


@kernel
def expand_exact(
    law: Law, order: int, f: FloatArray, y: FloatArray, sine: FloatArray, cosine: FloatArray
) -> None:
    """Extend the series y[0], y[1], y[2] by the exact equation, y'' = -[sin z + f cos z].

    Parameters
    ----------
    law : Law
        Of which alpha is used: z = alpha - y.
    order : int
        Degree of the series.
    f : ndarray, shape (>= order + 1,)
        Taylor coefficients of side x ground acceleration [g].
    y : ndarray, shape (>= order + 1,)
        Filled from index 3 on.
    sine, cosine : ndarray, shape (>= order + 1,)
        Workspace: the series of sin z and cos z.
    """
    sine[0] = math.sin(law.alpha - y[0])
    cosine[0] = math.cos(law.alpha - y[0])
    for i in range(1, order - 1):
        s = c = forced = 0.0
        for j in range(1, i + 1):
            rate = j * y[j]
            s -= rate * cosine[i - j]
            c += rate * sine[i - j]
        sine[i] = s / i
        cosine[i] = c / i
        for j in range(i + 1):
            forced += f[j] * cosine[i - j]
        y[i + 2] = -(sine[i] + forced) / ((i + 1) * (i + 2))


@kernel
def expand_linear(law: Law, order: int, f: FloatArray, y: FloatArray) -> None:
    """Extend the series y[0], y[1], y[2] by a linear model, y'' = -k^2 [saddle - y + q f]."""
    for i in range(1, order - 1):
        y[i + 2] = law.k * law.k * (y[i] - law.factor * f[i]) / ((i + 1) * (i + 2))


@kernel
def trusted_step(y: FloatArray, accuracy: Accuracy) -> float:
    """Return the step over which the series y is accurate.

    The last two terms are held below the tolerance times the largest of the first four, which for
    a step out of a rest is the cubic one (after Jorba and Zou 2005, section 3.2).
    """
    order, tolerance = accuracy
    h = 1.0
    for _ in range(2):
        size = max(max(abs(y[0]), abs(y[1]) * h), max(abs(y[2]), abs(y[3]) * h) * h * h)
        last = abs(y[order]) / size
        before = abs(y[order - 1]) / size
        bound = LONGEST_STEP
        if last > 0.0:
            bound = min(bound, (tolerance / last) ** (1.0 / order))
        if before > 0.0:
            bound = min(bound, (tolerance / before) ** (1.0 / (order - 1)))
        h = bound
    return h
