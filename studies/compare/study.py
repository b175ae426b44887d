"""One block, one pulse or record, every named source side by side."""

import math
from collections.abc import Sequence
from statistics import median
from typing import Annotated, Literal

import numpy as np

from analytic.block import RigidBlock
from analytic.motion import FloatArray, Motion
from analytic.response import Response
from studies.cases.accelerograms import Baseline, Units
from studies.cases.paper import free_rocking_window
from studies.drawing.comparison import baseline_note, draw, json_lines, table_text
from studies.kit.arguments import (
    BadInputError,
    Count,
    Place,
    Positive,
    check_plot,
    check_sources,
    refuse_given,
)
from studies.kit.executors import Executor, choose
from studies.kit.jobs import Job, summary
from studies.kit.journal import Row
from studies.kit.naming import several_sources
from studies.kit.posing import posed_block, posed_pulse, posed_record
from studies.kit.runner import exit_code, run_jobs
from studies.sources.groups import core_sources
from studies.sources.registry import DEFAULT_EFFORT, Accuracy, Effort

DEFAULT_SOURCES = ("exact", "housner", "modified", *core_sources())


def command(
    *,
    width: Positive,
    height: Positive,
    amplitude: Positive | None = None,
    omega: Positive | None = None,
    pulse: Literal["half-sine", "full-sine"] | None = None,
    half_cycles: Count | None = None,
    record: Place | None = None,
    units: Units | None = None,
    scale: Positive | None = None,
    pga: Positive | None = None,
    baseline: Baseline | None = None,
    sources: Annotated[tuple[str, ...], several_sources] = DEFAULT_SOURCES,
    duration: Positive | None = None,
    step: Positive | None = None,
    accuracy: Accuracy | None = None,
    plot: Place | None = None,
    json: bool = False,
    jobs: Count | None = None,
    time_limit: Positive = 60.0,
    cluster: str | None = None,
) -> int:
    """Compare the sources on one block and one pulse or record.

    Parameters
    ----------
    width
        Full width B of the block [m].
    height
        Full height H of the block [m].
    amplitude
        Amplitude of the ground acceleration [g], positive: the mirror image of a pulse has the
        mirror image of its response.
    omega
        Circular frequency of the pulse [rad/s].
    pulse
        half-sine or full-sine; full-sine unless --half-cycles is given.
    half_cycles
        Number of half cycles, instead of --pulse.
    record
        A recorded accelerogram instead of a pulse: a PEER AT2 file, an ASC file of ESM or ITACA, or
        a table of time [s] and acceleration. It is straight between its samples.
    units
        Of the record's acceleration, where the file does not state them.
    scale
        Factor on the record's acceleration.
    pga
        Scale the record to this largest absolute acceleration [g].
    baseline
        Correct the record, before it is scaled, by what scipy.signal.detrend takes away: its mean
        (constant) or the line that fits it best (linear). By default it is taken as it is, and what
        velocity it leaves the base with is reported.
    sources
        Who is asked.
    duration
        Observe until this time [s], at least the length of the motion; by default the motion and
        8/p of free rocking.
    step
        p dt [-] of the solvers and engines, the step in units of 1/p; by default their own.
    accuracy
        loose, standard or tight, for engines whose steps land on impacts; standard by default.
    plot
        Draw the time histories over each other into this file (.png, .pdf or .svg).
    json
        Print one JSON object for each source, one a line, instead of the table.
    jobs
        Processes for the engines; by default the number of cores.
    time_limit
        Wall-clock time [s] after which an engine is given up.
    cluster
        Address of a Dask scheduler, whose workers then run all cases, as in tcp://127.0.0.1:8786.
    """
    check_sources(sources)
    check_plot(plot)
    block = posed_block(width, height)
    if record is None:
        refuse_given(
            {"units": units, "scale": scale, "pga": pga, "baseline": baseline},
            "only with --record",
        )
        motion: Motion = posed_pulse(amplitude, omega, pulse, half_cycles)
        note = ""
    else:
        shape = {"amplitude": amplitude, "omega": omega, "pulse": pulse, "half-cycles": half_cycles}
        refuse_given(shape, "only without --record")
        motion = posed_record(record, units, scale, pga, baseline)
        note = baseline_note(motion, baseline)
    window = _window(block, motion, duration)
    times = np.linspace(0.0, window, 1501) if plot else None
    executor = choose(jobs, time_limit, cluster)
    rows = compare(
        block,
        motion,
        sources,
        window,
        times=times,
        effort=Effort(step, accuracy),
        executor=executor,
    )
    print(json_lines(rows, note) if json else table_text(block, motion, window, rows, note))
    if plot:
        draw(rows, block, motion, plot)
    return exit_code(rows)


def _window(block: RigidBlock, motion: Motion, duration: float | None) -> float:
    if duration is None:
        return free_rocking_window(block, motion)
    if duration < motion.duration:
        raise BadInputError(
            f"--duration is {duration:g}; it must be at least the length of the motion, "
            f"{motion.duration:.6g} s"
        )
    return duration


def compare(
    block: RigidBlock,
    motion: Motion,
    sources: Sequence[str],
    window: float,
    *,
    executor: Executor,
    times: FloatArray | None = None,
    effort: Effort = DEFAULT_EFFORT,
) -> list[Row]:
    """Ask every source; return a row for each, with its response and its distance from exact.

    Returns
    -------
    list of dict
        Columns source, outcome, peak_ratio, impacts, steps, wall_s, message, response,
        difference (relative; nan where not both survived) and velocity_ratio (the median).
    """
    asked = list(dict.fromkeys(["exact", *sources]))
    jobs = [
        Job(
            labels={},
            block=block,
            motion=motion,
            source=name,
            duration=window,
            times=times,
            options=effort.options(name),
        )
        for name in asked
    ]
    rows = run_jobs(jobs, executor=executor, reduce=_reduce)
    exact = next(row["peak_ratio"] for row in rows if row["source"] == "exact")
    for row in rows:
        row["difference"] = row["peak_ratio"] / exact - 1.0 if exact else math.nan
    by_source = {row["source"]: row for row in rows}
    return [by_source[name] for name in sources]


def _reduce(job: Job, response: Response) -> Row:
    ratios = [impact.ratio for impact in response.impacts if impact.velocity_before]
    return {
        **summary(job, response),
        "velocity_ratio": median(ratios) if ratios else math.nan,
        "response": response,
    }
