"""The reference's two entries: `simulate` for one response, `peak_ratios` for arrays of them."""

import math
import time
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.block import RigidBlock, Rocker
from analytic.cases import law_of, pose, write_pulse
from analytic.checks import finite, within
from analytic.kernels.compiled import form_for, kernel, listed
from analytic.kernels.excursions import BROKEN, OVERTURNED, TOO_LONG, End, march, workspace
from analytic.kernels.forces import NOTHING_YET
from analytic.kernels.law import UPRIGHT
from analytic.kernels.notes import IMPACT, RESTED, UPLIFT, Notes
from analytic.kernels.rest import strongest_between
from analytic.kernels.taylor import TOLERANCE, Accuracy, accuracy
from analytic.models import Model, find_model
from analytic.motion import FloatArray, Motion
from analytic.response import History, Impact, Outcome, Problem, Reason, Response
from analytic.slide import SlidingBlock
from analytic.slipping import slid
from analytic.start import REST, folded

OUTCOMES = (
    Outcome.AT_REST,
    Outcome.ROCKED,
    Outcome.OVERTURNED,
    Outcome.FAILED,
    Outcome.FAILED,
)
"""In the order of the codes in `analytic.kernels.excursions`."""
FAILURES = {
    TOO_LONG: Problem(Reason.UNDECIDED, "the response takes too many steps"),
    BROKEN: Problem(
        Reason.DIVERGED,
        "the solution overflows, or its steps vanish beside the time they start from",
    ),
}
"""Why a response failed, by its code."""

LOOSEST = 1e-2
"""Largest tolerance that `simulate` takes."""


def simulate(
    block: Rocker | SlidingBlock,
    motion: Motion,
    model: str | Model = "exact",
    start: tuple[float, float] = REST,
    *,
    duration: float | None = None,
    times: ArrayLike | None = None,
    tolerance: float = TOLERANCE,
) -> Response:
    """Solve one response.

    Parameters
    ----------
    block : RigidBlock, RockingFrame or SlidingBlock
    motion : Motion
        Ground motion, for instance a `SinePulse`; `Still()` where there is none.
    model : {"exact", "housner", "modified", "onset-matched"}
    start : (float, float), optional
        Rotation theta [rad] and angular velocity theta' [rad/s] at time zero; at rest by default.
        The sign of theta says which corner carries the block, that of the rate where theta is 0.
        Beyond the critical rotation the motion may bring a block back. Of a sliding block, place
        [m] and rate [m/s] relative to the base.
    duration : float, optional
        Follow the response until this time [s], at least the duration of the motion. Without it
        the response is followed to the end of the motion, or to the last of the times where that is
        later; outcome and peak of the free rocking after that come from its energy in either case.
        A sliding block is followed until it stands.
    times : array_like, optional
        Ground times [s], increasing, at which to sample `Response.history`; it ends where the
        response is no longer followed: with the `duration`, if one is given, or a fall.
    tolerance : float, optional
        Truncation error of a step of the exact model, relative to the rotation, from 1e-16 to
        1e-2; the degree of its Taylor series follows from it. The linear models are solved in
        closed form, whatever the tolerance.

    Returns
    -------
    Response
        With `min_normal` and `friction_needed` for the exact model of a block
        (`analytic.frame_forces` has a frame's). Its peak is at least that of the start.

    Raises
    ------
    ValueError
        If the model is unknown, or linear and the body none of its own; if the duration is shorter
        than the motion, the times are not increasing or the tolerance is out of range, or the start
        is none (`analytic.start.folded` says which).

    Notes
    -----
    What exceeds the onset by a part 1e-15 of it, or for a part 1e-12 of the time between two
    samples, counts as rounding and lifts nothing.

    Examples
    --------
    A block released from half its critical rotation, followed for five seconds:

    >>> block = RigidBlock(width=0.5, height=1.5)
    >>> simulate(block, Still(), start=(0.5 * block.alpha, 0.0), duration=5.0).outcome
    <Outcome.ROCKED: 'rocked'>
    """
    if isinstance(block, SlidingBlock):
        if find_model(model).linear:
            raise ValueError(f"model is {model!r}; a {type(block).__name__} has only 'exact'")
        until, sampled = check_window(motion, duration, times)
        kept = None if times is None else sampled
        return slid(block, motion, start, None if duration is None else until, kept)
    law = find_model(model).law(block.alpha, block.restitution)
    tolerance = within("tolerance", tolerance, TOLERANCE, LOOSEST)
    exactly = accuracy(TOLERANCE if law.linear else tolerance)
    until, sampled = check_window(motion, duration, times)
    begin = folded(block, law, motion, start, sampled)
    segments = scaled_segments(block, motion)

    watched = isinstance(block, RigidBlock) and not law.linear

    def solve(notes: Notes) -> End:
        return march(law, exactly, segments, begin, until * block.p, notes, workspace())

    return as_response(block, solve, sampled, times is not None, watched)


