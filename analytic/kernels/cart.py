"""Taylor series of a block that rocks on a cart, in units of 1/p and g.

With z = alpha - y, kappa = 3/4 m/(m + M), w^2 the stiffness, f the push, x the place of the cart:

    y'' = -[sin z + s x'' cos z],    x'' = f - w^2 x - kappa s [y'' cos z + y'^2 sin z].
"""

import math
from typing import NamedTuple

from analytic.kernels.compiled import inner
from analytic.kernels.law import FloatArray


class Coupling(NamedTuple):
    """alpha [rad], kappa and w^2."""

    alpha: float
    kappa: float
    stiffness: float


@inner
def expand_cart(
    cart: Coupling, side: float, smooth: bool, order: int, f: FloatArray, work: FloatArray
) -> None:
    """Extend the series of y and x, whose first two coefficients are known, in work[0], work[1].

    A smooth uplift starts with y'' = 0, whatever the rounding. f is the series of the push;
    work[2:7] are spare.
    """
    y, x, sine, cosine = work[0], work[1], work[2], work[3]
    turning, moving, square = work[4], work[5], work[6]
    sine[0], cosine[0] = math.sin(cart.alpha - y[0]), math.cos(cart.alpha - y[0])
    pull = 1.0 - cart.kappa * cosine[0] * cosine[0]
    for n in range(order - 1):
        if n > 0:
            s = c = 0.0
            for i in range(n):
                s -= (i + 1) * y[i + 1] * cosine[n - 1 - i]
                c += (i + 1) * y[i + 1] * sine[n - 1 - i]
            sine[n], cosine[n] = s / n, c / n
        square[n] = 0.0
        for i in range(n + 1):
            square[n] += (i + 1) * y[i + 1] * (n - i + 1) * y[n - i + 1]
        turned, pushed = -sine[n], 0.0
        for i in range(n):
            turned -= side * moving[i] * cosine[n - i]
            pushed += cosine[n - i] * turning[i]
        for i in range(n + 1):
            pushed += sine[i] * square[n - i]
        pushed = f[n] - cart.stiffness * x[n] - cart.kappa * side * pushed
        turning[n] = (turned - side * cosine[0] * pushed) / pull
        if n == 0 and smooth:
            turning[0] = 0.0
        moving[n] = pushed - cart.kappa * side * cosine[0] * turning[n]
        y[n + 2] = turning[n] / ((n + 1) * (n + 2))
        x[n + 2] = moving[n] / ((n + 1) * (n + 2))


@inner
def expand_rest(
    stiffness: float, order: int, f: FloatArray, x: FloatArray, moving: FloatArray
) -> None:
    """Extend the series of x while the block stands, and write that of x''."""
    for n in range(order - 1):
        moving[n] = f[n] - stiffness * x[n]
        x[n + 2] = moving[n] / ((n + 1) * (n + 2))
