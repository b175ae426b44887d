"""One block, one pulse, record or release, every named source side by side."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from statistics import median
from typing import Any

import numpy as np

from analytic import RigidBlock, RockingFrame, frame_faults, simulate
from analytic.motion import FloatArray, Motion, SinePulse
from analytic.record import Record
from analytic.response import Outcome, Response
from analytic.slide import SlidingBlock
from engines.layouts import BEAM_DEPTH, SPACING, System
from studies.cases.accelerograms import baseline_note
from studies.cases.paper import free_rocking_window
from studies.compare.records import as_lines, records
from studies.compare.rendering import draw, table_text
from studies.old.arguments import (
    BadInputError,
    Place,
    Positive,
    check_plot,
    refuse_both,
    refuse_given,
    required,
)
from studies.old.executors import Answers, Executor
from studies.old.jobs import Job, ask, summary
from studies.old.journal import Row
from studies.old.naming import Sources
from studies.old.options import (
    DEFAULT_COMPUTING,
    NOT_YOURS,
    OWN_EFFORT,
    Computing,
    EffortOptions,
    Yours,
    slides,
)
from studies.old.posing import DEFAULT_EXCITATION, Excitation, Posed, refuse_endless
from studies.old.refusing import say
from studies.old.runner import exit_code, run_jobs
from studies.old.standing import ONE_BLOCK, WHERE_IT_ROCKS, Height, Standing, Width
from studies.old.unusual import unusual
from studies.measures.differences import conditioning_of_one
from studies.measures.halving import OF_A_PEAK, OF_BLOCKS, halved, with_estimates
from studies.sources.registry import DEFAULT_EFFORT, Effort, core_sources

EDGE = 0.01
"""An answer hangs on its amplitude where so much of it makes the difference of a fall."""

TIMED_IMPACTS = 5
"""First impacts whose times are compared."""

DEFAULT_SOURCES = ("exact", "housner", "modified", *core_sources())
OF_A_SLIDE = ("exact", *core_sources())
"""By default asked of a block that slides, which has no linearization."""


def command(
    *,
    width: Width | None = None,
    height: Height | None = None,
    excitation: Excitation = DEFAULT_EXCITATION,
    standing: Standing = ONE_BLOCK,
    sources: Sources = DEFAULT_SOURCES,
    duration: Positive | None = None,
    effort: EffortOptions = OWN_EFFORT,
    yours: Yours = NOT_YOURS,
    estimate: bool = False,
    plot: Place | None = None,
    json: bool = False,
    computing: Computing = DEFAULT_COMPUTING,
) -> int:
    """Compare the sources on one block, frame or slide, and one pulse, record or release.

    Parameters
    ----------
    duration
        Observe until this time [s], at least the length of the motion; by default the motion and
        8/p of free rocking.
    estimate
        Run every engine at half the step, too: the relative difference of the two peaks, and that
        times the factor which bounds 95 % of the errors on random cases, or that there is no such
        bound (`rocking estimate`).
    plot
        Draw the time histories over each other into this file (.png, .pdf or .svg).
    json
        Print one JSON object for each source, one a line, instead of the table.
    """
    if standing.scene == "slide" and sources == DEFAULT_SOURCES:
        sources = OF_A_SLIDE
    refuse_both(dt=yours.dt, step=effort.step)
    effort.refuse_idle(sources)
    words = "a block requires its full width and height [m]"
    width, height = required(words, width=width, height=height)
    if not standing.rocks:
        refuse_given({"plot": plot}, WHERE_IT_ROCKS)
    check_plot(plot)
    block = standing.system(width, height, yours.friction)
    posed = standing.pose(block, excitation)
    motion = posed.motion
    note = baseline_note(motion, excitation.baseline) if isinstance(motion, Record) else ""
    window = window_of(block, motion, duration)
    refuse_endless(block, window, duration=duration, step=effort.step, dt=yours.dt)
    rows = compare(
        block,
        posed,
        sources,
        window,
        times=np.linspace(0.0, window, 1501) if plot else None,
        effort=effort,
        yours=yours,
        estimate=estimate,
        executor=computing.executor(at_once=True),
    )
    if json:
        print(as_lines(records(rows, note)))
    else:
        edge = hanging(block, posed, window, rows[0]["exact"])
        print(table_text(block, posed, window, rows, note, edge, degrees=excitation.degrees))
    if plot:
        draw(rows, block, motion, plot)
    for words in unusual(width, height, excitation, motion):
        say(f"note: {words}")
    return exit_code(rows)


def _conditioning(block: System, posed: Posed, exact: Response) -> dict[str, float]:
    """Return kappa and sensitivity of the exact peak, nan where there is none."""
    if isinstance(block, SlidingBlock):
        return {"kappa": math.nan, "sensitivity": math.nan}
    return conditioning_of_one(block, posed.motion, posed.start, exact)


def hanging(block: System, posed: Posed, window: float, exact: Response) -> str:
    """Say where less than a hundredth of the amplitude decides whether the block overturns."""
    if exact.outcome is Outcome.FAILED or isinstance(block, SlidingBlock):
        return ""
    for factor in (1.0 + EDGE, 1.0 - EDGE):
        motion = _scaled(posed.motion, factor)
        other = simulate(block, motion, start=posed.start, duration=window).outcome
        outcomes = {exact.outcome, other} - {Outcome.OVERTURNED}
        if len(outcomes) == 1 and other is not exact.outcome and Outcome.FAILED not in outcomes:
            falls = "overturns" if other is Outcome.OVERTURNED else "does not overturn"
            return (
                f"the answer hangs on less than {100.0 * EDGE:g} % of the amplitude: "
                f"at {factor:g} times it, the exact block {falls}"
            )
    return ""


def _scaled(motion: Motion, factor: float) -> Motion:
    if isinstance(motion, Record):
        return motion.scaled(factor)
    if isinstance(motion, SinePulse):
        return replace(motion, amplitude=factor * motion.amplitude)
    return motion


def window_of(block: System, motion: Motion, duration: float | None) -> float:
    """Return for how long a block is watched [s], by default the motion and 8/p of free rocking.

    Parameters
    ----------
    block : System
    motion : Motion
    duration : float or None
        What was asked for [s].

    Raises
    ------
    BadInputError
        If a given duration [s] is shorter than the motion.
    """
    if duration is None:
        return free_rocking_window(block, motion)
    if duration < motion.duration:
        raise BadInputError(
            f"--duration is {duration:g}; it must be at least the length of the motion, "
            f"{motion.duration:.6g} s"
        )
    return duration


def compare(
    block: System,
    posed: Posed,
    sources: Sequence[str],
    window: float,
    *,
    executor: Executor,
    times: FloatArray | None = None,
    effort: Effort = DEFAULT_EFFORT,
    yours: Yours = NOT_YOURS,
    estimate: bool = False,
) -> list[Row]:
    """Ask every source; return a row for each, with its response and its distance from exact.

    Parameters
    ----------
    block : System
    posed : Posed
        The motion and how the block begins.
    sources : sequence of str
        The exact solution is asked besides.
    window : float
        For how long it is watched [s].
    executor : Executor
    times : ndarray, shape (m,), optional
        At which histories are kept [s].
    effort, yours : Effort, Yours, optional
        The step and the accuracy; the user's own settings.
    estimate : bool, optional
        Ask at half the step, too.

    Returns
    -------
    list of dict
        Columns source, outcome, peak_ratio, impacts, steps, wall_s, message, response, error
        (relative; nan unless both rocked), velocity_ratio (the median), impact_error [1/p] (of the
        first impacts, nan where one is missing), exact, the response of the exact solution, and its
        kappa and sensitivity; with `estimate`, estimate and bound; nan where there is none. Where
        the friction is less than the exact solution needs, its message says so.
    """
    own = yours.options(sources, block)
    asked = list(dict.fromkeys(["exact", *sources]))
    begin = {} if posed.start == (0.0, 0.0) else {"start": posed.start}
    jobs = [
        Job(
            labels={},
            block=block,
            motion=posed.motion,
            source=name,
            duration=window,
            times=times,
            options={**begin, **effort.options(name), **own.get(name, {})},
        )
        for name in asked
    ]
    rows = run_jobs(jobs, executor=executor, reduce=_reduce)
    if estimate:
        finer = [half for job in jobs if (half := halved(job)) is not None]
        halves = run_jobs(finer, executor=executor, reduce=_reduce)
        unheld = "" if isinstance(block, RigidBlock) else OF_BLOCKS
        unheld = OF_A_PEAK if isinstance(block, SlidingBlock) else unheld
        own_steps = effort.own and yours.dt is None
        rows = with_estimates(rows, halves, own_steps=own_steps, unheld=unheld)
    exact = next(row["response"] for row in rows if row["source"] == "exact")
    known = _conditioning(block, posed, exact)
    compared = {
        row["source"]: {**row, **_beside(row["response"], exact, block), **known} for row in rows
    }
    faults = _faults(block, posed, yours.friction, exact.outcome is Outcome.FAILED)
    said = (compared["exact"]["message"], slides(exact, yours.friction), *faults)
    compared["exact"]["message"] = "; ".join(filter(None, said))
    return [compared[name] for name in sources]


def _faults(block: System, posed: Posed, friction: float | None, failed: bool) -> tuple[str, ...]:
    """Return what of a frame's premises a friction does not hold."""
    if friction is None or not isinstance(block, RockingFrame) or failed:
        return ()
    sizes = {"spacing": SPACING * block.height, "depth": BEAM_DEPTH * block.height}
    return frame_faults(block, posed.motion, posed.start, **sizes, friction=friction)


