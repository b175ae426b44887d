"""One scene in several sources side by side, on the same shaken base and the same clock."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from analytic.motion import FloatArray
from analytic.response import Outcome
from analytic.slide import SlidingBlock
from engines.layouts import System
from studies.cases.paper import Case, free_rocking_window
from studies.old.arguments import BadInputError, Place, Positive, refuse_given, required
from studies.old.executors import Executor
from studies.old.jobs import Job, summary
from studies.old.journal import Row
from studies.old.naming import Sources
from studies.old.options import DEFAULT_COMPUTING, NOT_YOURS, Computing, Yours
from studies.old.posing import DEFAULT_EXCITATION, Excitation, Posed, refuse_endless
from studies.old.provenance import check
from studies.old.runner import exit_code, run_jobs
from studies.old.standing import ONE_BLOCK, Height, Standing, Width
from studies.sources.registry import core_sources

DEFAULT_SOURCES = ("exact", "housner", *core_sources("naive"), *core_sources())
OF_A_SLIDE = tuple(name for name in DEFAULT_SOURCES if name != "housner")
"""By default asked of a block that slides, which has no linearization."""
FRAMES_A_SECOND = 25
MOST_FRAMES = 1500
"""A minute of film, which holds up to 3 GB of memory while it is drawn."""
CASE = ("figure", "pulse", "excess_g", "aspect", "width_m", "omega_over_p")


def command(
    *,
    out: Place,
    width: Width | None = None,
    height: Height | None = None,
    excitation: Excitation = DEFAULT_EXCITATION,
    standing: Standing = ONE_BLOCK,
    yours: Yours = NOT_YOURS,
    results: Place | None = None,
    sources: Sources = DEFAULT_SOURCES,
    slower: Positive = 1.0,
    computing: Computing = DEFAULT_COMPUTING,
) -> int:
    """Show a block, a frame or a slide in several sources side by side.

    Parameters
    ----------
    out
        The film: a .gif, or an .mp4 (which needs the extra [video]).
    results
        Instead of a block and what happens to it: results of `rocking sweep`, of which the case is
        shown in which the sources differ most.
    sources
        As in `rocking compare`, at most 8; the models are not asked by default where nothing rocks.
    slower
        Seconds of film for a second of shaking.
    """
    from studies.drawing.film import check_film, write_film

    if not standing.rocks and sources == DEFAULT_SOURCES:
        sources = OF_A_SLIDE
    check_film(out)
    if len(sources) > 8:
        raise BadInputError(f"--sources are {len(sources)}; they must be at most 8")
    if results is None:
        width, height = required("give them, or --results", width=width, height=height)
        block = standing.system(width, height, yours.friction)
        posed = standing.pose(block, excitation)
    else:
        standing.refuse("only without --results")
        refuse_given({"width": width, "height": height}, "only without --results")
        excitation.refuse("only without --results")
        case = most_different(results, sources)
        block, posed = case.block, Posed(case.motion, (0.0, 0.0))
    window = free_rocking_window(block, posed.motion)
    refuse_endless(block, window, dt=yours.dt)
    frames = window * slower * FRAMES_A_SECOND
    if not frames < MOST_FRAMES:
        seconds = f"{window:g} s at --slower {slower:g} are {frames:.3g} frames"
        raise BadInputError(f"{seconds}; a film must have fewer than {MOST_FRAMES}")
    times = np.linspace(0.0, window, math.ceil(frames) + 1)
    executor = computing.executor(at_once=True)
    rows = shown(block, posed, sources, times, executor, yours)
    usable = [row for row in rows if row["outcome"] != Outcome.FAILED.value]
    if usable:
        write_film(out, block, posed.motion, times, usable, FRAMES_A_SECOND)
        print(out)
    return exit_code(rows)


def most_different(results: Path, sources: Sequence[str]) -> Case:
    """Return the case of a sweep in which the sources' peaks differ most.

    Where outcomes differ it is the one whose least peak is smallest: who overturns is then furthest
    from who does not.

    Raises
    ------
    BadInputError
        If there is no sweep.csv, it lacks one of the sources, or none of its cases has all.
    FolderError
        If it is not as the sweep left it.
    """
    path = results / "sweep.csv"
    if not path.exists():
        raise BadInputError(f"--results is {str(results)!r}; it must hold a sweep.csv")
    check(results, [path.name], "--results")
    rows = pd.read_csv(path)
    peaks = rows.pivot(index=list(CASE), columns="source", values="peak_ratio").astype(float)
    if missing := sorted(set(sources) - set(peaks.columns)):
        words = f"its sweep.csv lacks {', '.join(missing)}"
        raise BadInputError(f"--results is {str(results)!r}; {words}")
    answered = peaks[list(sources)].dropna()
    if answered.empty:
        raise BadInputError(f"--results is {str(results)!r}; in each of its cases a source failed")
    least, most = answered.min(axis=1), answered.max(axis=1)
    apart = np.isinf(most) & np.isfinite(least)
    ratios = (most / least).where(most > least, 1.0)
    place: Any = least[apart].idxmin() if apart.any() else ratios.idxmax()
    return Case(**dict(zip(CASE, place, strict=True)))


def shown(
    block: System,
    posed: Posed,
    sources: Sequence[str],
    times: FloatArray,
    executor: Executor,
    yours: Yours = NOT_YOURS,
) -> list[Row]:
    """Run the sources, and return their rows with the rotation [rad] or place [m] at every time."""
    own = yours.options(sources, block)
    begin = {} if posed.start == (0.0, 0.0) else {"start": posed.start}
    jobs = [
        Job(
            labels={},
            block=block,
            motion=posed.motion,
            source=source,
            duration=float(times[-1]),
            times=times,
            options={**begin, **own[source]},
        )
        for source in sources
    ]
    rows = run_jobs(
        jobs,
        executor=executor,
        reduce=lambda job, response: {**summary(job, response), "history": response.history},
    )
    for row in rows:
        history = row["history"]
        if history is not None:
            row["theta"] = np.interp(times, history.time, history.theta)
            if row["outcome"] == Outcome.OVERTURNED.value and not isinstance(block, SlidingBlock):
                # a block that is lost from sight when its outcome is decided has fallen
                beyond = times > history.time[-1]
                row["theta"][beyond] = math.copysign(math.pi / 2, history.theta[-1])
    return rows
