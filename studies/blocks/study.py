"""A list of blocks, recorded ground motions and their scales, through any sources."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from functools import partial
from itertools import product
from pathlib import Path
from typing import Annotated, Any, cast

import numpy as np
import pandas as pd
from cyclopts import Parameter
from tqdm import tqdm

from analytic.block import RigidBlock
from analytic.record import Record
from analytic.response import Outcome, Response
from studies.blocks import STUDY
from studies.blocks.cabinets import Cabinet, read_cabinets
from studies.blocks.report import SLIDES, SLIDES_FIRST, finding, report
from studies.blocks.strength import UndecidedError, strength
from studies.cases.accelerograms import Baseline, Units, baseline_note, recorded
from studies.cases.paper import free_rocking_window
from studies.old.arguments import (
    BadInputError,
    Out,
    Place,
    Positive,
    Yes,
    one_of,
    refuse_repeats,
    several,
)
from studies.old.jobs import Job, plain, summary
from studies.old.journal import Row
from studies.old.naming import Sources
from studies.old.options import DEFAULT_RUNNING, Running
from studies.old.plan import Plan, Tables, carry_out
from studies.old.posing import refuse_endless
from studies.measures.differences import conditioning_of_one
from studies.sources.registry import resolve

__all__ = ["command", "finding", "report"]

ANSWERS, MARGINS = "answers", "margins"
"""What a row of the journal is: a source's answer, or how strong a record overturns a block."""
NO_SCALE = 0.0
"""Of a row that is about all factors on a record."""
FACTS = ("kappa", "sensitivity", "min_normal", "friction_needed")
"""Columns of the exact solution, which all sources of a case are read beside."""
FOUND = ("lifts", "margin", "margin_friction", "islands")
"""Columns of a block under a record, at whatever factor."""
SOON_S = 2.0
"""A search for a margin that takes longer [s] shows its progress."""
DIGEST = "record_digest"
"""Column that tells records of the same name apart."""
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
        friction, and its tilt, the rotation that it starts from in units of α.
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
    chosen = plan(listed, grounds, scale, sources, settings, running.time_limit)
    places = {path.name: str(path.absolute()) for path in record}
    return carry_out(STUDY, chosen, out, running, partial(report, places=places))


def plan(
    cabinets: Sequence[Cabinet],
    grounds: Mapping[str, Record],
    scales: Sequence[float],
    sources: Sequence[str],
    settings: Mapping[str, str],
    limit_s: float,
) -> Plan:
    """Return the plan that puts every block to every record, and looks for its margin."""
    asked = list(dict.fromkeys(["exact", *sources]))
    scaled = {name: [_scaled(grounds[name], name, scale) for scale in scales] for name in grounds}
    jobs = []
    digests = {name: digest_of(ground) for name, ground in grounds.items()}
    for cabinet, record in product(cabinets, grounds):
        posed = cabinet, record, digests[record]
        for (scale, ground), source in product(zip(scales, scaled[record], strict=True), asked):
            jobs.append(_job(*posed, ground, scale, source, ANSWERS))
        if isinstance(cabinet.system, RigidBlock):
            jobs.append(_job(*posed, grounds[record], NO_SCALE, "exact", MARGINS))

    def tabulate(rows: Sequence[Row]) -> Tables:
        table = joined(rows)
        return {STUDY.name: table[table["source"].isin(sources)]}

    growing: dict[str, Sequence[Any] | Mapping[str, Row]] = {
        "name": {cabinet.name: _sizes(cabinet) for cabinet in cabinets},
        "record": {name: {DIGEST: digest} for name, digest in digests.items()},
        "scale": [*scales, NO_SCALE],
        "source": asked,
    }
    return Plan(
        jobs=jobs,
        settings=settings,
        growing=growing,
        reduce=partial(reduce, baseline=settings["baseline"], limit_s=limit_s),
        tabulate=tabulate,
    )


def _scaled(ground: Record, name: str, scale: float) -> Record:
    try:
        return ground.scaled(scale)
    except ValueError as error:
        allowed = f"so small that the record {name!r} stays finite"
        raise BadInputError(f"--scale is {scale:g}; it must be {allowed} ({error})") from error


def _sizes(cabinet: Cabinet) -> Row:
    """Return what a block's name means."""
    return {name: value for name, value in asdict(cabinet).items() if name != "name"}


def digest_of(record: Record) -> str:
    """Return what tells a record from another one of the same name."""
    text = json.dumps(record, default=plain)
    return hashlib.sha256(text.encode()).hexdigest()[:12]


