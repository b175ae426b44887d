"""The models: each is a declaration of its onset, saddle, frequency and forcing.

With the rotation folded to one side, y = s theta, s = sign(theta), time in units of 1/p and the
ground acceleration a in units of g, the exact equation of motion is

    y'' = -[sin(alpha - y) + s a cos(alpha - y)]                    (paper, equations 1 and 2)

and each linear model is

    y'' = -k^2 [c - y + s q a]

with its frequency k, saddle c and forcing factor q. A block at rest lifts off when abs(a) exceeds
the onset, which is c/q for the linear models.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


def _one(alpha: FloatArray) -> FloatArray:
    return np.ones_like(alpha)


def _same(alpha: FloatArray) -> FloatArray:
    return alpha


@dataclass(frozen=True, slots=True, kw_only=True)
class Model:
    """A model of rocking: functions of the slenderness alpha [rad].

    Attributes
    ----------
    name : str
        As used in `simulate` and on the command line.
    title : str
        As used in figures.
    linear : bool
        Whether the restoring moment is linear in theta; else it is the exact one.
    saddle : callable
        The rotation c [rad] of unstable equilibrium; beyond it the free block overturns.
    frequency : callable
        k, in units of p.
    forcing : callable
        q, the factor on the ground acceleration.
    """

    name: str
    title: str
    linear: bool
    saddle: Callable[[FloatArray], FloatArray]
    frequency: Callable[[FloatArray], FloatArray] = _one
    forcing: Callable[[FloatArray], FloatArray] = _one

    def constants(self, alpha: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return frequency, saddle and forcing factor at the slenderness alpha [rad]."""
        return self.frequency(alpha), self.saddle(alpha), self.forcing(alpha)

    def onset(self, alpha: FloatArray) -> FloatArray:
        """Ground acceleration [g] above which a resting block lifts off."""
        if not self.linear:
            return np.tan(alpha)
        return self.saddle(alpha) / self.forcing(alpha)


EXACT = Model(name="exact", title="Exact", linear=False, saddle=_same)

HOUSNER = Model(name="housner", title="Housner linearization", linear=True, saddle=_same)

MODIFIED = Model(
    name="modified",
    title="Modified linearization",
    linear=True,
    saddle=np.tan,
    frequency=lambda alpha: np.sqrt(np.cos(alpha)),
)

ONSET_MATCHED = Model(
    name="onset-matched",
    title="Housner, onset matched",
    linear=True,
    saddle=_same,
    forcing=lambda alpha: alpha / np.tan(alpha),
)

MODELS = {model.name: model for model in (EXACT, HOUSNER, MODIFIED, ONSET_MATCHED)}


def find_model(name: str) -> Model:
    """Return the model called `name`; raise ValueError with the allowed names otherwise."""
    try:
        return MODELS[name]
    except KeyError:
        raise ValueError(f"model is {name!r}; it must be one of {', '.join(MODELS)}") from None
