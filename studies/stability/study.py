"""Stiff and extreme cases: who stays finite, keeps the outcome, the energy and the peak."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from analytic import simulate
from analytic.response import Reason, Response
from studies.cases.extreme import Extreme, extremes
from studies.drawing.kept import tell
from studies.old.arguments import Out
from studies.old.jobs import Job, summary
from studies.old.jobs import ask as plain
from studies.old.journal import Row
from studies.old.naming import Sources
from studies.old.options import PATIENT_RUNNING, PatientRunning
from studies.old.plan import Plan, by_label, carry_out
from studies.old.tables import table_in, write_table
from studies.measures.presets import engine_of, in_order, in_words, is_engine, preset_of
from studies.measures.verdicts import ACCEPTED, BANDS, Verdict, friction_of, invalidity, judge
from studies.measures.words import NAMED, each_out_of, listed, out_of
from studies.sources.registry import Source, core_sources, resolve
from studies.stability import STUDY
from studies.stability.largest_step import reduce_steps, search, step_jobs
from studies.stability.remedies import NOTHING, Remedied, answer
from studies.stability.sensitivity import (
    condition_number,
    reduce_sensitivity,
    sensitivity_jobs,
    with_growth,
)

__all__ = ["command", "finding", "report"]

METHODS = (
    "exact",
    "rk4",
    "average-acceleration",
    "dop853",
    "radau",
    *core_sources("", "fixed", "naive"),
)
SAMPLES = 400
"""Samples of the free rocking, from which its energy is read."""
RUN_SHARE = 0.02
"""Part of the time limit that each run of a search for a step may take."""


def command(
    *,
    out: Out,
    quick: bool = False,
    running: PatientRunning = PATIENT_RUNNING,
    sources: Sources = METHODS,
) -> int:
    """Put extreme cases to every method.

    Parameters
    ----------
    quick
        Fewer cases, steps to 30 % and three perturbations: less than a minute on 2 cores.
    """
    return carry_out(STUDY, plan(sources, quick, running.time_limit), out, running, report)


def plan(sources: Sequence[str], quick: bool, time_limit_s: float) -> Plan:
    """Return the plan of all three tables."""
    return Plan(
        jobs=[
            *matrix_jobs(sources, quick),
            *step_jobs(sources, quick),
            *sensitivity_jobs(sources, quick),
        ],
        settings={"quick": quick, "bands": BANDS},
        growing={"source": sources},
        ask=functools.partial(ask_for_table, time_limit_s=time_limit_s),
        reduce=reduce,
        tabulate=by_label("table"),
        needed=without_result,
    )


def without_result(rows: Sequence[Row]) -> list[Row]:
    """Return the rows of sources that gave no result at all; other failures are answers."""
    failed = {row["source"] for row in rows if row["outcome"] == "failed"}
    failed -= {row["source"] for row in rows if row["outcome"] != "failed"}
    return [row for row in rows if row["source"] in failed]


def matrix_jobs(sources: Sequence[str], quick: bool) -> list[Job]:
    """Return a job for each extreme case and each source to which it applies."""
    return [
        Job(
            labels={"table": "stability", "group": case.group, "case": case.name},
            block=case.block,
            motion=case.motion,
            source=source,
            duration=case.duration,
            times=np.linspace(case.motion.duration, case.duration, SAMPLES),
            options=case.options(source),
        )
        for case in extremes(quick)
        for source in sources
        if case.applies(source)
    ]


def case_of(job: Job) -> Extreme:
    """Return the extreme case of a job of the matrix."""
    return next(case for case in extremes(False) if case.name == job.labels["case"])


def ask_for_table(job: Job, source: Source, *, time_limit_s: float) -> Response:
    """Put a job of any of the three tables to its source."""
    table = job.labels["table"]
    if table == "steps":
        return search(job, source, RUN_SHARE * time_limit_s)
    if table == "stability":
        return answer(case_of(job), job, source, time_limit_s)
    return plain(job, source)


def reduce(job: Job, response: Response) -> Row:
    """Return the columns that follow the labels of a job's table."""
    table = job.labels["table"]
    if table == "steps":
        return reduce_steps(job, response)
    if table == "sensitivity":
        return reduce_sensitivity(job, response)
    return {**summary(job, response), **judged(case_of(job), job.source, response)}


def judged(case: Extreme, source: str, response: Response) -> Row:
    """Return the columns that hold a response against the reference."""
    exact = simulate(case.block, case.motion)
    found = judge(case, source, response)
    return {
        "exact_outcome": exact.outcome.value,
        "exact_peak": exact.peak_ratio,
        "error": found.error,
        "kappa": condition_number(case, "amplitude"),
        "energy_growth": found.energy_growth,
        "slip_widths": response.slip_m / case.block.width,
        "friction": friction_of(case, source),
        "friction_needed": exact.friction_needed,
        "min_normal": exact.min_normal,
        "invalid": invalidity(case, source, exact),
        "verdict": found.verdict.value,
        "reason": found.reason,
        "failure": response.reason.name if response.reason else "",
        "remedy": response.remedy if isinstance(response, Remedied) else "",
    }


ORDER = tuple(verdict.value for verdict in Verdict)
LARGEST = (
    *("case", "source", "contact_s", "largest_stable", "largest_accurate"),
    *("stable_over_contact", "accurate_over_contact"),
)

UNBOUNDED = (Reason.DIVERGED, Reason.THROWN, Reason.FAULT)
"""Failures in which a response has no bound."""


