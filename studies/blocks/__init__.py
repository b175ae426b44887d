"""A list of blocks under recorded ground motions: which overturn, with what margin."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from functools import partial
from hashlib import sha256
from itertools import product
from pathlib import Path
from typing import Annotated, cast

import numpy as np
import pandas as pd
from cyclopts import Parameter

from analytic.accelerograms import Units
from analytic.block import GRAVITY, RigidBlock
from analytic.motion import BothWays
from analytic.record import Record
from analytic.response import Outcome
from analytic.simulate import simulate
from analytic.slide import SlidingBlock
from studies.blocks.cabinets import Cabinet, Unit, read_cabinets
from studies.blocks.fragility import MOST_ONSETS, RESAMPLED, fragility
from studies.blocks.margins import APART, WIDTH, Strength, bounds, strength
from studies.cases.refusal import BadInputError
from studies.kit import arguments
from studies.kit.arguments import Running
from studies.kit.jobs import Job, Question, Row, ask, plain, summary, unanswered
from studies.kit.say import capital, out_of, part
from studies.kit.scene_options import Baseline, baseline_note, read_record, window_of
from studies.kit.study import Figures, Study, Tables, stages
from studies.measures.presets import is_engine

ALL_SCALES = 0.0
"""Scale of the row that is about all factors on a record: how strong it must be."""
CASE, PAIR = ["name", "record", "scale"], ["name", "record"]
FOUND = [*Strength._fields]
"""Columns of a block under a record, at whatever factor."""
COLUMNS = [
    *("name", "width_m", "height_m", "friction", "record", "record_digest", "pga_g", "pgv_m_s"),
    *("baseline", "scale", "source", "outcome", "peak_ratio", "impacts", "steps", "wall_s"),
    *("message", "slip_m", "residual_m", "friction_needed", *FOUND),
]
TAKEN = (*COLUMNS, "no_margin", "vertical", "horizontal_peak_ratio")
"""Names that no further column of a list may have."""
MANY = 100
"""Searches from which on they run in processes, beside each other."""
FLAT, SLIDES_FIRST, LIFTS_OFF = "slides", "slides first", "lifts off"
"""Why a block has no margin, and a model no answer: for want of friction, or of weight."""


def jobs(
    cabinets: Sequence[Cabinet],
    grounds: Mapping[str, Record | BothWays],
    scales: Sequence[float],
    sources: Sequence[str],
    baseline: str = "",
    verticals: Mapping[str, str] | None = None,
) -> list[Job]:
    """Return a job for each block, record, scale and source, and a search for each margin."""
    moves = {
        name: {
            "record": name,
            "record_digest": sha256(json.dumps(ground, default=plain).encode()).hexdigest()[:12],
            "pga_g": level.peak / GRAVITY,
            "pgv_m_s": float(np.abs(level.velocity(level.breakpoints)).max()),
            "baseline": baseline,
            **({"vertical": verticals[name]} if verticals else {}),
        }
        for name, ground in grounds.items()
        for level in [cast(Record, getattr(ground, "level", ground))]
    }
    moved = {}
    for name, scale in product(grounds, [*scales, ALL_SCALES]):
        with arguments.as_bad_input(f"--record {name} times --scale {scale:g}: "):
            moved[name, scale] = grounds[name].scaled(scale or 1.0)
    asked = [*product(scales, sources), (ALL_SCALES, "exact")]
    found, many = list[Job](), len(cabinets) * len(grounds) >= MANY
    for cabinet, name, (scale, source) in product(cabinets, grounds, asked):
        engine, motion = is_engine(source), moved[name, scale]
        # a model of what rocks is not asked about what slides: `tabulate` marks its row
        block = cabinet.system if engine or source == "exact" else cabinet.block
        unasked = engine and bounds(block, motion)[1] <= 1.0  # the exact row says why
        if unasked or (scale == ALL_SCALES and not isinstance(block, RigidBlock)):
            continue
        window = window_of(block, motion)
        listed = asdict(cabinet)
        listed |= listed.pop("further")
        rubs = engine and cabinet.friction is not None
        found.append(
            Job(
                labels={**listed, **moves[name], "scale": scale},
                case=Question(system=block, motion=motion, duration=window),
                source=source,
                options={"friction": cabinet.friction} if rubs else {},
                apart=many and scale == ALL_SCALES,
            )
        )
    return found


def measure(job: Job) -> Row:
    """Return an answer, with the friction of the exact one; or how strong a record overturns."""
    block, motion = cast(RigidBlock, job.case.system), cast("Record | BothWays", job.case.motion)
    level = cast(Record, getattr(motion, "level", motion))
    if job.labels["scale"] == ALL_SCALES:
        try:
            if job.lost is not None:
                raise RuntimeError(job.lost.message)
            found = strength(block, motion)
        except RuntimeError as error:
            return unanswered(str(error))
        return {**unanswered(""), "outcome": "found", **found._asdict()}
    if bounds(block, motion)[1] <= 1.0:
        return {**unanswered(""), "outcome": LIFTS_OFF if isinstance(block, RigidBlock) else FLAT}
    response = ask(job)
    row, note = summary(response), baseline_note(level, job.labels["baseline"] or None)
    row["message"] = "; ".join(filter(None, (row["message"], note)))
    rocks = job.source == "exact" and isinstance(block, RigidBlock)
    if rocks and level is not motion:
        row["horizontal_peak_ratio"] = simulate(block, level).peak_ratio
    places = np.abs(np.cumsum([0.0, *response.slips]))  # it turns back where a slip ends
    if isinstance(block, SlidingBlock) and response.outcome is not Outcome.FAILED:
        row |= {"slip_m": float(places.max()), "residual_m": float(places[-1])}
    return {**row, "friction_needed": response.friction_needed if rocks else math.nan}


def tabulate(rows: pd.DataFrame) -> Tables:
    """Return the answers, each beside the margin of its block and the friction that it needs."""
    # a factor that was asked for and overturns counts for the margin: the search may miss a sliver
    further = [name for name in rows if name not in COLUMNS]
    rows = rows.reindex(columns=[*COLUMNS, *further]).astype({"friction": float})
    answers, margins = rows[rows["scale"] > 0.0], rows[rows["scale"] == ALL_SCALES]
    exact = answers[answers["source"] == "exact"].rename(columns={"outcome": "exact_outcome"})
    exact = exact.set_index(CASE)[["exact_outcome", "friction_needed"]]
    found = margins.rename(columns={"outcome": "searched"}).set_index(PAIR)[["searched", *FOUND]]
    table = answers.drop(columns=["friction_needed", *FOUND]).join(exact, on=CASE)
    table = table.join(found, on=PAIR)
    pair = [table[name] for name in PAIR]
    fallen = table["scale"].where(table["exact_outcome"] == Outcome.OVERTURNED.value, math.inf)
    table["margin"] = table["margin"].clip(upper=fallen.groupby(pair).transform("min"))
    flat, short = table["searched"].isna(), table["friction"] < table["friction_needed"]
    failed = table["searched"] == Outcome.FAILED.value
    weak = short & (table["scale"] <= table["margin"])
    weak |= table["friction"] < table["margin_friction"]
    words = [FLAT, Outcome.FAILED.value, SLIDES_FIRST, LIFTS_OFF]
    weak = weak.groupby(pair).transform("any")
    table["no_margin"] = np.select([flat, failed, weak, table["margin"].isna()], words, "")
    table.loc[table["no_margin"] != "", "margin"] = math.nan
    kept = (Outcome.SLID.value, Outcome.AT_REST.value, Outcome.FAILED.value, FLAT, LIFTS_OFF)
    moved = short | (flat & (table["exact_outcome"] != Outcome.AT_REST.value))
    moved &= ~table["outcome"].isin(kept) & ~table["source"].map(is_engine)
    table.loc[moved, ["outcome", "peak_ratio"]] = SLIDES_FIRST, math.nan
    table = table.drop(columns=["exact_outcome", "searched"])
    several = table["record"].nunique() > 1
    more = {"fragility": fragility(ranked(table))} if several else {}
    if several and table.filter(["horizontal_peak_ratio"]).gt(0.0).any(axis=None):
        more["vertical"] = changes(table)
    return {"blocks": table, **more}


def changes(rows: pd.DataFrame) -> pd.DataFrame:
    """Return what vertical records change of what rocks, for each horizontal record and for all."""
    rows = rows.dropna(subset=["peak_ratio", "horizontal_peak_ratio"])
    peak, alone = rows["peak_ratio"], rows["horizontal_peak_ratio"]
    falls, fell = np.isinf(peak), np.isinf(alone)
    rows = rows.assign(
        cases=1,
        falls=falls & ~fell,
        stands=fell & ~falls,
        share=(falls != fell).astype(float),
        peak=(peak / alone - 1.0).abs().where((peak * alone).between(0.0, math.inf, "neither")),
    )[np.fmax(peak, alone) > 0.0]
    ways = {"cases": "sum", "falls": "sum", "stands": "sum", "share": "mean", "peak": "median"}
    shares = rows.groupby("vertical")["share"].mean()  # it may be that of two horizontal ones
    drawn = np.random.default_rng(0).choice(shares, (RESAMPLED, len(shares))).mean(axis=1)
    rows = pd.concat([rows, rows.assign(record="all records")])
    table = rows.groupby("record", sort=False).agg(ways).reset_index()
    table.loc[len(table) - 1, ["share_low", "share_high"]] = np.quantile(drawn, [0.05, 0.95])
    return table


def ranked(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the first row of each block and record, the least margin of a block first."""
    lines = rows.drop_duplicates(PAIR)
    least = lines.groupby("name")["margin"].transform("min")
    return lines.assign(least=least).sort_values(["least", "name", "margin"]).drop(columns="least")


