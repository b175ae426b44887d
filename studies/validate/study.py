"""Random cases that no setting was tuned on: sources beside the exact solution, κ among it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, replace
from itertools import islice
from pathlib import Path
from typing import Annotated

import pandas as pd

from studies.cases.drawn import Drawn, draw
from studies.drawing.kept import tell
from studies.old import provenance
from studies.old.arguments import Count, Out, Yes, one_of
from studies.old.jobs import Job
from studies.old.naming import CORE, Sources
from studies.old.options import DEFAULT_RUNNING, OWN_EFFORT, EffortOptions, Running
from studies.old.plan import Plan, by_label, carry_out
from studies.old.tables import write_table
from studies.measures.differences import (
    WELL_CONDITIONED,
    sensitivity_of,
    with_reference,
    with_reference_of_frames,
)
from studies.measures.halving import ELSEWHERE, halved
from studies.sources.registry import Effort
from studies.validate import STUDY
from studies.validate.claims import (
    HALVES,
    bands,
    bounded,
    census,
    finding,
    quantiles,
    width,
    with_bounds,
    worst,
)

S_IS = (
    "S is the largest of κ, κη and the sensitivity: by how many per cent a peak moves for one of "
    "the pulse, or of the velocity ratio of impacts."
)


def command(
    *,
    out: Out,
    cases: Count = 500,
    seed: Count = 1,
    scene: Annotated[Drawn, one_of(Drawn)] = "block",
    sources: Sources = CORE,
    effort: EffortOptions = OWN_EFFORT,
    estimate: bool = False,
    running: Running = DEFAULT_RUNNING,
    yes: Yes = False,
) -> int:
    """Hold the sources against the exact solution on random cases.

    Parameters
    ----------
    cases
        Number of random cases.
    seed
        Seed of the random numbers, a positive whole number; another one draws other cases.
    scene
        block: one block that rocks. frame: a beam on 2 to 5 columns.
    estimate
        Run every engine at half the step, too: the relative difference of the two peaks, and how
        many of the errors it bounds, times the published factor (`rocking estimate`).
    """
    effort.refuse_idle(sources)
    # the exact solution is asked, too, whether a case is kept
    everyone = ("exact", *(3 if estimate else 1) * sources)
    running.refuse_too_much(f"--cases is {cases}", cases, everyone, yes=yes, effort=effort)
    asked = plan(cases, seed, sources, effort, scene=scene, estimate=estimate)
    return carry_out(STUDY, asked, out, running, report)


def plan(
    cases: int,
    seed: int,
    sources: Sequence[str],
    effort: Effort = OWN_EFFORT,
    *,
    scene: Drawn = "block",
    estimate: bool = False,
) -> Plan:
    """Return the plan of random cases for some sources, with `estimate` at half the step, too."""
    drawn = list(islice(draw(seed, scene), cases))
    jobs = [
        Job(
            labels={"table": STUDY.name, **asdict(case)},
            block=case.block,
            motion=case.motion,
            source=source,
            options=effort.options(source),
        )
        for case in drawn
        for source in sources
    ]
    halves = [
        replace(finer, labels={**finer.labels, "table": HALVES})
        for finer in (map(halved, jobs) if estimate else ())
        if finer is not None
    ]
    return Plan(
        jobs=[*jobs, *halves],
        settings={"seed": seed, **asdict(effort), **({} if scene == "block" else {"scene": scene})},
        growing={"case": range(cases), "source": sources},
        tabulate=by_label("table"),
        # half a step that failed is no estimate, and no failure of the study
        needed=lambda rows: [row for row in rows if row["table"] == STUDY.name],
    )


def report(folder: Path) -> str:
    """Hold a folder's tables against the exact solution; write its tables, return the text."""
    settings = provenance.record_of(folder)["settings"]
    compared = compare(folder, "validate")
    if halves := (folder / f"{HALVES}.csv").exists():
        compared = with_bounds(compared, compare(folder, HALVES))
    judged = sensitivity_of(compared)
    scene, kept_cases = settings.get("scene", "block"), compared["case"].nunique()
    left, in_bands = census(settings["seed"], kept_cases, scene), bands(compared)
    kept = {"drawn": left, "bands": in_bands}
    write_table(folder / "errors.csv", compared)
    tables = {
        f"Errors of the peak where both survive, {width(compared)}": quantiles(compared),
        f"The same where S is below {WELL_CONDITIONED:g}": quantiles(
            compared[judged < WELL_CONDITIONED]
        ),
        "Errors over S": quantiles(compared.assign(error=compared["error"] / judged)),
        **{f"In bands of {by}": rows for by, rows in in_bands.groupby("by", sort=False)},
        "The largest errors": worst(compared),
    }
    if halves:
        own = Effort(step=settings["step"], accuracy=settings["accuracy"]).own
        title = "Errors bounded by the difference from half the step, times a factor"
        tables[title if own else f"{title} ({ELSEWHERE})"] = bounded(compared)
    tables["Cases that were drawn"] = left
    for name, table in kept.items():
        write_table(folder / f"{name}.csv", table)
    return tell(STUDY, folder, tables, f"{finding(compared)} {S_IS}")


def compare(folder: Path, table: str) -> pd.DataFrame:
    """Read a table back, and hold it against the exact solution."""
    rows = pd.read_csv(folder / f"{table}.csv", dtype={"message": str})
    return with_reference_of_frames(rows) if "load" in rows else with_reference(rows)