def report(folder: Path) -> str:
    """Reduce and draw a folder's tables; return the text, which findings.txt holds too."""
    matrix, steps, moved = (
        table_in(folder, name) for name in ("stability", "steps", "sensitivity")
    )
    moved = with_growth(moved)
    write_table(folder / "sensitivity.csv", moved)
    rests, rough = matrix["case"] == "60 s at rest", matrix["case"] == "friction 1e9"
    tables = {
        "Verdicts on the extreme cases": verdicts(matrix),
        "Independent integrators beside the exact solution, which all are held against": (
            peers(matrix)
        ),
        "Failures, those without a bound, and those that another setting mends": mended(matrix),
        "Failures, and the first setting that avoids each": (
            failures(matrix)[["case", "source", "reason", "remedy"]]
        ),
        "Cases for which the reference itself does not hold": (
            matrix.loc[matrix["verdict"] == Verdict.INVALID.value, ["case", "invalid"]]
        ).drop_duplicates("case"),
        "Friction that a library takes instead of 1e9": (
            matrix.loc[rough & (matrix["friction"] < 1e9), ["source", "friction"]]
        ),
        "Creep of a block that shakes without rocking, then rests for 60 s, over its width": (
            matrix.loc[rests, ["source", "slip_widths"]].dropna()
        ),
        "Largest stable and accurate step, p dt, and over the contact's own time": (
            steps.reindex(columns=LARGEST).dropna(how="all")
        ),
        "Change of the peak by a perturbation over that of the exact solution, in the median": (
            growth(moved)
        ),
    }
    return tell(STUDY, folder, tables)


def verdicts(matrix: pd.DataFrame) -> pd.DataFrame:
    """Return how often each source met each verdict."""
    counts = pd.crosstab(matrix["source"], matrix["verdict"])
    columns = [word for word in ORDER if word in counts]
    return counts.loc[list(matrix["source"].unique()), columns].reset_index()


def peers(matrix: pd.DataFrame) -> pd.DataFrame:
    """Return how often each independent integrator of the equation has the exact outcome.

    And how far its peaks are from the exact ones at most, over θcr.
    """
    asked = matrix[matrix["source"].map(lambda source: resolve(source).kind == "peer")]
    off = (asked["peak_ratio"] - asked["exact_peak"]).where(asked["error"].notna()).abs()
    marked = asked.assign(same=asked["outcome"] == asked["exact_outcome"], off=off)
    each = marked.groupby("source", sort=False)
    return each.agg(runs=("same", "size"), same=("same", "sum"), off=("off", "max")).reset_index()


def mended(matrix: pd.DataFrame) -> pd.DataFrame:
    """Return by verdict how many failures there are, of which some have no bound or a remedy."""
    wrong = failures(matrix)
    wrong = wrong.assign(
        unbounded=wrong["failure"].isin([reason.name for reason in UNBOUNDED]),
        mended=~wrong["remedy"].isin(["", NOTHING]),
    )
    counts = {"failures": ("case", "size"), "unbounded": ("unbounded", "sum")}
    each = wrong.groupby("verdict", sort=False)
    return each.agg(**counts, mended=("mended", "sum")).reset_index()


def growth(moved: pd.DataFrame) -> pd.DataFrame:
    """Return the median growth over κ for each source, perturbed quantity and its size."""
    up = moved[moved["delta"] > 0.0]
    medians = up.groupby(["quantity", "source", "delta"], sort=False)["change_over_exact"].median()
    table = medians.unstack("delta")
    table.columns = [f"{delta:.0e}" for delta in table.columns]
    return table.reset_index()


def finding(matrix: pd.DataFrame) -> str:
    """Say how many of the extreme cases each preset gets right, of how many engines and cases.

    Cases beyond what the reference is valid for are in no count.
    """
    found = scores(matrix)
    if found.empty:
        return "No engine was put to the extreme cases."
    engines = list(dict.fromkeys(map(engine_of, found["source"])))
    named = listed(engines) if len(engines) <= NAMED else f"{len(engines)} engines"
    verb = "get" if len(engines) > 1 else "gets"
    parts = [
        f"{in_words(name)} {_counted(found[found['preset'] == name], len(engines))}"
        for name in in_order(found["preset"])
    ]
    return f"Of extreme cases {named} {verb} right: {', '.join(parts)}."


def scores(matrix: pd.DataFrame) -> pd.DataFrame:
    """Return of each engine source, preset, and how many valid cases there are and it has right."""
    valid = matrix["verdict"] != Verdict.INVALID.value
    asked = matrix[matrix["source"].map(is_engine) & valid]
    good = (asked["verdict"] == Verdict.GOOD.value).groupby(asked["source"], sort=False)
    table = good.agg(right="sum", valid="size").reset_index()
    return table.assign(preset=table["source"].map(preset_of))


def _counted(lines: pd.DataFrame, engines: int) -> str:
    """Return how many are right of how many, of each engine or of all; and of how many engines."""
    if len(lines) <= NAMED:
        return each_out_of(lines["right"].tolist(), lines["valid"].tolist())
    few = f" ({len(lines)} engines)" if len(lines) < engines else ""
    return f"{out_of(lines['right'].sum(), lines['valid'].sum())}{few}"


def failures(matrix: pd.DataFrame) -> pd.DataFrame:
    """Return the rows whose verdict is a failure of their source."""
    return matrix[~matrix["verdict"].isin([verdict.value for verdict in ACCEPTED])]
