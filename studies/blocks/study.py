"""A list of blocks, recorded ground motions and their scales, through any sources."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial
from itertools import product
from pathlib import Path
from typing import Annotated, Any

import pandas as pd
from cyclopts import Parameter

from analytic.record import Record
from analytic.response import Outcome, Response
from studies.blocks import STUDY
from studies.blocks.cabinets import Cabinet, read_cabinets
from studies.blocks.report import finding, report
from studies.blocks.strength import strength
from studies.cases.accelerograms import Baseline, Units, baseline_note, recorded
from studies.cases.paper import free_rocking_window
from studies.kit.arguments import (
    Out,
    Place,
    Positive,
    Yes,
    one_of,
    refuse_repeats,
    several,
)
from studies.kit.jobs import Job, summary
from studies.kit.journal import Row
from studies.kit.naming import Sources
from studies.kit.options import DEFAULT_RUNNING, Running, slides
from studies.kit.plan import Plan, Tables, carry_out
from studies.kit.posing import refuse_endless
from studies.measures.differences import conditioning_of_one
from studies.sources.registry import resolve

__all__ = ["command", "finding", "report"]

ANSWERS, MARGINS = "answers", "margins"
"""What a row of the journal is: a source's answer, or how strong a record overturns a block."""
NO_SCALE = 0.0
"""Of a row that is about all factors on a record."""
FACTS = ("kappa", "sensitivity", "min_normal", "friction_needed")
"""Columns of the exact solution, which all sources of a case are read beside."""
FOUND = ("lifts", "margin", "islands")
"""Columns of a block under a record, at whatever factor."""
CASE = ["name", "record", "scale"]
OF_A_BLOCK = CASE[:2]
"""Columns that name a case, and all cases of a block under a record."""


def command(
    cabinets: Annotated[str, Parameter(name="CABINETS.csv")],
    /,
    *,
    record: Annotated[tuple[Place, ...], several],
    out: Out,
    scale: Annotated[tuple[Positive, ...], several] = (1.0,),
    units: Annotated[Units, one_of(Units)] | None = None,
    baseline: Annotated[Baseline, one_of(Baseline)] | None = None,
    sources: Sources = ("exact",),
    running: Running = DEFAULT_RUNNING,
    yes: Yes = False,
) -> int:
    """Put a list of blocks to recorded ground motions.

    Parameters
    ----------
    cabinets
        A table with a line of names: name, width and height [m] of each block, and perhaps its
        friction, for engines, and its tilt, the rotation that it starts from in units of α.
    record
        Recorded accelerograms, files as `rocking compare --record` takes them.
    scale
        Factors on the records' acceleration.
    units
        Of the records' acceleration: needed where a file does not state them, refused where one
        states others.
    baseline
        Correct the records by what scipy.signal.detrend takes away: their mean (constant) or the
        line that fits them best (linear).
    """
    refuse_repeats("--scale", scale)
    refuse_repeats("--record", [Path(path.name) for path in record])
    grounds = {
        path.name: ground
        for path, ground in zip(record, recorded(record, units, baseline, "--record"), strict=True)
    }
    listed = read_cabinets(Path(cabinets))
    asked = f"the list is {cabinets!r}, of {len(listed)} blocks"
    cases = len(listed) * len(grounds) * len(scale)
    running.refuse_too_much(asked, cases, ("exact", *sources), yes=yes)
    settings = {"units": units or "", "baseline": baseline or ""}
    chosen = plan(listed, grounds, scale, sources, settings)
    return carry_out(STUDY, chosen, out, running, report)


