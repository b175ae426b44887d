"""Which published cases a coefficient of friction is too low for."""

import functools

import numpy as np
from numpy.typing import NDArray

from analytic import simulate
from studies.cases.paper import SWEEPS, sweep_cases


@functools.cache
def needed() -> NDArray[np.float64]:
    """Return the friction that the exact solution needs in each of the paper's cases."""
    return np.array([simulate(c.block, c.motion).friction_needed for c in sweep_cases(SWEEPS)])


def too_slippery(friction: float | None) -> str:
    """Say in how many of the paper's cases the exact solution needs more friction, or nothing."""
    if friction is None:
        return ""
    short = int((needed() > friction).sum())
    if not short:
        return ""
    return (
        f"With friction {friction:g} a block slides in {short} of the paper's {needed().size} "
        f"cases, which need up to {needed().max():.3g}; what was published was measured with the "
        "presets' own friction."
    )
