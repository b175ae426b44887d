"""How far small errors move a peak: condition numbers, and what errors of a finite size do.

The derivatives of a response by ln(a_p) and by ln(eta) obey the equation of motion linearized
about it. They start from zero, and again at each uplift, where the block is at rest, jump with the
velocity at each impact, whose time moves too, and end in the derivative of the peak.

A derivative sees no uplift that comes or goes beside it. So near the onset, and near overturning,
the peak is solved again with both moved by a little.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.block import Rocker
from analytic.cases import housner_restitutions, law_of, pose, write_pulse
from analytic.kernels.closed_form import free_peak, work_to
from analytic.kernels.compiled import form_for, inner, kernel, listed, maker
from analytic.kernels.excursions import (
    RESTED,
    ROCKED,
    START,
    UPLIFT,
    Notes,
    expand,
    march,
    workspace,
)
from analytic.kernels.law import UPRIGHT, Law, Start, State
from analytic.kernels.polynomial import ORDER, highest, slope, stretch, value
from analytic.kernels.rest import acceleration, ground, segment_at
from analytic.kernels.taylor import TOLERANCE, Accuracy, accuracy
from analytic.models import Model, find_model
from analytic.motion import FloatArray, Motion
from analytic.response import Outcome
from analytic.simulate import OUTCOMES, peak_ratios, scaled_segments
from analytic.start import REST, folded

AMPLITUDE, RESTITUTION = 0, 1
"""Rows of the derivatives: by ln(a_p), by ln(eta)."""
RATE = 1
"""Column of the derivative of the velocity, beside that of the rotation."""
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

    The start, as for `simulate`, is the same for all scales.

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
    eta = housner_restitutions(alpha) if restitution is None else np.asarray(restitution)

    def solve(stronger: float, livelier: float) -> tuple[FloatArray, NDArray[np.object_]]:
        scaled = stronger * np.asarray(amplitude_g)
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
    """Return what `sensitivities` does, of one peak; the start is the same for all moves.

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
    """Return what solves one response with its motion and eta multiplied, eta to at most 1.

    It takes both factors, returns the largest rotation [rad] and the outcome, writes nothing else
    down and may be called from several threads.
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
    """Write the condition numbers of each case, one a column."""
    given, held, work = listed(cases), listed(constants), workspace()
    segments = np.zeros((1, 7))
    for i in range(len(given[0])):
        law = law_of(linear, held, given, i)
        write_pulse(given, i, segments[0])
        by_amplitude[i], by_eta[i] = condition(law, exactly, segments, UPRIGHT, work)


@kernel
def condition(
    law: Law, accuracy: Accuracy, segments: FloatArray, start: Start, work: FloatArray
) -> tuple[float, float]:
    """Return both condition numbers of one response; nan unless it rocks and survives."""
    log = np.empty((64, 4))
    nothing = np.empty(0)
    while True:
        notes = Notes(nothing, np.empty((2, 0)), log, nothing)
        end = march(law, accuracy, segments, start, 0.0, notes, work)
        if end.events <= log.shape[0]:
            break
        log = np.empty((end.events, 4))
    if end.outcome != ROCKED:
        return math.nan, math.nan
    return follow(law, accuracy, listed(segments), listed(log[: end.events]), listed(work))


class Slopes(NamedTuple):
    """Derivatives by ln(a_p) and by ln(eta), a row each.

    now (2, 2): of the rotation and of its rate; peak (2,): of the largest rotation so far.
    """

    now: FloatArray
    peak: FloatArray


@maker
def follow(
    law: Law, accuracy: Accuracy, segments: FloatArray, log: FloatArray, work: FloatArray
) -> tuple[float, float]:
    """Follow the derivatives through the excursions between the events of a march's log."""
    slopes = Slopes(listed(np.zeros((2, 2))), listed(np.zeros(2)))
    last = segments[-1][1]
    peak = y = v = 0.0
    j = 0
    for n in range(len(log)):
        kind, tau, before, after = log[n]
        if kind == RESTED:
            continue
        j = segment_at(segments, j, tau)
        a, y = ground(segments, j, tau), 0.0
        if kind == START:
            side = math.copysign(1.0, before if before != 0.0 else after)
            y, v = abs(before), side * after
            lead, peak = 0 if y > 0.0 else 1, y
        elif kind == UPLIFT:
            side = -math.copysign(1.0, a)
            lead, v = int(before), 0.0
            for i in range(2):
                slopes.now[i][0] = slopes.now[i][RATE] = 0.0
        else:
            side, v, lead = math.copysign(1.0, after), abs(after), 1
            strike(law, side, a, -abs(before), slopes.now)
            if v == 0.0:
                side, lead = -math.copysign(1.0, a), 2
        until = log[n + 1][1] if n + 1 < len(log) else last
        begin = State(side, tau, lead, y, v)
        y, v, peak = fly(law, accuracy, segments[j:], begin, until, peak, slopes, work)
    if log[-1][0] != RESTED:
        peak = peak_to_come(law, y, v, peak, slopes)
    return slopes.peak[AMPLITUDE] / peak, slopes.peak[RESTITUTION] / peak


