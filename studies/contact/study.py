"""Contact models: what each setting of an engine's contact costs and buys, one at a time."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import asdict
from itertools import islice
from pathlib import Path
from typing import Annotated, TypeAlias

import numpy as np
import pandas as pd

from analytic import conditioning
from analytic.response import Outcome, Response
from engines import ENGINES
from engines.declaration import Stepping
from engines.parts.factors import (
    AS_BEST,
    BEST,
    BY_DEFAULT,
    DEFAULT,
    OWN_STEPS,
)
from engines.scene import Scene
from studies.cases.drawn import Drawn, RandomCase, draw
from studies.cases.paper import Case, free_rocking_window
from studies.cases.selection import COMPARED_IMPACTS, chosen_cases
from studies.cases.variants import Variant, preset_values, variants
from studies.contact import STUDY
from studies.drawing.kept import tell
from studies.old.arguments import BadInputError, Out, one_of
from studies.old.jobs import Job, summary
from studies.old.journal import Row
from studies.old.naming import CORE, Engines
from studies.old.options import DEFAULT_RUNNING, Running
from studies.old.plan import Plan, carry_out
from studies.old.tables import write_table
from studies.measures.differences import (
    WELL_CONDITIONED,
    with_reference,
    with_reference_of_frames,
)
from studies.measures.energy import SAMPLES, energy_drift, growth
from studies.measures.words import listed, part
from studies.measures.wrongness import FALL, NO_ANSWER, REST, wrong_in
from studies.sources.registry import resolve

__all__ = ["command", "finding", "report"]

STEP, QUICK_STEP = 1e-3, 2e-3
"""p dt of every variant but those that are about the step."""
QUICK_ASPECTS = (2, 4)
STRONG = 0.1
"""Impacts faster than this, in units of p alpha, show a velocity ratio."""
SEED, FRAMES = 1, 4
"""Of the random frames, and how many of them are asked about."""

AnyCase: TypeAlias = "Case | RandomCase"
"""A case of the paper, or a random frame."""


def command(
    *,
    out: Out,
    engines: Engines = CORE,
    scene: Annotated[Drawn, one_of(Drawn)] = "block",
    quick: bool = False,
    running: Running = DEFAULT_RUNNING,
) -> int:
    """Compare contact models: each setting alone, from the best setting and from the defaults.

    Parameters
    ----------
    engines
        Names of engines, without a preset.
    scene
        block: cases of the paper. frame: random frames, a beam on 2 to 5 columns.
    quick
        Fewer cases and twice the step: less than a minute on 2 cores.
    """
    return carry_out(STUDY, plan(engines, quick, scene), out, running, report)


def plan(engines: Sequence[str], quick: bool, scene: Drawn = "block") -> Plan:
    """Return the plan that puts every variant of some engines to the cases."""
    asked_about = cases(quick) if scene == "block" else frame_cases(quick)
    jobs = [
        job_of(variant, kind, case, quick, own_step)
        for own_step in (False, True)
        for variant in all_variants(engines)
        if not own_step or has_own_step(variant)
        for kind, case in asked_about
        if scene == "block" or holds(variant, case)
    ]
    if not jobs:
        words = f"none of --engines is built for it: {', '.join(engines)}"
        raise BadInputError(f"--scene is {scene!r}; {words}")
    return Plan(
        jobs=jobs,
        settings={"quick": quick, **({} if scene == "block" else {"scene": scene})},
        growing={"engine": engines},
        reduce=reduce if scene == "block" else reduce_frame,
        needed=unchanged,
    )


def unchanged(rows: Sequence[Row]) -> list[Row]:
    """Return the rows of presets as they are, at equal steps."""
    return [row for row in rows if not row["factor"] and not row["own_step"]]


def all_variants(engines: Sequence[str]) -> list[Variant]:
    """Return every way to set some engines, engine by engine."""
    return [variant for engine in engines for variant in variants(engine)]


def has_own_step(variant: Variant) -> bool:
    """Say whether a way to set an engine is asked at the library's own step, too."""
    return variant.preset == DEFAULT and variant.factor != OWN_STEPS


@functools.cache
def cases(quick: bool) -> tuple[tuple[str, Case], ...]:
    """Return the cases and their sets: "typical", and in full "near overturning" too."""
    chosen = [(kind, case) for kind, part in chosen_cases(True).items() for case in part]
    if quick:
        chosen = [(k, c) for k, c in chosen if k == "typical" and c.aspect in QUICK_ASPECTS]
    return tuple(chosen)


