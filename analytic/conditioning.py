"""How far small errors move a peak: condition numbers, and what errors of a finite size do.

Condition numbers are differences over a move so small that hardly an uplift comes or goes within
it. So near the onset, and near overturning, `sensitivity` moves the peak by more.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.cases import housner_restitutions, peak_ratios
from analytic.frame import Rocker
from analytic.kernels.excursions import MARCH, workspace
from analytic.kernels.law import Notes
from analytic.kernels.taylor import TOLERANCE, accuracy
from analytic.models import Model
from analytic.motion import FloatArray, Motion
from analytic.response import Outcome
from analytic.simulate import OUTCOMES
from analytic.start import REST, pose

MOVES = (-1e-3, 1e-3, -1e-4, 1e-4, -1e-6, 1e-6)
"""Relative changes of the motion's scale, and of eta, that a `sensitivity` is found with."""
NUDGE = 3e-7
"""Relative change of a condition number's difference."""

Solve = Callable[[float, float], tuple[Any, Any]]
"""Peak and outcome by the scales of motion and eta."""


class Conditioning(NamedTuple):
    """d ln(peak)/d ln(a_p) and d ln(peak)/d ln(eta), nan unless the block rocks and survives."""

    amplitude: FloatArray
    restitution: FloatArray


def condition_numbers(*cases: Any, **options: Any) -> Conditioning:
    """Return the condition numbers of the peaks that `peak_ratios` returns, given the same.

    Examples
    --------
    >>> kappa, kappa_eta = condition_numbers(0.32, [0.4, 0.5], 2.0, 2)
    >>> kappa.round(3)
    array([26.363,    nan])
    """
    return Conditioning(*_slopes(_many(*cases, **options)))


def conditioning(
    block: Rocker, motion: Motion, model: str | Model = "exact", start: tuple[float, float] = REST
) -> tuple[float, float]:
    """Return both condition numbers of one peak, nan where the block does not rock and survive.

    The arguments, and their errors, are those of `simulate`; the start is the same for all scales.

    Examples
    --------
    >>> block = RigidBlock(width=0.5, height=1.5)
    >>> pulse = SinePulse.in_g(0.4, omega=6.2832, half_cycles=2)
    >>> [round(kappa, 3) for kappa in conditioning(block, pulse)]
    [26.603, 1.823]
    """
    by_amplitude, by_eta = _slopes(scaled(block, motion, model, start))
    return float(by_amplitude), float(by_eta)


def sensitivities(*cases: Any, **options: Any) -> FloatArray:
    """Return how far the peaks that `peak_ratios` returns, given the same, move with finite errors.

    Returns
    -------
    ndarray
        The largest abs(peak/peak_0 - 1)/abs(move), over the `MOVES` of a_p and of eta, which stays
        at most 1; inf where a move changes the outcome, 0 where the block overturns or stays at
        rest with all of them, nan where a solution fails.

    Examples
    --------
    >>> sensitivities(0.32, [0.4, 0.5], 2.0, 2).round(2)
    array([26.66,  0.  ])
    """
    return _largest_move(_many(*cases, **options))


def sensitivity(
    block: Rocker, motion: Motion, model: str | Model = "exact", start: tuple[float, float] = REST
) -> float:
    """Return what `sensitivities` does, of one peak; the arguments are those of `conditioning`.

    Examples
    --------
    >>> block = RigidBlock(width=0.5, height=1.5)
    >>> pulse = SinePulse.in_g(0.4, omega=6.2832, half_cycles=2)
    >>> round(sensitivity(block, pulse), 2)
    26.76
    """
    return float(_largest_move(scaled(block, motion, model, start)))


def scaled(
    block: Rocker, motion: Motion, model: str | Model = "exact", start: tuple[float, float] = REST
) -> Callable[[float, float], tuple[float, Outcome]]:
    """Return what solves a response, given factors of its motion, both ways, and of eta."""
    posed = pose(block, motion, model, start)
    moving = posed.then_still(posed.segments[-1, 1])
    steps, exactly = posed.steps, accuracy(TOLERANCE)
    broken = not np.all(np.isfinite(posed.segments))
    notes = Notes(np.empty(0), np.empty((2, 0)), np.empty((0, 4)), np.empty(0))

    def solve(stronger: float, livelier: float) -> tuple[float, Outcome]:
        if broken:
            return math.nan, Outcome.FAILED
        harder = moving * np.resize([1, 1, stronger, 1, 1, stronger, stronger], moving.shape[1])
        right, left = (
            law._replace(eta=min(livelier * law.eta, max(law.eta, 1.0))) for law in posed.laws
        )
        march = MARCH.few(1, steps)
        found, *peaks = march((right, left), exactly, harder, posed.start, 0.0, notes, workspace())
        return max(peaks[0] / right.alpha, peaks[1] / left.alpha), OUTCOMES[found]

    return solve


def _many(
    alpha: ArrayLike,
    amplitude_g: ArrayLike,
    omega_over_p: ArrayLike,
    half_cycles: ArrayLike,
    model: str | Model = "exact",
    restitution: ArrayLike | None = None,
) -> Solve:
    eta = housner_restitutions(alpha) if restitution is None else np.asarray(restitution, float)

    def solve(stronger: float, livelier: float) -> tuple[FloatArray, NDArray[np.object_]]:
        scaled = stronger * np.asarray(amplitude_g, float)
        moved = np.fmin(livelier * eta, 1.0)
        return peak_ratios(alpha, scaled, omega_over_p, half_cycles, model, moved)

    return solve


def _slopes(solve: Solve) -> tuple[FloatArray, FloatArray]:
    """Return the condition numbers: by a central difference, and one towards a smaller eta."""
    still, outcome = solve(1.0, 1.0)
    high, low = solve(1.0 + NUDGE, 1.0)[0], solve(1.0 - NUDGE, 1.0)[0]
    near, far = solve(1.0, 1.0 - NUDGE)[0], solve(1.0, 1.0 - 2.0 * NUDGE)[0]
    with np.errstate(all="ignore"):
        by_amplitude = np.subtract(high, low) / still
        by_eta = (3.0 * np.subtract(still, near) - np.subtract(near, far)) / still
        found = (np.where(outcome == Outcome.ROCKED, it, math.nan) for it in (by_amplitude, by_eta))
        return tuple(each / (2.0 * NUDGE) for each in found)  # type: ignore[return-value]


def _largest_move(solve: Solve) -> FloatArray:
    still, outcome = solve(1.0, 1.0)
    largest = np.zeros(np.shape(still))
    for move in MOVES:
        for scales in ((1.0 + move, 1.0), (1.0, 1.0 + move)):
            peak, other = solve(*scales)
            with np.errstate(all="ignore"):
                change = np.abs(np.divide(peak, still) - 1.0) / abs(move)
            change = np.where(outcome == Outcome.ROCKED, change, 0.0)
            change = np.where(other == outcome, change, math.inf)
            failed = (outcome == Outcome.FAILED) | (other == Outcome.FAILED)
            largest = np.maximum(largest, np.where(failed, math.nan, change))
    return largest
