"""One block, one pulse, record or release, every named source side by side."""

import json as json_text
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from analytic.record import Record
from analytic.start import strongest
from studies.cases.accelerograms import baseline_note
from studies.compare.rows import compare, records, window_of
from studies.compare.text import motion_name, table_text
from studies.kit.arguments import (
    Place,
    Positive,
    Sources,
    check_plot,
    refuse_both,
    refuse_given,
    required,
)
from studies.kit.cluster import place_of
from studies.kit.jobs import Question, Row
from studies.kit.options import Computing, EffortOptions, Yours
from studies.kit.run import exit_code
from studies.kit.scene_options import Excitation, Height, Standing, Width, refuse_endless
from studies.sources.registry import core_sources

DEFAULT_SOURCES = ("exact", "housner", "modified", *core_sources())


def command(
    *,
    width: Width | None = None,
    height: Height | None = None,
    excitation: Excitation = Excitation(),  # noqa: B008
    standing: Standing = Standing(),  # noqa: B008
    sources: Sources = DEFAULT_SOURCES,
    duration: Positive | None = None,
    effort: EffortOptions = EffortOptions(),  # noqa: B008
    yours: Yours = Yours(),  # noqa: B008
    estimate: bool = False,
    plot: Place | None = None,
    json: bool = False,
    computing: Computing = Computing(),  # noqa: B008
) -> int:
    """One block and one pulse or record through every source, side by side.

    For each source: the outcome, the largest rotation over the critical one θcr = atan(B/H), the
    relative error of that, the impacts and the largest error of the first five impact times, times
    p; the steps and the run time. All observe the same window of time. Of the exact solution: κ and
    the sensitivity, and what it needs of its contact: friction, and a normal force (over the
    weight) that stays positive, else an engine is right to differ.

    Parameters
    ----------
    duration
        Observe until this time [s], at least the length of the motion; by default the motion and
        8/p of free rocking.
    estimate
        Run every engine at half the step, too: the relative difference of the two peaks, and that
        times the factor which bounds 95 % of the errors on random cases, or that there is no such
        bound (`rocking validate --halves`).
    plot
        Draw the time histories over each other into this file (.png, .pdf or .svg).
    json
        Print one JSON object for each source, one a line, instead of the table.
    """
    if standing.scene == "slide":
        refuse_given({"plot": plot}, "only where something rocks")
        if sources == DEFAULT_SOURCES:  # a block that slides has no linearization
            sources = ("exact", *core_sources())
    refuse_both(dt=yours.dt, step=effort.step)
    effort.refuse_idle(sources)
    words = "a block requires its full width and height [m]"
    width, height = required(words, width=width, height=height)
    check_plot(plot)
    system = standing.system(width, height, yours.friction)
    motion, start = excitation.pose(system)
    window = window_of(system, motion, duration)
    refuse_endless(system, window, duration=duration, step=effort.step, dt=yours.dt)
    times = np.linspace(0.0, window, 1501) if plot else None
    case = Question(system=system, motion=motion, start=start, duration=window, times=times)
    place = place_of(computing, at_once=True)
    rows = compare(case, sources, yours, place=place, effort=effort, estimate=estimate)
    note = baseline_note(motion, excitation.baseline) if isinstance(motion, Record) else ""
    if json:
        for record in records(rows, note):
            finite = {
                name: None if isinstance(value, float) and not math.isfinite(value) else value
                for name, value in record.items()
            }
            print(json_text.dumps(finite, allow_nan=False))
    else:
        print(table_text(case, records(rows), note, degrees=excitation.degrees))
    if plot:
        draw(case, rows, plot)
    return exit_code(rows)


def draw(case: Question, rows: Sequence[Row], path: Path) -> None:
    """Draw the histories of the rows over each other; nothing where no row has one."""
    from studies.drawing.figures import draw_histories
    from studies.kit.pictures import save
    from studies.measures.samples import samples

    system, motion = case.system, case.motion
    labels = {
        **{"panel": "", "pulse": motion_name(motion)},
        **{"width_m": system.width, "height_m": system.height},
        "amplitude_g": strongest(motion) / system.gravity,
    }
    parts = [
        samples(row["response"], system, motion, {**labels, "source": row["source"]})
        for row in rows
        if row["response"].history is not None
    ]
    if parts:
        save(draw_histories(pd.concat(parts), "The same block, the same motion of the base"), path)