def plan(
    cabinets: Sequence[Cabinet],
    grounds: Mapping[str, Record],
    scales: Sequence[float],
    sources: Sequence[str],
    settings: Mapping[str, str],
) -> Plan:
    """Return the plan that puts every block to every record, and looks for its margin."""
    asked = list(dict.fromkeys(["exact", *sources]))
    jobs = []
    for cabinet, (record, ground) in product(cabinets, grounds.items()):
        for scale, source in product(scales, asked):
            jobs.append(_job(cabinet, record, ground.scaled(scale), scale, source, ANSWERS))
        jobs.append(_job(cabinet, record, ground, NO_SCALE, "exact", MARGINS))

    def tabulate(rows: Sequence[Row]) -> Tables:
        table = joined(rows)
        return {STUDY.name: table[table["source"].isin(sources)]}

    growing: dict[str, Sequence[Any]] = {
        "name": [cabinet.name for cabinet in cabinets],
        "record": list(grounds),
        "scale": [*scales, NO_SCALE],
        "source": asked,
    }
    return Plan(
        jobs=jobs,
        settings=settings,
        growing=growing,
        reduce=partial(reduce, baseline=settings["baseline"]),
        tabulate=tabulate,
    )


def _job(
    cabinet: Cabinet, record: str, motion: Record, scale: float, source: str, table: str
) -> Job:
    block, labels = cabinet.block, {"name": cabinet.name, "width_m": cabinet.width_m}
    window = free_rocking_window(block, motion)
    refuse_endless(block, window)
    options: dict[str, Any] = {}
    if cabinet.start != (0.0, 0.0):
        options["start"] = cabinet.start
    if cabinet.friction is not None and resolve(source).engine:
        options["friction"] = cabinet.friction
    return Job(
        labels={
            "table": table,
            **labels,
            "height_m": cabinet.height_m,
            "friction": cabinet.friction,
            "tilt": cabinet.tilt,
            "record": record,
            "scale": scale,
        },
        block=block,
        motion=motion,
        source=source,
        duration=window,
        options=options,
    )


def reduce(job: Job, response: Response, *, baseline: str) -> Row:
    """Return a source's answer, with what is known of the exact one; or the margin of a block."""
    start = job.options.get("start", (0.0, 0.0))
    row = summary(job, response)
    if job.labels["table"] == MARGINS:
        found = strength(job.block, job.motion, start)
        ends = (dict.fromkeys((f"{low:.4g}", f"{high:.4g}")) for low, high in found.islands)
        words = " ".join(map("-".join, ends))
        return {**row, "lifts": found.lifts, "margin": found.margin, "islands": words}
    exact = job.source == "exact"
    said = [row["message"], slides(response, job.labels["friction"]) if exact else ""]
    if isinstance(job.motion, Record):
        said.append(baseline_note(job.motion, baseline or None))
    row["message"] = "; ".join(filter(None, said))
    known = conditioning_of_one(job.block, job.motion, start, response) if exact else {}
    limits = {name: getattr(response, name) for name in FACTS[2:]} if exact else {}
    return {**row, **known, **limits}


def joined(rows: Sequence[Row]) -> pd.DataFrame:
    """Return the answers, each beside the facts of the exact solution and the margin of its block.

    A factor that was asked for and overturns counts for the margin, too: it may lie in a sliver
    that the search did not see.
    """
    table = pd.DataFrame(rows)
    answers, margins = (table[table["table"] == kind] for kind in (ANSWERS, MARGINS))
    exact = answers[answers["source"] == "exact"]
    fallen = exact[exact["outcome"] == Outcome.OVERTURNED.value]
    asked = fallen.groupby(OF_A_BLOCK, as_index=False).agg(asked=("scale", "min"))
    whole = (
        answers.drop(columns=["table", *FACTS, *FOUND])
        .merge(exact[[*CASE, *FACTS]], on=CASE)
        .merge(margins[[*OF_A_BLOCK, *FOUND]], on=OF_A_BLOCK)
        .merge(asked, on=OF_A_BLOCK, how="left")
        .fillna({"asked": math.inf})
    )
    whole["margin"] = whole[["margin", "asked"]].min(axis=1, skipna=False)
    return whole.drop(columns="asked")
