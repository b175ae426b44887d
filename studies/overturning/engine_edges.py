"""Engines on an overturning map: on a coarse grid, beside edges, and their own thresholds.

The edges are those of the exact solution; the adapters never see them, only pulses.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from analytic.motion import SinePulse
from analytic.response import Outcome, Response
from studies.cases.window import Window
from studies.old.jobs import Job, ask, summary
from studies.old.journal import Row
from studies.sources.registry import Source

OFFSETS = (-1e-2, -1e-3, -1e-4, 1e-4, 1e-3, 1e-2)
"""Relative distances from an edge at which an engine is asked for the outcome."""
ROOM = 0.04
"""Relative width on both sides that an edge needs to be asked about."""
SPREAD = 0.03
"""Relative distance within which an engine's own threshold is looked for."""
THRESHOLD_WIDTH = 1e-6
"""Relative width to which it is bisected."""
PLACE = ("x", "low", "above")
"""Columns that tell where an edge is, and on which side of it a block overturns."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Bisected(Response):
    """The response at the upper end of a bisection, and what this found.

    Attributes
    ----------
    shift : float
        The threshold over the exact one, less 1; nan if it is not within SPREAD.
    runs : int
        Runs that the search took.
    """

    shift: float
    runs: int


def grid_jobs(window: Window, engines: Sequence[str], count: int) -> list[Job]:
    """Return a job for each engine at each cell of a grid.

    Parameters
    ----------
    window : Window
    engines : sequence of str
        Names that `studies.sources.registry.resolve` knows.
    count : int
        Columns of the grid, and amplitudes in each.
    """
    cells = product(window.centres(count).tolist(), window.amplitudes(count).tolist(), engines)
    return [_job(window, source, x, onsets, table="engines") for x, onsets, source in cells]


def edge_jobs(window: Window, engines: Sequence[str], edges: pd.DataFrame) -> list[Job]:
    """Return the jobs beside chosen edges, and a search for each engine's own threshold.

    Parameters
    ----------
    window : Window
    engines : sequence of str
        Names that `studies.sources.registry.resolve` knows.
    edges : DataFrame
        From `chosen_edges`, with x, low (the amplitude over g tan(alpha)) and above (the mode).

    Returns
    -------
    list of Job
        For each edge and engine one at each of OFFSETS (table "edges") and a search for `threshold`
        (table "thresholds"); edge and overturns ("above" or "below" it) are labels of both.
    """
    jobs = []
    for x, onsets, above in zip(*(edges[name].tolist() for name in PLACE), strict=True):
        labels = {"edge": onsets, "overturns": "above" if above >= 0 else "below"}
        for source in engines:
            for offset in OFFSETS:
                beside = {"table": "edges", **labels, "offset": offset}
                jobs.append(_job(window, source, x, onsets * (1.0 + offset), **beside))
            jobs.append(_job(window, source, x, onsets, table="thresholds", **labels))
    return jobs


def _job(window: Window, source: str, x: float, onsets: float, **labels: Any) -> Job:
    block, motion = window.case(x, onsets)
    where = {"x": x, "onsets": onsets}
    return Job(labels={**labels, **where}, block=block, motion=motion, source=source)


def chosen_edges(edges: pd.DataFrame, positions: Sequence[float]) -> pd.DataFrame:
    """Return the edges that have room, of the columns nearest to some positions.

    An edge has room where the next ones in its column are further than ROOM.

    Parameters
    ----------
    edges : DataFrame
        Of one model, with x and low (over g tan(alpha)), ordered by column and amplitude.
    positions : sequence of float
        Abscissae of the map; only columns with an edge count.
    """
    columns = np.unique(edges["x"])
    nearest = [columns[np.argmin(abs(columns - x))] for x in positions if columns.size]
    logs = np.log(edges["low"]).groupby(edges["x"])
    room = ~(logs.diff() <= ROOM) & ~(logs.diff(-1) >= -ROOM)  # at an end there is no next one
    chosen: pd.DataFrame = edges[room & edges["x"].isin(nearest)]
    return chosen


def ask_for_table(job: Job, source: Source) -> Response:
    """Put a job of any of the three tables to its source.

    Parameters
    ----------
    job : Job
        Of `grid_jobs` or `edge_jobs`.
    source : Source

    Returns
    -------
    Response
        For the table "thresholds" a `Bisected`, or the response that failed.

    Raises
    ------
    TypeError
        If a threshold is asked for of a motion that is no `SinePulse`.
    """
    if job.labels["table"] != "thresholds":
        return ask(job, source)
    return threshold(job, source)


def threshold(job: Job, source: Source) -> Response:
    """Bisect the amplitude at which a source's outcome changes, near that of the job."""
    pulse = job.motion
    if not isinstance(pulse, SinePulse):
        raise TypeError(f"{pulse!r} has no amplitude to bisect")
    low, high, runs = -SPREAD, SPREAD, 0

    def run(shift: float) -> Response:
        nonlocal runs
        runs += 1
        scaled = replace(pulse, amplitude=pulse.amplitude * (1.0 + shift))
        return ask(replace(job, motion=scaled), source)

    first, last = run(low), run(high)
    for response in (first, last):
        if response.outcome is Outcome.FAILED:
            return response
    shift = math.nan
    if (first.outcome is Outcome.OVERTURNED) != (last.outcome is Outcome.OVERTURNED):
        while high - low > THRESHOLD_WIDTH:
            middle = 0.5 * (low + high)
            response = run(middle)
            if response.outcome is Outcome.FAILED:
                return response
            same = (response.outcome is Outcome.OVERTURNED) == (first.outcome is Outcome.OVERTURNED)
            low, high = (middle, high) if same else (low, middle)
        shift = 0.5 * (low + high)
    kept = {name: getattr(last, name) for name in Response.__slots__}
    return Bisected(**kept, shift=shift, runs=runs)


def reduce(job: Job, response: Response) -> Row:
    """Return the columns that follow the labels of a job's table.

    Parameters
    ----------
    job : Job
    response : Response
        From `ask_for_table`.

    Returns
    -------
    dict
        Those of `summary`; for the table "thresholds" outcome, shift, runs (0 of a search that
        failed) and message.
    """
    if job.labels["table"] != "thresholds":
        return summary(job, response)
    found = isinstance(response, Bisected)
    return {
        "outcome": response.outcome.value,
        "shift": response.shift if isinstance(response, Bisected) else math.nan,
        "runs": response.runs if found else 0,  # type: ignore[attr-defined]
        "message": response.message,
    }
