"""How far small errors move a peak: condition numbers, and what errors of a finite size do.

A derivative (`analytic.kernels.derivatives`) sees no uplift that comes or goes beside it. So near
the onset, and near overturning, the peak is solved again with both moved by a little.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.block import Rocker
from analytic.cases import housner_restitutions, law_of, pose, write_pulse
from analytic.kernels.compiled import form_for, kernel, listed
from analytic.kernels.derivatives import AMPLITUDE, RESTITUTION, condition
from analytic.kernels.excursions import march, workspace
from analytic.kernels.law import UPRIGHT
from analytic.kernels.notes import Notes
from analytic.kernels.taylor import TOLERANCE, Accuracy, accuracy
from analytic.models import Model, find_model
from analytic.motion import FloatArray, Motion
from analytic.response import Outcome
from analytic.simulate import OUTCOMES, peak_ratios, scaled_segments
from analytic.start import REST, folded

MOVES = (-1e-4, 1e-4, -1e-6, 1e-6)
"""Relative changes of the motion's scale, and of eta, that a `sensitivity` is found with."""


class Conditioning(NamedTuple):
    """Condition numbers of a peak; nan where the block does not rock and survive.

    amplitude is d ln(peak)/d ln(a_p), a_p being the scale of the ground motion; restitution is d
    ln(peak)/d ln(eta).
    """

    amplitude: FloatArray
    restitution: FloatArray


def condition_numbers(
    alpha: ArrayLike,
    amplitude_g: ArrayLike,
    omega_over_p: ArrayLike,
    half_cycles: ArrayLike,
    model: str | Model = "exact",
    restitution: ArrayLike | None = None,
) -> Conditioning:
    """Return the condition numbers of the peaks that `peak_ratios` returns.

    Parameters and errors are those of `peak_ratios`; the arrays have the broadcast shape.

    Examples
    --------
    >>> kappa, kappa_eta = condition_numbers(0.32, [0.4, 0.5], 2.0, 2)
    >>> kappa.round(3)
    array([26.363,    nan])
    """
    cases = pose(alpha, amplitude_g, omega_over_p, half_cycles, model, restitution)
    exactly = accuracy(TOLERANCE)
    by_amplitude, by_eta = np.empty(cases.size), np.empty(cases.size)
    solver = form_for(cases.size, condition_pulses)

    def solve(part: slice, linear: bool, constants: FloatArray, given: FloatArray) -> None:
        solver(linear, exactly, constants, given, by_amplitude[part], by_eta[part])

    cases.solve(solve)
    return Conditioning(by_amplitude.reshape(cases.shape), by_eta.reshape(cases.shape))


def conditioning(
    block: Rocker,
    motion: Motion,
    model: str | Model = "exact",
    start: tuple[float, float] = REST,
) -> tuple[float, float]:
    """Return the condition numbers of one peak: by the logarithms of the motion's scale and eta.

    See EQUATIONS.md, "Condition numbers".

    Parameters
    ----------
    block, motion, model, start
        As for `simulate`, with its errors; the start is the same for all scales.

    Returns
    -------
    by_amplitude, by_eta : float
        nan where the block does not rock and survive.

    Examples
    --------
    >>> block = RigidBlock(width=0.5, height=1.5)
    >>> pulse = SinePulse.in_g(0.4, omega=6.2832, half_cycles=2)
    >>> [round(kappa, 3) for kappa in conditioning(block, pulse)]
    [26.603, 1.823]
    """
    law = find_model(model).law(block.alpha, block.restitution)
    begin, segments = folded(block, law, motion, start), scaled_segments(block, motion)
    found = condition(law, accuracy(TOLERANCE), segments, begin, workspace())
    return float(found[AMPLITUDE]), float(found[RESTITUTION])


