"""Error against run time: every method along its own setting, on the same cases."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from time import perf_counter

import numpy as np
import pandas as pd

from analytic.response import Outcome, Response
from studies.cases.paper import free_rocking_window
from studies.cases.selection import COMPARED_IMPACTS, chosen_cases
from studies.measures.energy import SAMPLES, energy_drift
from studies.old.arguments import Out, TimeLimit
from studies.old.jobs import Job, ask, summary
from studies.old.journal import Row
from studies.old.naming import CORE, Engines
from studies.old.options import Running
from studies.old.plan import Plan, Tables, carry_out
from studies.precision import STUDY, cost
from studies.precision.methods import Method, methods_of
from studies.precision.repeats import Timed, best_of
from studies.precision.report import finding, report
from studies.sources.registry import Source

__all__ = ["command", "finding", "report"]

BUDGET_S, QUICK_BUDGET_S = 0.5, 0.02
"""Time [s] spent at most on timing one case with one setting."""


def command(
    *,
    out: Out,
    engines: Engines = CORE,
    quick: bool = False,
    time_limit: TimeLimit = 60.0,
) -> int:
    """Report error against run time, and what a scene does not need.

    Parameters
    ----------
    engines
        Names of engines, without a preset.
    quick
        Fewer cases and settings: some one and a half minutes.
    time_limit
        Wall-clock time [s] after which one case with one setting is given up.
    """
    alone = Running(jobs=1, time_limit=time_limit)

    def tabulate(rows: Sequence[Row]) -> Tables:
        # what a scene costs is measured where a folder has it not
        known = (out / "scenes.csv").is_file()
        costs = {} if known else cost.measured(engines, quick)
        return {STUDY.name: pd.DataFrame(rows), **costs}

    def both(folder: Path) -> str:
        return f"{report(folder)}\n\n{cost.report(folder)}"

    plan = Plan(
        jobs=precision_jobs(quick, engines),
        settings={"quick": quick},
        growing={"method": list(methods_of(engines))},
        ask=partial(measure, budget_s=QUICK_BUDGET_S if quick else BUDGET_S),
        reduce=reduce,
        tabulate=tabulate,
    )
    return carry_out(STUDY, plan, out, alone, both)


def precision_jobs(quick: bool, engines: Sequence[str]) -> list[Job]:
    """Return a job for every method, setting and case."""
    chosen = chosen_cases(quick)
    return [
        Job(
            labels={"method": name, "value": value, "set": kind, **asdict(case)},
            block=case.block,
            motion=case.motion,
            source=method.source,
            duration=free_rocking_window(case.block, case.motion),
            times=np.linspace(0.0, free_rocking_window(case.block, case.motion), SAMPLES),
            options=method.options_at(value),
        )
        for name, method in methods_of(engines).items()
        for value in (quick_values(method) if quick else method.values)
        for kind, cases in chosen.items()
        for case in cases
    ]


def quick_values(method: Method) -> tuple[float, ...]:
    """Return every other setting of a method without its two dearest."""
    return method.values[: max(len(method.values) - 2, 1) : 2]


def measure(job: Job, source: Source, *, budget_s: float) -> Response:
    """Run a job once with all records, then time it without any: to its peak only.

    Parameters
    ----------
    job : Job
    source : Source
    budget_s : float
        Time [s] after which it is not run again.

    Returns
    -------
    Response
        The recorded one with the outcome, peak and steps of the timed ones, the shortest of their
        run times and of their set-up times.
    """
    recorded = ask(job, source)
    plain = replace(job, duration=None, times=None)

    def timed() -> Response:
        start = perf_counter()
        response = ask(plain, source)
        # by the same clock for all sources, of which only engines know their own
        return replace(response, setup_s=perf_counter() - start - response.wall_s)

    best = best_of(timed, budget_s)
    if Outcome.FAILED in (recorded.outcome, best.outcome):
        return best if best.outcome is Outcome.FAILED else recorded
    return replace(
        Timed.of(recorded, best.runs),
        outcome=best.outcome,
        peak_ratio=best.peak_ratio,
        steps=best.steps,
        wall_s=best.wall_s,
        setup_s=best.setup_s,
    )


def reduce(job: Job, response: Response) -> Row:
    """Return the summary, the set-up time, the runs, the first impacts, the drift of energy."""
    times = [impact.time * job.block.p for impact in response.impacts[:COMPARED_IMPACTS]]
    return {
        **summary(job, response),
        "setup_s": round(response.setup_s, 9),
        "runs": response.runs if isinstance(response, Timed) else 0,
        "impact_times": json.dumps(times),
        "energy_drift": energy_drift(job.block, job.motion, response),
    }
