"""Contact models: what each setting of an engine's contact costs and buys, one at a time."""

import functools
import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import Annotated

import numpy as np

from analytic.response import Outcome, Response
from engines import ENGINES, core_engines
from engines.declaration import Stepping
from engines.parts.factors import DEFAULT, OWN_STEPS
from studies.cases.paper import Case, free_rocking_window
from studies.cases.selection import COMPARED_IMPACTS, chosen_cases
from studies.cases.variants import Variant, variants
from studies.contact import STUDY
from studies.contact.report import headline, pictures, report
from studies.kit.arguments import Out, check_engines, several
from studies.kit.jobs import Job, summary
from studies.kit.journal import Row
from studies.kit.options import DEFAULT_RUNNING, Running
from studies.kit.plan import Plan, carry_out
from studies.measures.energy import SAMPLES, energy_drift, growth

__all__ = ["command", "headline", "pictures", "report"]

STEP, QUICK_STEP = 1e-3, 2e-3
"""p dt of every variant but those that are about the step."""
QUICK_ASPECTS = (2, 4)
STRONG = 0.1
"""Impacts faster than this, in units of p alpha, show a velocity ratio."""


def command(
    *,
    out: Out,
    engines: Annotated[tuple[str, ...], several] = core_engines(),
    quick: bool = False,
    running: Running = DEFAULT_RUNNING,
) -> int:
    """Compare contact models: each setting alone, from the best setting and from the defaults.

    Solvers, geometry, friction, compliance, damping, integrators, ... of engines, on cases of the
    paper with half and full sines and H/B of 2, 3 and 4, all at one p dt; those that change the
    defaults at the library's own step too. A failure is an answer: the exit code is 1 only where a
    preset as it is fails at that p dt.

    Parameters
    ----------
    engines
        Names of engines, without a preset.
    quick
        Fewer cases and twice the step: less than a minute on 2 cores.
    """
    check_engines(engines)
    return carry_out(STUDY, plan(engines, quick), out, running, report)


def plan(engines: Sequence[str], quick: bool) -> Plan:
    """Return the plan that puts every variant of some engines to the cases."""
    return Plan(
        jobs=[
            job_of(variant, kind, case, quick, own_step)
            for own_step, asked in ((False, all_variants), (True, of_defaults))
            for variant in asked(engines)
            for kind, case in cases(quick)
        ],
        settings={"quick": quick},
        growing={"engine": engines},
        reduce=reduce,
        needed=unchanged,
    )


def unchanged(rows: Sequence[Row]) -> list[Row]:
    """Return the rows of presets as they are, at equal steps."""
    return [row for row in rows if not row["factor"] and not row["own_step"]]


def all_variants(engines: Sequence[str]) -> list[Variant]:
    """Return every way to set some engines, engine by engine."""
    return [variant for engine in engines for variant in variants(engine)]


def of_defaults(engines: Sequence[str]) -> list[Variant]:
    """Return the ways to set some engines that have a step of the library's own."""
    found = [v for v in all_variants(engines) if v.preset == DEFAULT]
    return [variant for variant in found if variant.factor != OWN_STEPS]


@functools.cache
def cases(quick: bool) -> tuple[tuple[str, Case], ...]:
    """Return the cases and their sets: "typical", and in full "near overturning" too."""
    chosen = [(kind, case) for kind, part in chosen_cases(True).items() for case in part]
    if quick:
        chosen = [(k, c) for k, c in chosen if k == "typical" and c.aspect in QUICK_ASPECTS]
    return tuple(chosen)


def job_of(variant: Variant, kind: str, case: Case, quick: bool, own_step: bool = False) -> Job:
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