def sensitivities(
    alpha: ArrayLike,
    amplitude_g: ArrayLike,
    omega_over_p: ArrayLike,
    half_cycles: ArrayLike,
    model: str | Model = "exact",
    restitution: ArrayLike | None = None,
) -> FloatArray:
    """Return how far the peaks that `peak_ratios` returns move with small, but finite errors.

    Parameters and errors are those of `peak_ratios`.

    Returns
    -------
    ndarray
        The largest abs(peak/peak_0 - 1)/abs(move) in the broadcast shape, over the `MOVES` of a_p
        and of eta, which stays at most 1; inf where a move changes the outcome, 0 where the block
        overturns or stays at rest with all of them, nan where a solution fails.

    Examples
    --------
    >>> sensitivities(0.32, [0.4, 0.5], 2.0, 2).round(2)
    array([26.39,  0.  ])
    """
    eta = housner_restitutions(alpha) if restitution is None else np.asarray(restitution, float)

    def solve(stronger: float, livelier: float) -> tuple[FloatArray, NDArray[np.object_]]:
        scaled = stronger * np.asarray(amplitude_g, float)
        return peak_ratios(
            alpha, scaled, omega_over_p, half_cycles, model, np.fmin(livelier * eta, 1.0)
        )

    return _largest_move(solve)


def sensitivity(
    block: Rocker,
    motion: Motion,
    model: str | Model = "exact",
    start: tuple[float, float] = REST,
) -> float:
    """Return what `sensitivities` does, of one peak.

    Parameters
    ----------
    block, motion, model, start
        As for `simulate`, with its errors; the start is the same for all moves.

    Examples
    --------
    >>> block = RigidBlock(width=0.5, height=1.5)
    >>> pulse = SinePulse.in_g(0.4, omega=6.2832, half_cycles=2)
    >>> round(sensitivity(block, pulse), 2)
    26.62
    """
    return float(_largest_move(scaled(block, motion, model, start)))


def scaled(
    block: Rocker,
    motion: Motion,
    model: str | Model = "exact",
    start: tuple[float, float] = REST,
) -> Callable[[float, float], tuple[float, Outcome]]:
    """Return what solves one response with its motion and eta multiplied.

    Parameters
    ----------
    block, motion, model, start
        As for `simulate`, with its errors; the start is the same for all scales.

    Returns
    -------
    callable
        Given both factors, it returns the largest rotation [rad] and the outcome; eta stays at most
        1. It writes nothing else down and may be called from several threads.
    """
    law = find_model(model).law(block.alpha, block.restitution)
    begin, segments = folded(block, law, motion, start), scaled_segments(block, motion)
    notes = Notes(np.empty(0), np.empty((2, 0)), np.empty((0, 4)), np.empty(0))

    def solve(stronger: float, livelier: float) -> tuple[float, Outcome]:
        harder = segments * np.array([1.0, 1.0, stronger, 1.0, 1.0, stronger, stronger])
        moved = law._replace(eta=min(livelier * law.eta, 1.0))
        end = march(moved, accuracy(TOLERANCE), harder, begin, 0.0, notes, workspace())
        return end.peak, OUTCOMES[end.outcome]

    return solve


def _largest_move(solve: Callable[[float, float], tuple[Any, Any]]) -> FloatArray:
    """Return a sensitivity from what gives peak and outcome by the scales of motion and eta."""
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


@kernel
def condition_pulses(
    linear: bool,
    exactly: Accuracy,
    constants: FloatArray,
    cases: FloatArray,
    by_amplitude: FloatArray,
    by_eta: FloatArray,
) -> None:
    """Write the condition numbers of each case, one a column.

    linear, constants and cases are those of `analytic.cases.SolvePart`; the last arrays, (n,), are
    written.
    """
    given, held, work = listed(cases), listed(constants), workspace()
    segments = np.zeros((1, 7))
    for i in range(len(given[0])):
        law = law_of(linear, held, given, i)
        write_pulse(given, i, segments[0])
        by_amplitude[i], by_eta[i] = condition(law, exactly, segments, UPRIGHT, work)