def finding(tables: Tables) -> str:
    """Say how many blocks overturn, which does so first, and what slides."""
    lines = ranked(tables["blocks"])
    blocks, finite = lines["name"].nunique(), lines[np.isfinite(lines["margin"])]
    if finite.empty:
        words = f"No factor on a record was found to overturn one of {blocks} blocks."
    else:
        first, fallen = finite.iloc[0], lines.loc[lines["margin"] <= 1.0, "name"].nunique()
        words = (
            f"{capital(out_of(fallen, blocks))} blocks overturn at a factor of 1 on a record or "
            f"below; {first['name']} overturns first, at {first['margin']:.4g} times "
            f"{first['record']}."
        )
    if flat := lines.loc[lines["no_margin"] == FLAT, "name"].nunique():
        words += f" {capital(out_of(flat, blocks))} blocks slide and do not rock."
    for word in (SLIDES_FIRST, LIFTS_OFF):
        if short := int((lines["no_margin"] == word).sum()):
            pairs = f"{out_of(short, len(lines))} pairs of a block and a record"
            words += f" In {pairs} the block {word}: no margin holds."
    if "fragility" in tables:
        every = tables["fragility"].query("measure == 'factor'").iloc[-1]
        if np.isfinite(every["median"]):
            spread = f" (spread β {every['beta']:.2g})" if every["beta"] >= 0.0 else ""
            words += (
                f"\n\nUnder half of {every['records']:.0f} records a block of the list overturns "
                f"at the factor {every['median']:.3g} or below{spread}."
            )
    if "vertical" in tables:
        line = tables["vertical"].iloc[-1]
        share, peak, low, high = map(part, line.iloc[-4:])
        words += (
            f"\n\nVertical shaking decides whether a block overturns in {share} of {line['cases']} "
            f"cases that rock (90 % interval {low} to {high}); peaks move by {peak} in the median."
        )
    return words


