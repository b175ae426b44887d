"""The same case, a little different: by how much does an answer move, and by how much should it?"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from functools import cache
from itertools import product

import pandas as pd

from analytic import conditioning, simulate
from analytic.response import Response
from studies.cases.extreme import Extreme
from studies.old.jobs import Job, summary
from studies.old.journal import Row
from studies.sources.registry import resolve

QUANTITIES = ("amplitude", "width", "friction")
DELTAS = tuple(10.0**-n for n in range(9, 2, -1))
QUICK_DELTAS = (1e-9, 1e-6, 1e-3)
NUDGE = 1e-5
"""Relative difference of the width over which a condition number is taken."""
FRICTION = 1.0
"""Friction that is perturbed: more than these cases need, less than any engine's largest."""

CASES = (
    Extreme(name="before an impact", group="sensitivity", half_cycles=1, onsets=1.5),
    Extreme(name="after an impact", group="sensitivity"),
    Extreme(name="20 half-cycles", group="time", half_cycles=20, omega_over_p=4.0, onsets=1.5),
    Extreme(name="near overturning", group="sensitivity", onsets=1.42),
)
QUICK = ("after an impact",)


def perturbed(case: Extreme, quantity: str, delta: float) -> Extreme:
    """Return the case with one quantity larger by the part `delta`.

    A width changes alone: height, amplitude [m/s2] and frequency [rad/s] of the pulse stay.
    """
    if quantity == "amplitude":
        return replace(case, onsets=case.onsets * (1.0 + delta))
    if quantity == "friction":
        return replace(case, friction=FRICTION * (1.0 + delta))
    omega, wider = case.motion.omega, 1.0 + delta
    changed = replace(
        case,
        width_m=case.width_m * wider,
        aspect=case.aspect / wider,
        onsets=case.onsets / wider,
    )
    return replace(changed, omega_over_p=omega / changed.block.p)


def sensitivity_jobs(sources: Iterable[str], quick: bool) -> list[Job]:
    """Return each case as it is and perturbed, for every source that has the quantity.

    Parameters
    ----------
    sources : iterable of str
        Names; engines alone have a friction.
    quick : bool
        One case, and QUICK_DELTAS instead of DELTAS.

    Returns
    -------
    list of Job
        Its labels are table ("sensitivity"), case, quantity (of QUANTITIES) and delta, the relative
        perturbation, 0 first.
    """
    cases = [case for case in CASES if not quick or case.name in QUICK]
    deltas = (0.0, *(QUICK_DELTAS if quick else DELTAS))
    jobs = []
    for case, source, quantity, delta in product(cases, sources, QUANTITIES, deltas):
        if quantity != "friction" or resolve(source).kind == "engine":
            changed = perturbed(case, quantity, delta)
            labels = {"case": case.name, "quantity": quantity, "delta": delta}
            jobs.append(
                Job(
                    labels={"table": "sensitivity", **labels},
                    block=changed.block,
                    motion=changed.motion,
                    source=source,
                    options=changed.options(source),
                )
            )
    return jobs


def reduce_sensitivity(job: Job, response: Response) -> Row:
    """Return the columns that follow the labels and source.

    Parameters
    ----------
    job : Job
        Of `sensitivity_jobs`.
    response : Response

    Returns
    -------
    dict
        Those of `summary`; kappa, the condition number by the quantity, and exact_change, that of
        ln(peak) of the exact solution: nan without a perturbation.
    """
    case = next(case for case in CASES if case.name == job.labels["case"])
    quantity, delta = job.labels["quantity"], float(job.labels["delta"])
    if delta == 0.0:
        return {**summary(job, response), "kappa": math.nan, "exact_change": math.nan}
    return {
        **summary(job, response),
        "kappa": condition_number(case, quantity),
        "exact_change": exact_change(case, quantity, delta),
    }


@cache
def condition_number(case: Extreme, quantity: str) -> float:
    """Return κ = d ln(peak) / d ln(quantity) of the exact solution.

    By the amplitude it is that of `analytic.conditioning` (EQUATIONS.md, "Condition numbers"); by
    the width a central difference over NUDGE; by the friction, which the exact solution does not
    have, it is zero.

    Parameters
    ----------
    case : Extreme
    quantity : {"amplitude", "width", "friction"}

    Returns
    -------
    float
        nan where the block does not rock and survive.
    """
    if quantity == "friction":
        return 0.0
    if quantity == "amplitude":
        return conditioning(case.block, case.motion)[0]
    up, down = (exact_change(case, quantity, sign * NUDGE) for sign in (1.0, -1.0))
    return (up - down) / (2.0 * NUDGE)


@cache
def exact_change(case: Extreme, quantity: str, delta: float) -> float:
    """Return the change of ln(peak) of the exact solution by a perturbation."""
    changed = perturbed(case, quantity, delta)
    peaks = [simulate(c.block, c.motion).peak_ratio for c in (changed, case)]
    return _log_ratio(*peaks)


def with_growth(rows: pd.DataFrame) -> pd.DataFrame:
    """Add the change of the peak by a perturbation, its growth factor, and that over κ.

    change is that of ln(peak) and growth is abs(change)/delta; growth_over_kappa is 1 where an
    answer moves as κ says, change_over_exact where it moves as far as the exact solution does.
    nan without a perturbation.
    """
    uses = [rows[name] for name in ("case", "source", "quantity")]
    plain = rows["peak_ratio"].where(rows["delta"] == 0.0).groupby(uses).transform("first")
    logs = pd.Series(map(_log_ratio, rows["peak_ratio"], plain), rows.index)
    change = logs.where(rows["delta"] > 0.0)
    growth = change.abs() / rows["delta"].where(rows["delta"] > 0.0)
    kappa = rows["kappa"].abs()
    exact = rows["exact_change"].abs()
    return rows.assign(
        change=change,
        growth=growth,
        growth_over_kappa=(growth / kappa).where(kappa > 0.0),
        change_over_exact=(change.abs() / exact).where(exact > 0.0),
    )


def _log_ratio(after: float, before: float) -> float:
    ratio = after / before if before else math.nan
    return math.log(ratio) if 0.0 < ratio < math.inf else math.nan