def _job(
    cabinet: Cabinet,
    record: str,
    digest: str,
    motion: Record,
    scale: float,
    source: str,
    table: str,
) -> Job:
    # a model of what rocks is not asked about what slides: `joined` marks its row
    known = source == "exact" or resolve(source).engine
    block = cabinet.system if known else cabinet.block
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
            "name": cabinet.name,
            **_sizes(cabinet),
            "record": record,
            DIGEST: digest,
            "scale": scale,
        },
        block=block,
        motion=motion,
        source=source,
        duration=window,
        options=options,
    )


def reduce(job: Job, response: Response, *, baseline: str, limit_s: float) -> Row:
    """Return a source's answer, with what is known of the exact one; or the margin of a block."""
    row = summary(job, response)
    slips = np.cumsum([0.0, *response.slips])
    row["slips"] = len(response.slips)
    row["slid_m"] = math.nan if isinstance(job.block, RigidBlock) else float(np.abs(slips).max())
    if job.labels["table"] == MARGINS:
        return row | _margin(job, limit_s)
    exact = job.source == "exact"
    said = [row["message"], baseline_note(cast(Record, job.motion), baseline or None)]
    row["message"] = "; ".join(filter(None, said))
    if not exact or not isinstance(job.block, RigidBlock):
        return row
    start = job.options.get("start", (0.0, 0.0))
    known = conditioning_of_one(job.block, job.motion, start, response)
    return {**row, **known, **{name: getattr(response, name) for name in FACTS[2:]}}


def _margin(job: Job, limit_s: float) -> Row:
    """Search for the margin of a block; where there is none, the row fails and says why."""
    start = job.options.get("start", (0.0, 0.0))
    with tqdm(delay=SOON_S, leave=False, disable=None, unit=" factors") as bar:
        try:
            found = strength(job.block, cast(Record, job.motion), start, limit_s, bar.update)
        except UndecidedError as error:
            nothing = dict.fromkeys(FOUND, math.nan)
            return {"outcome": Outcome.FAILED.value, "message": str(error), **nothing}
    ends = (dict.fromkeys((f"{low:.4g}", f"{high:.4g}")) for low, high in found.islands)
    words = " ".join(map("-".join, ends))
    return dict(zip(FOUND, (found.lifts, found.margin, found.friction, words), strict=True))


def joined(rows: Sequence[Row]) -> pd.DataFrame:
    """Return the answers, each beside the facts of the exact solution and the margin of its block.

    A factor that was asked for and overturns counts for the margin, too: it may lie in a sliver
    that the search did not see. What slides has no margin, nor an answer of a source that cannot
    let it slide.
    """
    table = pd.DataFrame(rows)
    answers, margins = (table[table["table"] == kind] for kind in (ANSWERS, MARGINS))
    exact = answers[answers["source"] == "exact"]
    fallen = exact[exact["outcome"] == Outcome.OVERTURNED.value]
    asked = fallen.groupby(OF_A_BLOCK, as_index=False).agg(asked=("scale", "min"))
    facts = exact.reindex(columns=[*CASE, "outcome", *FACTS]).rename(columns={"outcome": "exact"})
    found = margins.reindex(columns=[*OF_A_BLOCK, "outcome", *FOUND]).astype({"islands": object})
    whole = (
        answers.drop(columns=["table", *FACTS, *FOUND], errors="ignore")
        .merge(facts, on=CASE)
        .merge(found.rename(columns={"outcome": "search"}), on=OF_A_BLOCK, how="left")
        .merge(asked, on=OF_A_BLOCK, how="left")
        .fillna({"asked": math.inf, "islands": ""})
    )
    whole["margin"] = whole[["margin", "asked"]].min(axis=1, skipna=False)
    flat, needs = whole["search"].isna(), whole["friction_needed"]
    short = whole["friction"] < needs
    weak = short & (whole["scale"] <= whole["margin"])
    weak |= whole["friction"] < whole["margin_friction"]
    pair = [whole[name] for name in OF_A_BLOCK]
    reasons = {
        SLIDES: flat,
        Outcome.FAILED.value: whole["search"] == Outcome.FAILED.value,
        SLIDES_FIRST: weak.groupby(pair).transform("any"),
    }
    whole["no_margin"] = np.select([*reasons.values()], [*reasons], "")
    whole.loc[whole["no_margin"] != "", ["margin", "islands"]] = math.nan, ""
    engines = [name for name in whole["source"].unique() if resolve(name).engine]
    kept = (Outcome.SLID.value, Outcome.AT_REST.value, Outcome.FAILED.value)
    moved = short | (flat & (whole["exact"] != Outcome.AT_REST.value))
    moved &= ~whole["outcome"].isin(kept) & ~whole["source"].isin(engines)
    whole.loc[moved, ["outcome", "peak_ratio"]] = SLIDES_FIRST, math.nan
    whole.loc[short, ["kappa", "sensitivity"]] = math.nan
    return whole.drop(columns=["asked", "exact", "search"])