def shown(tables: Tables) -> Tables:
    """Return the factors and answers of each block and record, and what several records say."""
    rows = tables["blocks"]
    slipped = rows["slip_m"].map(" {:.3g} m".format).where(rows["outcome"] == "slid", "")
    peak = rows["peak_ratio"].map(" {:.3g}".format).where(rows["outcome"] == "rocked", slipped)
    heads = rows["source"] + " × " + rows["scale"].map("{:g}".format)
    cells = rows[PAIR].assign(head=heads, cell=rows["outcome"] + peak)
    answers = cells.pivot(index=PAIR, columns="head", values="cell")[[*heads.unique()]]
    lines = ranked(rows)
    words = lines["margin"].map("{:.4g}".format).where(lines["no_margin"] == "", lines["no_margin"])
    facts = lines.assign(**{
        "B × H [m]": lines["width_m"].map("{:g} × ".format) + lines["height_m"].map("{:g}".format),
        "needed": lines["margin_friction"],
        "overturns at": words,
    })  # fmt: skip
    facts = facts[[*PAIR, "B × H [m]", "friction", "needed", "lifts", "overturns at"]]
    title = "Factors on a record that lift and overturn each block, and outcomes with peaks"
    short = {"What vertical records change": tables["vertical"]} if "vertical" in tables else {}
    if "fragility" in tables:
        over = tables["fragility"].query("measure == 'factor'")
        over = over.drop(columns=["measure", "most", "beta_low", "beta_high"])
        short |= {"Factors that overturn each block, over the records": over}
    return {**short, title: facts.merge(answers, on=PAIR)}


def figures(tables: Tables) -> Figures:
    """Draw the ranking of the blocks."""
    from studies.drawing.blocks import draw_blocks, draw_fragility

    rows, title = tables["blocks"], "The factors on a record that overturn each block"
    drawn = {"blocks": draw_blocks(ranked(rows), sorted(set(rows["scale"])), title)}
    if "fragility" in tables and tables["fragility"]["theta"].notna().any():
        drawn["fragility"] = draw_fragility(tables["fragility"], ranked(rows))
    return drawn