def strongest(motion: Motion) -> float:
    """Return the largest abs(acceleration) [m/s2] of a ground motion."""
    return float(strongest_between(motion.segments().tolist(), 0, 0.0, motion.duration))


def as_response(
    block: Rocker,
    solve: Callable[[Notes], End],
    sampled: FloatArray,
    recorded: bool,
    watched: bool,
) -> Response:
    """Run a compiled march and turn what it records into a response in seconds.

    Parameters
    ----------
    block : RigidBlock
    solve : callable
        The march, given where to notes.
    sampled : ndarray
        Times [s] of the history; kept in the response if `recorded`.
    recorded, watched : bool
        Whether the response has a history, and limits of the contact forces.
    """
    samples = np.empty((2, sampled.size))
    log = np.empty((1024, 4))
    began = time.perf_counter()
    while True:
        limits = np.array(NOTHING_YET) if watched else np.empty(0)
        notes = Notes(sampled * block.p, samples, log, limits)
        end = solve(notes)
        if end.events <= len(log):
            break
        log = np.empty((end.events, 4))
    wall_s = time.perf_counter() - began

    outcome = OUTCOMES[end.outcome]
    if outcome is Outcome.FAILED:
        reason, message = FAILURES[end.outcome]
        return Response.failure(message, reason=reason, steps=end.steps, wall_s=wall_s)
    impacts, uplifts, rests = read_log(log[: end.events], block.p)
    seen = int(np.searchsorted(notes.times, end.time, side="right"))
    history = History(sampled[:seen], samples[0, :seen], samples[1, :seen] * block.p)
    return Response(
        outcome=outcome,
        peak_ratio=math.inf if outcome is Outcome.OVERTURNED else end.peak / block.alpha,
        crossed=outcome is Outcome.OVERTURNED or end.peak > block.alpha,
        impacts=impacts,
        uplifts=uplifts,
        rests=rests,
        steps=end.steps,
        wall_s=wall_s,
        history=history if recorded else None,
        min_normal=float(limits[0]) if watched else math.nan,
        friction_needed=float(limits[1]) if watched else math.nan,
    )


def peak_ratios(
    alpha: ArrayLike,
    amplitude_g: ArrayLike,
    omega_over_p: ArrayLike,
    half_cycles: ArrayLike,
    model: str | Model = "exact",
    restitution: ArrayLike | None = None,
    threads: int | None = None,
) -> tuple[FloatArray, NDArray[np.object_]]:
    """Solve many responses to sine pulses, on all cores.

    By similarity a case has no more parameters than these.

    Parameters
    ----------
    alpha : array_like
        Slenderness [rad], in (0, pi/2).
    amplitude_g : array_like
        Amplitude of the pulse [g].
    omega_over_p : array_like
        Circular frequency of the pulse over the frequency parameter of the block.
    half_cycles : array_like of int
        Length of the pulse.
    model : {"exact", "housner", "modified", "onset-matched"}
    restitution : array_like, optional
        Velocity ratio at impacts, in [0, 1]; Housner's value by default.
    threads : int, optional
        At most 1024; by default the number of cores.

    Returns
    -------
    peak_ratio : ndarray
        Largest abs(theta)/alpha in the broadcast shape; inf when overturned, 0 at rest.
    outcome : ndarray of Outcome

    Raises
    ------
    ValueError
        If an argument is outside its range or the shapes do not broadcast.

    Examples
    --------
    >>> peak, outcome = peak_ratios(0.32, [0.3, 0.4, 0.9], 2.0, 1)
    >>> peak.round(4), [one.value for one in outcome]
    (array([0.    , 0.0446,    inf]), ['at rest', 'rocked', 'overturned'])
    """
    cases = pose(alpha, amplitude_g, omega_over_p, half_cycles, model, restitution)
    exactly = accuracy(TOLERANCE)
    peaks, codes = np.empty(cases.size), np.empty(cases.size, dtype=np.int8)
    solver = form_for(cases.size, solve_pulses)

    def solve(part: slice, linear: bool, constants: FloatArray, given: FloatArray) -> None:
        solver(linear, exactly, constants, given, peaks[part], codes[part])

    cases.solve(solve, threads)
    outcomes = np.array(OUTCOMES, dtype=object)[codes]
    return peaks.reshape(cases.shape), outcomes.reshape(cases.shape)


