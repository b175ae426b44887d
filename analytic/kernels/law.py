"""What a compiled kernel is told of a model, and the arrays that it works on."""

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
