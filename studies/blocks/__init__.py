"""A list of blocks under recorded ground motions: which overturn, with what margin."""

from __future__ import annotations

import json
import math
from base64 import b64encode
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from functools import partial
from hashlib import sha256
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import numpy as np
import pandas as pd
from cyclopts import Parameter

from analytic.accelerograms import Units
from analytic.block import RigidBlock
from analytic.record import Record
from analytic.response import Outcome
from studies.blocks import strength
from studies.blocks.cabinets import Cabinet, read_cabinets
from studies.cases.accelerograms import Baseline, baseline_note, recorded
from studies.cases.paper import free_rocking_window
from studies.kit import arguments
from studies.kit.jobs import Job, Question, Row, ask, plain, summary, unanswered
from studies.kit.options import CASE_BYTES, Running, refuse_excess
from studies.kit.say import capital, out_of
from studies.kit.scene_options import refuse_endless
from studies.kit.store import provenance_of
from studies.kit.study import Study, Tables
from studies.kit.tables import write_text
from studies.measures.differences import conditioning_of_one
from studies.sources.registry import resolve

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ALL_SCALES = 0.0
"""Scale of the row that is about all factors on a record: how strong it must be."""
CASE, PAIR = ["name", "record", "scale"], ["name", "record"]
FACTS = ["kappa", "sensitivity", "min_normal", "friction_needed"]
"""Columns of the exact solution, which all sources of a case are read beside."""
FOUND = [*strength.Strength._fields]
"""Columns of a block under a record, at whatever factor."""
SLIDES_FIRST = "slides first"
"""Friction is less than the rocking needs: a block has no margin, a model no answer."""


def jobs(
    cabinets: Sequence[Cabinet],
    grounds: Mapping[str, Record],
    scales: Sequence[float],
    sources: Sequence[str],
    baseline: str = "",
) -> list[Job]:
    """Return the job of every block, record, scale and source, and a search for each margin."""
    text = {name: json.dumps(ground, default=plain) for name, ground in grounds.items()}
    digests = {name: sha256(each.encode()).hexdigest()[:12] for name, each in text.items()}
    moved = {}
    for name, scale in product(grounds, [*scales, ALL_SCALES]):
        with arguments.as_bad_input(f"--record {name} times --scale {scale:g}: "):
            moved[name, scale] = grounds[name].scaled(scale or 1.0)
    asked = [*product(scales, dict.fromkeys(["exact", *sources])), (ALL_SCALES, "exact")]
    found = []
    for cabinet, name, (scale, source) in product(cabinets, grounds, asked):
        engine, motion = resolve(source).engine, moved[name, scale]
        # a model of what rocks is not asked about what slides: `tabulate` marks its row
        block = cabinet.system if engine or source == "exact" else cabinet.block
        if scale == ALL_SCALES and not isinstance(block, RigidBlock):
            continue
        window = free_rocking_window(block, motion)
        refuse_endless(block, window)
        start = (cabinet.tilt or 0.0) * cabinet.block.alpha, 0.0
        moves = {"record": name, "record_digest": digests[name], "baseline": baseline}
        rubs = bool(engine) and cabinet.friction is not None
        found.append(
            Job(
                labels={**asdict(cabinet), **moves, "scale": scale},
                case=Question(system=block, motion=motion, start=start, duration=window),
                source=source,
                options={"friction": cabinet.friction} if rubs else {},
            )
        )
    return found


def measure(job: Job) -> Row:
    """Return an answer, with the facts of the exact one; or how strong a record overturns."""
    block, motion = cast(RigidBlock, job.case.system), cast(Record, job.case.motion)
    if job.labels["scale"] == ALL_SCALES:
        try:
            if job.lost is not None:
                raise RuntimeError(job.lost.message)
            found = strength.strength(block, motion, job.case.start)
        except RuntimeError as error:
            return unanswered(str(error))
        return {**unanswered(""), "outcome": "found", **found._asdict()}
    response = ask(job)
    row, slides = summary(response), not isinstance(block, RigidBlock)
    note = baseline_note(motion, job.labels["baseline"] or None)
    row["message"] = "; ".join(filter(None, (row["message"], note)))
    way = float(np.abs(np.cumsum([0.0, *response.slips])).max())
    row |= {"slips": len(response.slips), "slid_m": way if slides else math.nan}
    if slides or job.source != "exact":
        return row
    row |= conditioning_of_one(block, motion, job.case.start, response)
    return {**row, **{name: getattr(response, name) for name in FACTS[2:]}}