STUDY = Study(
    name="blocks",
    question="Which blocks of a list overturn under recorded ground motions, with what margin?",
    help="",
    texts=("name", "record", "record_digest", "source", "outcome", "no_margin", "vertical"),
    captions={
        "blocks": "Blocks ranked by the factor on a record that overturns them first, "
        "each a line as the key says.",
        "fragility": "Part of the records that overturn a block of the list, by their factor.",
    },
    **stages(jobs, measure, tabulate, finding, shown, figures),
)


def command(
    cabinets: Annotated[arguments.Place, Parameter(name="CABINETS.csv")],
    /,
    *,
    record: Annotated[tuple[arguments.Place, ...], arguments.several],
    out: arguments.Out,
    vertical: Annotated[tuple[arguments.Place, ...] | None, arguments.several_or_none] = None,
    scale: Annotated[tuple[arguments.Positive, ...], arguments.several] = (1.0,),
    pga: arguments.Positive | None = None,
    unit: Annotated[Unit, arguments.one_of(Unit)] = "m",
    record_dt: arguments.Positive | None = None,
    units: Annotated[Units, arguments.one_of(Units)] | None = None,
    baseline: Annotated[Baseline, arguments.one_of(Baseline)] | None = None,
    sources: arguments.Sources = ("exact",),
    running: Running = Running(),  # noqa: B008
) -> int:
    """Find which blocks of a list overturn under recorded ground motions, and their margins.

    The exact solution is always computed, and gives the margins. A block with friction below B/H
    slides; one whose rocking needs more friction than it has is marked "slides first". Neither has
    a margin. Forty blocks under one record take seconds.
    To continue an interrupted run, give the same command again. Writes blocks.csv,
    findings.txt, a picture that ranks the blocks, and blocks.html to hand on.

    Parameters
    ----------
    cabinets
        A table with a line of names: name, width and height of each block, and perhaps its
        friction; further columns are kept. A line that begins with # is a comment.
    record
        Recorded accelerograms, files as `rocking compare --record` takes them.
    vertical
        Acceleration of the base upwards, a file for each of --record, in the same order. Every
        factor is on both. Rows of the exact solution have the peak without it, too.
    scale
        Factors on the records' acceleration.
    pga
        Scale each record to this largest absolute acceleration [g] before.
    unit
        Of width and height, where the name of a column does not state it, as width_mm does.
    record_dt
        Time [s] between the samples of files that do not state it: of one column.
    units
        Of the acceleration in files that do not state them; what a file states holds.
    baseline
        Correct the records by what scipy.signal.detrend takes away: their mean (constant) or the
        line that fits them best (linear).
    """
    arguments.refuse_repeats("--scale", scale)
    arguments.refuse_repeats("--record", [Path(path.name) for path in record])
    raised = vertical or ()
    if raised and (named := len(raised)) != len(record):
        raise BadInputError(
            f"--vertical names {named}; it must name {len(record)}, as --record does"
        )
    read = partial(read_record, units=units, baseline=baseline, dt=record_dt, insist=False)
    grounds = {path.name: read(path) for path in record}
    upward = dict(zip(grounds, map(partial(read, option="--vertical"), raised), strict=False))
    if pga is not None:
        with arguments.as_bad_input("--record scaled to --pga: "):
            upward = {it: upward[it].scaled(pga * GRAVITY / grounds[it].peak) for it in upward}
            grounds = {name: each.scaled_to(pga * GRAVITY) for name, each in grounds.items()}
    listed = read_cabinets(cabinets, unit, TAKEN)
    sources = tuple(dict.fromkeys(["exact", *sources]))
    names = {name: path.name for name, path in zip(upward, raised, strict=True)}
    pairs = {name: BothWays(grounds[name], each) for name, each in upward.items()}
    found = jobs(listed, {**grounds, **pairs}, scale, sources, baseline or "", names)
    given = {"sources": sources, "scale": scale, "units": units, "baseline": baseline, "pga": pga}
    code = STUDY.carry_out(
        out, found, running, record=[*grounds], vertical=names, record_dt=record_dt, **given
    )
    STUDY.hand_on(
        out,
        "blocks/page.html.jinja",
        records=[(name, ground, trace(ground)) for name, ground in grounds.items()],
        rules={"APART": APART, "WIDTH": WIDTH, "MOST_ONSETS": MOST_ONSETS},
    )
    return code


def trace(record: Record, across: int = 300) -> str:
    """Return the points of a line between the least and the most of each part of a record."""
    parts = np.array_split(record.samples / record.peak, min(across, record.samples.size))
    ends = enumerate((part.min(), part.max()) for part in parts)
    return " ".join(f"{x},{20.0 - 19.0 * end:.1f}" for x, pair in ends for end in pair)
