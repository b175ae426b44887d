"""The models: each is a declaration of its onset, saddle, frequency and forcing.

With the rotation folded to one side, y = s theta, s = sign(theta), time in units of 1/p and the
ground acceleration a in units of g, the exact equation of motion is

    y'' = -k^2 [sin(alpha - y) + s a cos(alpha - y)]                (paper, equations 1 and 2)

and each linear model is

    y'' = -k^2 [c - y + s q a]

with its frequency k, saddle c and forcing factor q; k is 1 in the exact one, unless the mass stands
off the middle and p is that of the other side. A block at rest lifts off when abs(a) exceeds
the onset, which is c/q for the linear models. They are derived in EQUATIONS.md,
"From (1) and (2)".
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from analytic.frame import Rocker
from analytic.kernels.law import FloatArray, Law, Laws


@dataclass(frozen=True, slots=True, kw_only=True)
class Model:
    """A model of rocking: functions of the slenderness alpha [rad].

    Beyond the saddle c [rad], by default alpha, the free block overturns; the frequency k is in
    units of p, forcing is q. Unless it is linear the restoring moment is the exact one. The title
    is for figures.
    """

    name: str
    title: str
    linear: bool
    saddle: Callable[[FloatArray], FloatArray] = np.asarray
    frequency: Callable[[FloatArray], FloatArray] = np.ones_like
    forcing: Callable[[FloatArray], FloatArray] = np.ones_like

    def onset(self, alpha: FloatArray) -> FloatArray:
        """Ground acceleration [g] above which a resting block lifts off."""
        if not self.linear:
            return np.tan(alpha)
        return self.saddle(alpha) / self.forcing(alpha)

    def constants(self, alpha: FloatArray) -> tuple[FloatArray, ...]:
        """Return k, saddle, factor, alpha and onset of a `Law` at the slenderness alpha [rad]."""
        k, saddle, factor = self.frequency(alpha), self.saddle(alpha), self.forcing(alpha)
        return k, saddle, factor, alpha, self.onset(alpha)

    def laws(self, block: Rocker) -> Laws:
        """Return the model of a block on its right and on its left side."""
        right, left = (self.law(s.alpha, s.restitution, s.p / block.p) for s in block.sides)
        return right, left

    def law(self, alpha: float, eta: float, faster: float = 1.0) -> Law:
        """Return the model at alpha [rad] and eta, of a side that is `faster` than the block."""
        k, saddle, factor, _, onset = map(float, self.constants(np.array(alpha)))
        return Law(self.linear, faster * k, saddle, factor, alpha, onset, eta)


EXACT = Model(name="exact", title="Exact", linear=False)
HOUSNER = Model(name="housner", title="Housner linearization", linear=True)
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
    forcing=lambda alpha: alpha / np.tan(alpha),
)

MODELS = {model.name: model for model in (EXACT, HOUSNER, MODIFIED, ONSET_MATCHED)}


def find_model(model: str | Model) -> Model:
    """Return the model of a name, or a model as it is; a ValueError lists what there is."""
    if isinstance(model, Model):
        return model
    if model not in MODELS:
        raise ValueError(f"model is {model!r}; it must be one of {', '.join(MODELS)}")
    return MODELS[model]
