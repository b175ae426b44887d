"""Outcomes and modes of many responses to pulses: what an overturning map is made of."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.cases import solve_cases
from analytic.kernels.excursions import AT_REST, LYING, OVERTURNED
from analytic.models import Model, find_model
from analytic.motion import FloatArray

NOT_LIFTED, SURVIVES, FAILED = -2, -1, -3
"""Modes that are no number of impacts."""

NO_PEAK = 0.999 * LYING
"""No peak is looked for below this rotation [rad], from which on a fall is."""


class Modes(NamedTuple):
    """What happens to each case of a map, in the broadcast shape.

    Attributes
    ----------
    mode : ndarray of int32
        The number of impacts before the block overturns, or SURVIVES, NOT_LIFTED, FAILED.
    margin : ndarray
        The distance from overturning, positive when overturned; -1 at rest. When the pulse ends
        the larger of two velocities, over that which just overturns a block from its base: the
        excess over the separatrix here, and after the next impact. It changes continuously with
        the amplitude, whatever the number of impacts, but where the side of a block touches the
        ground; inf when a block lies on its side before the pulse ends.
    steps : ndarray of int32
        Steps of the solution.
    """

    mode: NDArray[np.int32]
    margin: FloatArray
    steps: NDArray[np.int32]


def overturning_modes(
    alpha: ArrayLike,
    amplitude_g: ArrayLike,
    omega_over_p: ArrayLike,
    half_cycles: ArrayLike,
    model: str | Model = "exact",
    restitution: ArrayLike | None = None,
    threads: int | None = None,
) -> Modes:
    """Find whether and how the pulses of `peak_ratios` overturn blocks, on all cores.

    Beside the inputs, broadcast a part at a time, and the results no memory is needed.

    Examples
    --------
    >>> overturning_modes(0.32, [0.4, 0.9, 2.0], 2.0, 1).mode
    array([-1,  0,  0], dtype=int32)
    """
    linear = find_model(model).linear

    def take(
        cases: FloatArray, constants: FloatArray, ends: FloatArray, *written: NDArray[Any]
    ) -> None:
        mode, margin, steps = written
        outcome, _, steps[:], impacts, _, time, y, v = ends
        alpha, _, omega, half_cycles, eta = cases
        k, saddle, *_ = constants
        # as `closed_form.work_to`, and the separatrix v = k (c - y) or v = 2 sin((alpha - y)/2)
        if linear:
            work = 0.5 * k * k * y * (2.0 * saddle - y)
            excess, barrier = k * (y - saddle), k * saddle
        else:
            work = 2.0 * np.sin(alpha - 0.5 * y) * np.sin(0.5 * y)
            excess, barrier = 2.0 * np.sin(0.5 * (y - alpha)), 2.0 * np.sin(0.5 * alpha)
        here = v + excess
        after = eta * np.sqrt(np.maximum(v * v + 2.0 * work, 0.0)) - barrier
        struck, lies = (v < 0.0) & (after > 0.0), time < half_cycles * np.pi / omega
        best = np.where(struck, after, np.maximum(here, np.minimum(after, 0.0)))
        margin[:] = np.where(here > 0.0, here, best) / barrier
        margin[lies] = np.inf
        falls = [lies | (here > 0.0), struck, outcome == AT_REST]
        mode[:] = np.select(falls, [impacts, impacts + 1, NOT_LIFTED], SURVIVES)
        failed = np.isnan(margin) | (outcome > OVERTURNED)
        mode[failed], margin[failed] = FAILED, np.nan

    given = (alpha, amplitude_g, omega_over_p, half_cycles)
    kinds = (np.int32, np.float64, np.int32)
    return Modes(*solve_cases(given, model, restitution, threads, kinds, take, NO_PEAK))