def in_this_process(jobs: Sequence[Job]) -> Answers:
    """Run jobs in this process: from a reader's script others may not be startable."""
    for number, job in enumerate(jobs):
        yield number, ask(job, job.asked)


def _reduce(job: Job, response: Response) -> Row:
    ratios = [impact.ratio for impact in response.impacts if impact.velocity_before]
    return {
        **summary(job, response),
        "velocity_ratio": median(ratios) if ratios else math.nan,
        "response": response,
    }


def _beside(response: Response, exact: Response, block: System) -> dict[str, Any]:
    both = response.outcome is Outcome.ROCKED is exact.outcome
    both = both and exact.peak_ratio > 0.0
    error = response.peak_ratio / exact.peak_ratio - 1.0 if both else math.nan
    return {
        "error": _slip_error(response, exact) if exact.slips else error,
        "impact_error": _impact_error(response, exact) * block.p,
        "exact": exact,
    }


def _slip_error(response: Response, exact: Response) -> float:
    """Return the largest error of a slip over the largest exact one; nan where one is missing."""
    if len(response.slips) != len(exact.slips):
        return math.nan
    pairs = zip(response.slips, exact.slips, strict=True)
    return max(abs(one - other) for one, other in pairs) / max(map(abs, exact.slips))


def _impact_error(response: Response, exact: Response) -> float:
    """Return the largest error [s] of the first impact times; nan where one is missing."""
    wanted = [impact.time for impact in exact.impacts[:TIMED_IMPACTS]]
    found = [impact.time for impact in response.impacts[: len(wanted)]]
    if not wanted or len(found) < len(wanted):
        return math.nan
    return max(abs(one - other) for one, other in zip(found, wanted, strict=True))
