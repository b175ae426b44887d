"""Every source asked about one case, and each answer beside the exact solution."""

from __future__ import annotations

import math
from collections.abc import Sequence
from statistics import median
from typing import TYPE_CHECKING, Any

from analytic import RigidBlock
from analytic.response import Outcome, Response
from analytic.slide import SlidingBlock
from engines.scene import System
from studies.kit.jobs import Job, Question, Row
from studies.kit.run import Place, here, run, with_response
from studies.measures.differences import conditioning_of_one
from studies.measures.halving import ELSEWHERE, estimate_of, halved, published_trust

if TYPE_CHECKING:
    from studies.kit.options import (  # it loads the parser, which workers do without
        EffortOptions,
        Yours,
    )


def compare(
    case: Question,
    sources: Sequence[str],
    yours: Yours,
    effort: EffortOptions,
    *,
    place: Place = here,
    estimate: bool = False,
) -> list[Row]:
    """Ask every source, and the exact solution besides; return a row for each.

    `error` is relative, nan unless both rock; `velocity_ratio` is the median of all impacts, and
    `impact_error` the largest of the first ones, in units of 1/p.
    """
    own = yours.options(sources, case.system)
    jobs = [
        Job(labels={}, case=case, source=name, options=effort.options(name) | own.get(name, {}))
        for name in dict.fromkeys(["exact", *sources])
    ]
    finer = [half for job in jobs if (half := halved(job)) is not None] if estimate else []
    every = run([*jobs, *finer], with_response, place)
    rows = {row["source"]: row for row in every[: len(jobs)]}
    halves = {row["source"]: row for row in every[len(jobs) :]}
    exact: Response = rows["exact"]["response"]
    known = {"kappa": math.nan, "sensitivity": math.nan}
    if not isinstance(case.system, SlidingBlock):
        known = conditioning_of_one(case.system, case.motion, case.start, exact)
    for name, row in rows.items():
        row |= {**_beside(row["response"], exact, case.system.p), **known, "exact": exact}
        if estimate:
            own_steps = effort.own and yours.dt is None
            row |= _estimated(row, halves.get(name), case.system, own_steps)
    if yours.friction is not None and yours.friction < exact.friction_needed:
        slides = f"slides: needs {exact.friction_needed:.3g}, has {yours.friction:.3g}"
        rows["exact"]["message"] = "; ".join(filter(None, (rows["exact"]["message"], slides)))
    return [rows[name] for name in sources]


def _beside(response: Response, exact: Response, p: float) -> dict[str, float]:
    error = late = math.nan
    if exact.slips:
        error = _apart(response.slips, exact.slips, math.nan)
    elif exact.outcome is Outcome.ROCKED and math.isfinite(response.peak_ratio):
        error = response.peak_ratio / exact.peak_ratio - 1.0
    ratios = [impact.ratio for impact in response.impacts if impact.velocity_before]
    wanted = [impact.time for impact in exact.impacts[:5]]
    found = [impact.time for impact in response.impacts[: len(wanted)]]
    if wanted and len(found) == len(wanted):
        late = max(abs(one - other) for one, other in zip(found, wanted, strict=True))
    ratio = median(ratios) if ratios else math.nan
    return {"error": error, "velocity_ratio": ratio, "impact_error": late * p}


def _apart(slips: Sequence[float], right: Sequence[float], otherwise: float) -> float:
    """Return the largest error of a slip over the largest; `otherwise` where one is missing."""
    if len(slips) != len(right):
        return otherwise
    pairs = zip(slips, right, strict=True)
    return max(abs(one - other) for one, other in pairs) / max(map(abs, right))


def _estimated(row: Row, finer: Row | None, system: System, own_steps: bool) -> Row:
    """Return the estimate of a row's error and what bounds it, or why there is no bound."""
    if finer is None:
        return {"estimate": math.nan, "bound": math.nan}
    found, trust = estimate_of(row, finer), published_trust(row["source"])
    if row["outcome"] == finer["outcome"] == Outcome.SLID.value:
        found = _apart(row["response"].slips, finer["response"].slips, math.inf)
    if found == math.inf:
        why = f"at half the step: {finer['outcome']}"
    elif not isinstance(system, RigidBlock):
        slides = isinstance(system, SlidingBlock)
        why = "the factor is of a peak" if slides else "the factor was found on blocks"
    else:
        why = "no random cases tell its factor" if trust is None else trust.warning()
    bound = math.nan if why or trust is None else trust.factor * found
    elsewhere = "" if why or own_steps else ELSEWHERE
    message = "; ".join(filter(None, (row["message"], why, elsewhere)))
    return {"estimate": found, "bound": bound, "message": message}


def records(rows: Sequence[Row], note: str = "") -> list[dict[str, Any]]:
    """Return what a reader gets of each row, by name: numbers may be inf or nan."""
    found: list[dict[str, Any]] = []
    for row in rows:
        exact, response = row["exact"], row["response"]
        item = {name: value for name, value in row.items() if name not in ("exact", "response")}
        item["message"] = "; ".join(filter(None, (item["message"], note)))
        item |= {"min_normal": exact.min_normal, "friction_needed": exact.friction_needed}
        item |= {"slips": list(response.slips)} if response.slips else {}
        known = not math.isnan(exact.min_normal)
        item["valid"] = exact.min_normal >= 0.0 if known else None
        found.append({**item, **response.observables})
    return found