@inner
def strike(law: Law, side: float, a: float, before: float, now: FloatArray) -> None:
    """Take `Slopes.now` through an impact, onto `side`; `before` < 0 is the velocity of y."""
    here, there = acceleration(law, -side, a, 0.0), acceleration(law, side, a, 0.0)
    for i in range(2):
        later = -now[i][0] / before
        lost = law.eta * before if i == RESTITUTION else 0.0
        velocity = -law.eta * (now[i][RATE] + here * later) - lost
        now[i][0] = law.eta * before * later
        now[i][RATE] = velocity - there * later


@maker
def fly(
    law: Law,
    accuracy: Accuracy,
    segments: FloatArray,
    begin: State,
    until: float,
    peak: float,
    slopes: Slopes,
    work: FloatArray,
) -> tuple[float, float, float]:
    """Follow one excursion and its derivatives from a state to a time.

    Parameters
    ----------
    law, accuracy, work
        As for `march`.
    segments : ndarray, shape (m, 7)
        The ground motion from the time of the state on.
    begin : State
    until : float
        No later than the end of the motion.
    peak : float
        The largest rotation so far.
    slopes : Slopes
        Moved on to `until`.

    Returns
    -------
    y, v, peak : float
    """
    series, d, spare = work[0], work[4], work[5:]
    delta = listed(np.empty((3, ORDER + 1)))
    order = accuracy.order
    side, tau, lead, y, v = begin
    j = 0
    while tau < until:
        j = segment_at(segments, j, tau)
        h = expand(law, accuracy, segments[j], State(side, tau, lead, y, v), work)
        end = min(segments[j][1], until)
        landed = tau + h >= end
        if landed:
            h = end - tau
        stretch(series, order, h, d)
        peak, where = highest(d, order, lead, 1.0, peak, spare)
        expand_derivatives(law, order, work, slopes.now, delta)
        for i in range(2):
            stretch(delta[i], order, h, delta[i])
            if where >= 0.0:
                slopes.peak[i] = value(delta[i], order, where)
            slopes.now[i][0] = value(delta[i], order, 1.0)
            slopes.now[i][RATE] = slope(delta[i], order, 1.0) / h
        y, v, lead = value(d, order, 1.0), slope(d, order, 1.0) / h, 0
        tau = end if landed else tau + h
    return y, v, peak


@inner
def expand_derivatives(
    law: Law, order: int, work: FloatArray, now: FloatArray, delta: FloatArray
) -> None:
    """Fill delta[:2] with the series of the derivatives, from those `expand` left in `work`.

    Exact: d'' = (cos z - f sin z) d - cos z df, with df = f for the amplitude and 0 for eta.
    """
    f, sine, cosine = work[1], work[2], work[3]
    stiff = delta[2]
    for i in range(2):
        delta[i][0], delta[i][1] = now[i][0], now[i][RATE]
    for n in range(order - 1):
        forced = law.k * law.k * law.factor * f[n]
        if not law.linear:
            forced, stiff[n] = 0.0, cosine[n]
            for m in range(n + 1):
                forced += f[m] * cosine[n - m]
                stiff[n] -= f[m] * sine[n - m]
        for i in range(2):
            pulled = law.k * law.k * delta[i][n]
            if not law.linear:
                pulled = 0.0
                for m in range(n + 1):
                    pulled += stiff[m] * delta[i][n - m]
            shaken = forced if i == AMPLITUDE else 0.0
            delta[i][n + 2] = (pulled - shaken) / ((n + 1) * (n + 2))


@inner
def peak_to_come(law: Law, y: float, v: float, peak: float, slopes: Slopes) -> float:
    """Take the derivatives on to the peak of the free rocking after the motion, if it is higher."""
    ahead = free_peak(law, y, v)
    if ahead <= peak:
        return peak
    kept = law.eta * law.eta if v < 0.0 else 1.0
    here, there = -acceleration(law, 1.0, 0.0, y), -acceleration(law, 1.0, 0.0, ahead)
    work = 0.5 * v * v + work_to(law, y)
    for i in range(2):
        change = kept * (v * slopes.now[i][RATE] + here * slopes.now[i][0])
        if i == RESTITUTION and v < 0.0:
            change += 2.0 * kept * work
        slopes.peak[i] = change / there
    return ahead
