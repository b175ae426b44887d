"""The reference's entry for one response: `simulate`."""

import math
import time
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from analytic.block import RigidBlock
from analytic.checks import within
from analytic.frame import Rocker
from analytic.kernels.excursions import BROKEN, MARCH, TOO_LONG, End, Ended, workspace
from analytic.kernels.forces import NOTHING_YET
from analytic.kernels.law import IMPACT, RESTED, UPLIFT, Notes
from analytic.kernels.taylor import TOLERANCE, accuracy
from analytic.models import Model, find_model
from analytic.motion import Motion, both_ways
from analytic.response import History, Impact, Outcome, Problem, Reason, Response
from analytic.slide import SlidingBlock
from analytic.slipping import slid
from analytic.start import REST, Posed, check_vertical, check_window, pose

OUTCOMES = (Outcome.AT_REST, Outcome.ROCKED, Outcome.OVERTURNED, Outcome.FAILED, Outcome.FAILED)
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
    vertical: Motion | None = None,
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
    vertical : Motion, optional
        Motion of the base upwards at the same time, for the exact model of a `RigidBlock`; its
        acceleration must stay above -g. It may end before or after the other.
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
        is none (`analytic.checks.check_tilt` says which).

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
    motion = motion if vertical is None else both_ways(motion, vertical)
    if isinstance(block, SlidingBlock):
        check_vertical(block, motion)
        if find_model(model).linear:
            raise ValueError(f"model is {model!r}; a {type(block).__name__} has only 'exact'")
        until, sampled = check_window(motion, duration, times)
        kept = None if times is None else sampled
        return slid(block, motion, start, None if duration is None else until, kept)
    tolerance = within("tolerance", tolerance, TOLERANCE, LOOSEST)
    posed = pose(block, motion, model, start, duration, times)
    laws, begin, _, until, _ = posed
    linear = laws[0].linear
    exactly = accuracy(TOLERANCE if linear else tolerance)
    moving = posed.then_still(max(until, posed.segments[-1, 1]))
    march = MARCH.few(1, posed.steps)

    def solve(notes: Notes) -> Ended:
        return march(laws, exactly, moving, begin, 0.0, notes, workspace())

    watched = isinstance(block, RigidBlock) and block.is_homogeneous and not linear
    return as_response(block, posed, solve, times is not None, watched)


def as_response(
    block: Rocker, posed: Posed, solve: Callable[[Notes], Ended], recorded: bool, watched: bool
) -> Response:
    """Run a march, given where to note, and turn what it notes into a response in seconds."""
    if not np.all(np.isfinite(posed.segments)):
        return Response.failure(FAILURES[BROKEN].message, reason=FAILURES[BROKEN].reason)
    sampled, log = posed.times, np.empty((1024, 4))
    samples = np.empty((2, sampled.size))
    began = time.perf_counter()
    while True:
        limits = np.array(NOTHING_YET) if watched else np.empty(0)
        notes = Notes(sampled * block.p, samples, log, limits)
        end = End(*solve(notes))
        if end.events <= len(log):
            break
        log = np.empty((end.events, 4))
    wall_s = time.perf_counter() - began

    outcome = OUTCOMES[end.outcome]
    sides = end.right / posed.laws[0].alpha, end.left / posed.laws[1].alpha
    if outcome is Outcome.FAILED:
        reason, message = FAILURES[end.outcome]
        return Response.failure(message, reason=reason, steps=end.steps, wall_s=wall_s)
    events = log[: end.events].tolist()
    seen = int(np.searchsorted(notes.times, end.time, side="right"))
    history = History(sampled[:seen], samples[0, :seen], samples[1, :seen] * block.p)
    return Response(
        outcome=outcome,
        peak_ratio=math.inf if outcome is Outcome.OVERTURNED else max(sides),
        peak_sides=sides,
        crossed=outcome is Outcome.OVERTURNED or max(sides) > 1.0,
        impacts=tuple(
            Impact(t / block.p, before * block.p, after * block.p)
            for kind, t, before, after in events
            if kind == IMPACT
        ),
        uplifts=tuple(t / block.p for kind, t, *_ in events if kind == UPLIFT),
        rests=tuple(t / block.p for kind, t, *_ in events if kind == RESTED),
        steps=end.steps,
        wall_s=wall_s,
        history=history if recorded else None,
        min_normal=float(limits[0]) if watched else math.nan,
        friction_needed=float(limits[1]) if watched else math.nan,
    )
