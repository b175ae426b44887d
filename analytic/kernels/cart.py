"""Taylor series of a block that rocks on a cart (EQUATIONS.md, "The block on a cart").

With z = alpha - y, kappa = 3/4 m/(m + M), w^2 = k/((m + M) p^2), f the push [g] and x the place of
the cart [g/p^2]; otherwise as in `analytic.kernels.law`:

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
    """Extend the series of y and x, whose first two coefficients are known.

    Parameters
    ----------
    cart : Coupling
    side : float, s
    smooth : bool, whether y'' starts from zero, as after a smooth uplift, whatever the rounding
    order : int, degree of the series
    f : ndarray (>= order - 1,), series of the push
    work : ndarray (>= 7, >= order + 1), series of y and x; those of sin z, cos z, y'', x'' and y'^2
        are written below them
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
    """Extend the series of x while the block stands, x'' = f - w^2 x, and write that of x''.

    Parameters
    ----------
    stiffness : float, w^2
    order : int, degree of the series
    f : ndarray (>= order - 1,), series of the push
    x : ndarray (>= order + 1,), of which the first two coefficients are known
    moving : ndarray (>= order - 1,), to be written: the series of x''
    """
    for n in range(order - 1):
        moving[n] = f[n] - stiffness * x[n]
        x[n + 2] = moving[n] / ((n + 1) * (n + 2))
