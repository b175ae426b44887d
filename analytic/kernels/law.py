"""What a compiled kernel is told of a model, and the arrays that it works on.

In all kernels the rotation is folded to the side s = sign(theta) on which the block stands, -1 or
1, so that y = s theta > 0. With z = alpha - y and the ground acceleration a (EQUATIONS.md,
"From (1) and (2)"; names as in `analytic.models`),

    y'' = -[sin z + s a cos z],    of a linear model  y'' = -k^2 [c - y + s q a].

Units are those of p and g: rotations in rad, times (tau, h) in 1/p, the rate v of y in rad p,
energies ("work") v^2/2 in p^2, accelerations a and f = s a in g. A segment, shape (7,), is a row
of `motion.SEGMENT_COLUMNS` in them: start, end [1/p], amplitude [g], omega [p], phase [rad], offset
[g], slope [g p]. A ground motion is segments, shape (m, 7), of which j is the number of one. A
series is an array of coefficients c[i] of sum c[i] t^i.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


class Law(NamedTuple):
    """A model at one slenderness, as the compiled kernels take it.

    linear, k, saddle and factor are those of `analytic.models`, factor being q; alpha is the
    slenderness [rad], onset the acceleration [g] that lifts the block, eta the velocity ratio at
    impacts.
    """

    linear: bool
    k: float
    saddle: float
    factor: float
    alpha: float
    onset: float
    eta: float


class Start(NamedTuple):
    """A start as the kernels take it: the side that the block is on, y = s theta, and its rate.

    The side is 0 at rest. Upright but turning, a block is on the side that it turns to; there is
    no impact. Time is in units of 1/p.
    """

    side: float
    y: float
    v: float


class State(NamedTuple):
    """Where a block is: its side, +1 or -1, the time, rotation y = s theta and its rate.

    lead is the power of time with which the rotation grows from there: 1 out of an impact, 2 or 3
    out of an uplift (`rest.next_uplift`), 0 where it does not start from zero.
    """

    side: float
    tau: float
    lead: int
    y: float
    v: float


UPRIGHT = Start(0.0, 0.0, 0.0)
"""A block at rest on its base."""
