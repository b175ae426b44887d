"""Stiff and extreme cases: who stays finite, keeps the outcome, the energy and the peak."""

import functools
from collections.abc import Sequence
from typing import Annotated

import numpy as np

from analytic import simulate
from analytic.response import Response
from studies.cases.extreme import Extreme, extremes
from studies.kit.arguments import Out, check_sources
from studies.kit.jobs import Job, summary
from studies.kit.jobs import ask as plain
from studies.kit.journal import Row
from studies.kit.naming import several_sources
from studies.kit.options import PATIENT_RUNNING, PatientRunning
from studies.kit.plan import Plan, by_label, carry_out
from studies.measures.verdicts import BANDS, friction_of, invalidity, judge
from studies.sources.groups import core_sources
from studies.sources.registry import Source
from studies.stability import STUDY
from studies.stability.largest_step import reduce_steps, search, step_jobs
from studies.stability.remedies import Remedied, answer
from studies.stability.report import again, headline, pictures, report
from studies.stability.sensitivity import condition_number, reduce_sensitivity, sensitivity_jobs

__all__ = ["again", "command", "headline", "pictures", "report"]

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
    sources: Annotated[tuple[str, ...], several_sources] = METHODS,
) -> int:
    """Put extreme cases to every method.

    Parameters
    ----------
    quick
        Fewer cases, steps to 30 % and three perturbations: less than a minute on 2 cores.
    sources
        Who is asked.
    """
    check_sources(sources)
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