@functools.cache
def frame_cases(quick: bool) -> tuple[tuple[str, RandomCase], ...]:
    """Return the first random frames that rock and survive, with a κ below WELL_CONDITIONED."""
    calm = (
        case
        for case in draw(SEED, "frame")
        if np.abs(conditioning(case.block, case.motion)).max() < WELL_CONDITIONED
    )
    return tuple(("typical", case) for case in islice(calm, FRAMES // 2 if quick else FRAMES))


def holds(variant: Variant, case: AnyCase) -> bool:
    """Say whether a variant's preset is built for a case: some are for one block alone."""
    asked = resolve(variant.source)
    scene = Scene(system=case.block, motion=case.motion, preset=asked.preset)
    return not asked.declared.lacks(scene, asked.used)


def job_of(variant: Variant, kind: str, case: AnyCase, quick: bool, own_step: bool = False) -> Job:
    """Return the job of a variant and a case, at the library's own step or at that of all."""
    options = {"settings": dict(variant.settings), **variant.scene}
    stepping = ENGINES[variant.engine].preset(variant.preset).stepping
    if stepping is Stepping.FIXED and variant.factor != OWN_STEPS and not own_step:
        options["step"] = QUICK_STEP if quick else STEP
    window = free_rocking_window(case.block, case.motion)
    return Job(
        labels={
            "engine": variant.engine,
            "preset": variant.preset,
            "factor": variant.factor,
            "level": variant.level,
            "trap": variant.trap,
            "own_step": own_step,
            "set": kind,
            **asdict(case),
        },
        block=case.block,
        motion=case.motion,
        source=variant.source,
        duration=window,
        times=np.linspace(0.0, window, SAMPLES),
        options=options,
    )


def reduce(job: Job, response: Response) -> Row:
    """Return the summary, the velocity ratio and its e, slip, penetration and energy."""
    ratio = velocity_ratio(job, response)
    width = job.block.width
    return {
        **summary(job, response),
        "velocity_ratio": ratio,
        "ratio_over_eta": ratio / job.block.restitution,
        "newton_e": newton_e(ratio, job.block.alpha),
        "slip_widths": response.slip_m / width,
        "sink_widths": response.sink_m / width,
        "energy_drift": energy_drift(job, response),
        "energy_growth": growth(job.block, job.motion, response),
    }


def reduce_frame(job: Job, response: Response) -> Row:
    """Return the same of a frame, whose velocity ratio implies no e of a single corner."""
    return {**reduce(job, response), "newton_e": math.nan}


def velocity_ratio(job: Job, response: Response) -> float:
    """Return the median velocity ratio of the first impacts that are strong enough; or nan."""
    if response.outcome is Outcome.FAILED:
        return math.nan
    least = STRONG * job.block.p * job.block.alpha
    strong = [i.ratio for i in response.impacts if abs(i.velocity_before) > least]
    return float(np.median(strong[:COMPARED_IMPACTS])) if strong else math.nan


def newton_e(ratio: float, alpha: float) -> float:
    """Return the Newton coefficient e of the corner that lands that a velocity ratio implies.

    The ratio is 1 - 3/2 (1 + e) sin^2(alpha), Housner's where e = 0.
    """
    return (1.0 - ratio) / (1.5 * math.sin(alpha) ** 2) - 1.0


KEY = ["engine", "preset", "factor", "level"]
"""Columns that tell one variant from another."""

FOUND = ["failed", "wrong", "max_error"]
"""What a variant is judged by: outcomes of all cases, peaks of typical ones."""


def report(folder: Path) -> str:
    """Reduce and draw a folder's contact.csv; write and return what it shows as text."""
    rows = STUDY.read(folder, "contact")
    lines, own = variant_table(rows[~rows["own_step"]]), variant_table(rows[rows["own_step"]])
    for name, table in {"variants": lines, "own-steps": own}.items():
        write_table(folder / f"{name}.csv", table)
    plain = lines["factor"] == ""
    measured = ["ratio_over_eta", "newton_e", "slip_widths", "sink_widths", "step_s"]
    engines = lines["engine"].unique()
    tables = {
        "Presets as they are": lines.loc[
            plain, ["engine", "preset", "cases", *FOUND, "median_error", *measured]
        ],
        "Defaults at their own step": lines.loc[
            lines["factor"] == OWN_STEPS, ["engine", "level", *FOUND]
        ],
        **{
            f"What to set in {engine}: left at its default, and alone": recommendation(
                lines, engine
            )
            for engine in engines
        },
        "Traps": lines.loc[(lines["trap"] != "") & ~plain, [*KEY, *FOUND, "trap"]],
    }
    return tell(STUDY, folder, tables)


def variant_table(rows: pd.DataFrame) -> pd.DataFrame:
    """Return one line for each variant: its errors, what it changes, its impact, its cost."""
    framed = "load" in rows
    compared = with_reference_of_frames(rows) if framed else with_reference(rows)
    case = ["set", "case"] if framed else ["set", "figure", "aspect"]
    base = compared[compared["factor"] == ""].set_index(["engine", "preset", *case])["peak_ratio"]
    base = base.where(np.isfinite(base))  # a preset that overturns has no peak to move
    own = base.reindex(pd.MultiIndex.from_frame(compared[["engine", "preset", *case]])).to_numpy()
    kinds = wrong_in(compared)
    compared = compared.assign(
        moved=(compared["peak_ratio"] / own - 1.0).where(compared["error"].notna()).abs(),
        typical=compared["error"].abs().where(compared["set"] == "typical"),
        step_s=compared["wall_s"] / compared["steps"].clip(lower=1),
        failed=kinds == NO_ANSWER,
        wrong=kinds.isin((FALL, REST)),
    )
    groups = compared.groupby(KEY, sort=False)
    table = groups.agg(
        trap=("trap", "first"),
        cases=("outcome", "size"),
        failed=("failed", "sum"),
        wrong=("wrong", "sum"),
        median_error=("typical", "median"),
        max_error=("typical", "max"),
        moved=("moved", "max"),
        ratio_over_eta=("ratio_over_eta", "median"),
        newton_e=("newton_e", "median"),
        slip_widths=("slip_widths", "max"),
        sink_widths=("sink_widths", "max"),
        energy_drift=("energy_drift", "median"),
        energy_growth=("energy_growth", "max"),
        step_s=("step_s", "median"),
        message=("message", "max"),
    ).reset_index()
    first = table.groupby(["engine", "preset"])[["ratio_over_eta", "wrong"]].transform("first")
    return table.assign(
        ratio_moved=(table["ratio_over_eta"] / first["ratio_over_eta"] - 1.0).abs(),
        worse=(table["failed"] > 0) | (table["wrong"] > first["wrong"]),
    )


def recommendation(lines: pd.DataFrame, engine: str) -> pd.DataFrame:
    """Return a line for each tuned setting of an engine, the one that matters most first.

    What it moves and what errors it leaves where the tuned preset has it at the library's default;
    and, in columns that end in alone, where it is all that is tuned of the defaults. What breaks a
    case matters most, then what moves a peak or an impact.
    """
    lines = lines[lines["engine"] == engine].set_index("factor")
    left = lines[(lines["preset"] == BEST) & (lines["level"] == BY_DEFAULT)]
    alone = lines[(lines["preset"] == DEFAULT) & (lines["level"] == AS_BEST)]
    both = alone.merge(left, "left", on="factor", suffixes=("_alone", ""))
    breaks = both[["worse", "worse_alone"]].eq(True).any(axis=1)
    matter = both.filter(like="moved").max(axis=1).mask(breaks, math.inf)
    names = {factor.name: factor.settings for factor in ENGINES[engine].factors}
    values = [preset_values(engine, BEST, names[factor]) for factor in both.index]
    tuned = [", ".join(f"{name} {value}" for name, value in each.items()) for each in values]
    shown = ["moved", "ratio_moved", *FOUND, *(f"{name}_alone" for name in FOUND)]
    table = both[shown].set_axis(pd.Index(tuned, name="set"))
    return table.iloc[(-matter).argsort(kind="stable")].reset_index()


MATTERS = 1.1
"""Errors over that of the tuned preset from which a setting is what they come from."""


def finding(lines: pd.DataFrame) -> str:
    """Say which setting, left at its default, leaves the largest error in each engine."""
    left = lines[(lines["preset"] == BEST) & (lines["level"] == BY_DEFAULT)]
    worst = left.sort_values("max_error", ascending=False).drop_duplicates("engine").sort_index()
    tuned = lines[(lines["preset"] == BEST) & (lines["factor"] == "")]
    own = worst["engine"].map(tuned.set_index("engine")["max_error"])
    matters = worst["max_error"] > MATTERS * own
    words = [
        f"{line['factor']} in {line['engine']} ({part(line['max_error'])})"
        for _, line in worst[matters].iterrows()
    ]
    said = (
        "Of a tuned contact, the setting whose default alone leaves the largest error is "
        f"{listed(words)}"
    )
    others = [
        f"{engine} ({part(error)})"
        for engine, error in zip(worst.loc[~matters, "engine"], own[~matters], strict=True)
    ]
    beside = f"; none errs by more than as tuned in {listed(others)}" if others else ""
    return f"{said}{beside}."