@kernel
def solve_pulses(
    linear: bool,
    exactly: Accuracy,
    constants: FloatArray,
    cases: FloatArray,
    peaks: FloatArray,
    codes: NDArray[np.int8],
) -> None:
    """Solve a part of `peak_ratios`, one case a column.

    linear, constants and cases are those of `analytic.cases.SolvePart`; the last arrays, (n,), are
    written.
    """
    given, held, work = listed(cases), listed(constants), listed(workspace())
    segments = listed(np.zeros((1, 7)))
    notes = Notes(np.empty(0), np.empty((2, 0)), np.empty((0, 4)), np.empty(0))
    for i in range(len(given[0])):
        law = law_of(linear, held, given, i)
        write_pulse(given, i, segments[0])
        end = march(law, exactly, segments, UPRIGHT, 0.0, notes, work)
        codes[i] = end.outcome
        peaks[i] = end.peak / law.alpha
        if end.outcome == OVERTURNED:
            peaks[i] = math.inf
        elif end.outcome in (TOO_LONG, BROKEN):
            peaks[i] = math.nan


def scaled_segments(block: Rocker, motion: Motion) -> FloatArray:
    """Return the segments of a motion in units of 1/p and g; not finite where they overflow.

    Parameters
    ----------
    block : Rocker, of which p and the gravity are used
    motion : Motion

    Returns
    -------
    ndarray (m, 7), in the columns of `motion.SEGMENT_COLUMNS`
    """
    p, g = np.float64(block.p), np.float64(block.gravity)
    with np.errstate(all="ignore"):
        return motion.segments() * np.array(
            [p, p, 1.0 / g, 1.0 / p, 1.0, 1.0 / g, 1.0 / (g * p)], dtype=np.float64
        )


def check_window(
    motion: Motion, duration: float | None, times: ArrayLike | None
) -> tuple[float, FloatArray]:
    """Return the time to follow a response to [s] and its sample times [s], checked.

    Parameters
    ----------
    motion : Motion
    duration, times
        As for `simulate`.

    Raises
    ------
    ValueError
        If the duration is shorter than the motion, or the times are not increasing or not finite.
    """
    sampled = np.empty(0) if times is None else np.array(times, dtype=np.float64)
    if sampled.ndim != 1 or np.any(np.diff(sampled) < 0.0) or not np.all(np.isfinite(sampled)):
        raise ValueError("times must be a list of finite, increasing numbers")
    if duration is None:
        return max([motion.duration, *sampled[-1:].tolist()]), sampled
    until = finite("duration", duration)
    if until < motion.duration:
        raise ValueError(
            f"duration is {duration!r}; it must be at least that of the motion, {motion.duration}"
        )
    return until, sampled


def read_log(
    log: FloatArray, p: float
) -> tuple[tuple[Impact, ...], tuple[float, ...], tuple[float, ...]]:
    """Turn the rows of a log into impacts, uplifts and rests in seconds and radians."""
    impacts = tuple(
        Impact(float(t) / p, float(before) * p, float(after) * p)
        for kind, t, before, after in log
        if kind == IMPACT
    )
    uplifts = tuple(float(t) / p for kind, t, _, _ in log if kind == UPLIFT)
    rests = tuple(float(t) / p for kind, t, _, _ in log if kind == RESTED)
    return impacts, uplifts, rests