def tabulate(rows: pd.DataFrame, sources: Sequence[str] = ()) -> Tables:
    """Return the answers, each beside the facts of the exact solution and the margin of its block.

    A factor that was asked for and overturns counts for the margin, too: it may lie in a sliver
    that the search did not see. What slides has no margin, nor an answer of a source that cannot
    let it slide.
    """
    answers, margins = rows[rows["scale"] > 0.0], rows[rows["scale"] == ALL_SCALES]
    facts = answers[answers["source"] == "exact"].reindex(columns=[*CASE, "outcome", *FACTS])
    table = (
        answers.drop(columns=["baseline", *FACTS, *FOUND], errors="ignore")
        .merge(facts, on=CASE, suffixes=("", "_exact"))
        .merge(margins.reindex(columns=[*PAIR, "outcome", *FOUND]), on=PAIR, how="left",
               suffixes=("", "_search"))
        .astype({"friction": float, "tilt": float, "islands": object, "slips": int})
    )  # fmt: skip
    pair, exact = [table[name] for name in PAIR], table["outcome_exact"]
    fallen = table["scale"].where(exact == Outcome.OVERTURNED.value, math.inf)
    table["margin"] = table["margin"].clip(upper=fallen.groupby(pair).transform("min"))
    flat, short = table["outcome_search"].isna(), table["friction"] < table["friction_needed"]
    failed = table["outcome_search"] == Outcome.FAILED.value
    weak = short & (table["scale"] <= table["margin"])
    weak |= table["friction"] < table["margin_friction"]
    first = weak.groupby(pair).transform("any")
    words = ["slides", Outcome.FAILED.value, SLIDES_FIRST]
    table["no_margin"] = np.select([flat, failed, first], words, "")
    table.loc[table["no_margin"] != "", ["margin", "islands"]] = math.nan, ""
    engines = table["source"].map(lambda name: bool(resolve(name).engine))
    kept = (Outcome.SLID.value, Outcome.AT_REST.value, Outcome.FAILED.value)
    moved = short | (flat & (exact != Outcome.AT_REST.value))
    moved &= ~table["outcome"].isin(kept) & ~engines
    table.loc[moved, ["outcome", "peak_ratio"]] = SLIDES_FIRST, math.nan
    table.loc[short, ["kappa", "sensitivity"]] = math.nan
    told = table["source"].isin(sources or [*table["source"]])
    return {"blocks": table[told].drop(columns=["outcome_exact", "outcome_search"])}


def ranked(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the first row of each block and record, the least margin of a block first."""
    lines = rows.drop_duplicates(PAIR)
    least = lines.groupby("name")["margin"].transform("min")
    return lines.assign(least=least).sort_values(["least", "name", "margin"]).drop(columns="least")


def finding(tables: Tables) -> str:
    """Say how many blocks overturn under a record as it is, and which does so first."""
    lines = ranked(tables["blocks"])
    blocks, finite = lines["name"].nunique(), lines[np.isfinite(lines["margin"])]
    if finite.empty:
        return f"No factor on a record was found to overturn one of {blocks} blocks."
    first, fallen = finite.iloc[0], lines.loc[lines["margin"] <= 1.0, "name"].nunique()
    return (
        f"{capital(out_of(fallen, blocks))} blocks overturn under a record as it is or weaker; "
        f"{first['name']} overturns first, at {first['margin']:.4g} times {first['record']}."
    )


def shown(tables: Tables) -> Mapping[str, pd.DataFrame]:
    """Return the factors and answers of each block and record, and how many cases end how."""
    rows = tables["blocks"]
    peak, way = rows["peak_ratio"].map(" {:.4g}".format), rows["slid_m"].map(" {:.3g} m".format)
    how = peak.where(rows["outcome"] == "rocked", way.where(rows["outcome"] == "slid", ""))
    heads = rows["source"] + " × " + rows["scale"].map("{:g}".format)
    cells = rows[PAIR].assign(head=heads, cell=rows["outcome"] + how)
    answers = cells.pivot(index=PAIR, columns="head", values="cell")[[*heads.unique()]]
    facts = ["width_m", "height_m", "friction", *FOUND, "no_margin"]
    ends = rows.groupby(["scale", "source"], sort=False)["outcome"].value_counts()
    return {
        "Factors on a record that lift and overturn each block, and outcomes with peaks": (
            ranked(rows)[[*PAIR, *facts]].merge(answers, on=PAIR)
        ),
        "Cases by outcome": ends.unstack(fill_value=0).reset_index(),
    }


def figures(tables: Tables) -> Mapping[str, Figure]:
    """Draw the ranking of the blocks."""
    from studies.drawing.blocks import draw_blocks

    rows, title = tables["blocks"], finding(tables).removesuffix(".")
    return {"blocks": draw_blocks(ranked(rows), sorted(set(rows["scale"])), title)}


STUDY = Study(
    name="blocks",
    question="Which blocks of a list overturn under recorded ground motions, with what margin?",
    help="",
    jobs=jobs,
    measure=measure,
    tabulate=tabulate,
    finding=finding,
    shown=shown,
    figures=figures,
    texts=("name", "record", "record_digest", "source", "outcome", "islands", "no_margin"),
    captions={
        "blocks": "Blocks ranked by the factor on a record that overturns them first; a line from "
        "the factor that lifts a block to the one that overturns it."
    },
)


def command(
    cabinets: Annotated[arguments.Place, Parameter(name="CABINETS.csv")],
    /,
    *,
    record: Annotated[tuple[arguments.Place, ...], arguments.several],
    out: arguments.Out,
    scale: Annotated[tuple[arguments.Positive, ...], arguments.several] = (1.0,),
    record_dt: arguments.Positive | None = None,
    units: Annotated[Units, arguments.one_of(Units)] | None = None,
    baseline: Annotated[Baseline, arguments.one_of(Baseline)] | None = None,
    sources: arguments.Sources = ("exact",),
    running: Running = Running(),  # noqa: B008
) -> int:
    """Which blocks of a list overturn under recorded ground motions, with what margin?

    A block with friction below B/H slides, and where the friction is less than the rocking needs
    its row says "slides first"; neither has a margin. Forty blocks under one record take seconds.
    A run that was interrupted goes on when the same command is given again. Writes blocks.csv,
    findings.txt, a picture that ranks the blocks, and blocks.html to hand on.

    Parameters
    ----------
    cabinets
        A table with a line of names: name, width and height [m] of each block, and perhaps its
        friction, and its tilt, the rotation that it starts from in units of α.
    record
        Recorded accelerograms, files as `rocking compare --record` takes them.
    scale
        Factors on the records' acceleration.
    record_dt
        Time [s] between the samples of files that do not state it: of one column.
    units
        Of the records' acceleration: needed where a file does not state them, refused where one
        states others.
    baseline
        Correct the records by what scipy.signal.detrend takes away: their mean (constant) or the
        line that fits them best (linear).
    """
    from jinja2 import Environment, PackageLoader

    arguments.refuse_repeats("--scale", scale)
    arguments.refuse_repeats("--record", [Path(path.name) for path in record])
    motions = recorded(record, units, baseline, record_dt)
    grounds = {path.name: ground for path, ground in zip(record, motions, strict=True)}
    listed = read_cabinets(cabinets)
    cases = len(listed) * len(grounds) * len(scale)
    asked = f"the list is {str(cabinets)!r}, of {len(listed)} blocks"
    refuse_excess(asked, cases * len(sources) * CASE_BYTES)
    study = replace(STUDY, tabulate=partial(tabulate, sources=sources))
    given = {
        "sources": sources,
        "scale": scale,
        "record_dt": record_dt,
        "units": units,
        "baseline": baseline,
    }
    found = jobs(listed, grounds, scale, sources, baseline or "")
    code = study.carry_out(out, found, running, record=[*grounds], **given)
    tables = STUDY.read(out)
    pages = Environment(loader=PackageLoader("studies.blocks", "."), autoescape=True)
    page = pages.get_template("page.html.jinja").render(
        finding=finding(tables),
        picture=b64encode((out / "blocks.png").read_bytes()).decode(),
        tables={
            title: table.to_html(index=False, na_rep="–", float_format="{:.4g}".format)
            for title, table in shown(tables).items()
        },
        rules=strength,
        made=provenance_of(out),
    )
    write_text(out / "blocks.html", page)
    return code
