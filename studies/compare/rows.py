"""Every source asked about one case, and each answer beside the exact solution."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from statistics import median
from typing import TYPE_CHECKING, Any

from analytic import RigidBlock, RockingFrame, frame_faults, simulate
from analytic.motion import Motion, SinePulse
from analytic.record import Record
from analytic.response import Outcome, Response
from analytic.slide import SlidingBlock
from engines.layouts import BEAM_DEPTH, SPACING, System
from studies.cases.paper import free_rocking_window
from studies.cases.refusal import BadInputError
from studies.kit.jobs import Job, Question, Row, ask, summary
from studies.kit.run import Place, here, run
from studies.measures.differences import conditioning_of_one
from studies.measures.halving import ELSEWHERE, estimate_of, halved, published_trust
from studies.sources.registry import DEFAULT_EFFORT, Effort

if TYPE_CHECKING:
    from studies.kit.options import Yours  # it loads the parser, which workers do without


def window_of(system: System, motion: Motion, duration: float | None) -> float:
    """Return for how long a block is watched [s]: as given, or the motion and 8/p."""
    if duration is not None and duration < motion.duration:
        least = f"the length of the motion, {motion.duration:.6g} s"
        raise BadInputError(f"--duration is {duration:g}; it must be at least {least}")
    return free_rocking_window(system, motion) if duration is None else duration


def compare(
    case: Question,
    sources: Sequence[str],
    yours: Yours,
    *,
    place: Place = here,
    effort: Effort = DEFAULT_EFFORT,
    estimate: bool = False,
) -> list[Row]:
    """Ask every source, and the exact solution besides; return a row for each.

    It has the source's response and the exact one. `error` is relative, nan unless both rock;
    `velocity_ratio` is the median, `impact_error` the largest of the first impacts in units of 1/p;
    kappa and sensitivity are of the exact peak; `estimate` needs every engine at half its step.
    """
    own = yours.options(sources, case.system)
    jobs = [
        Job(labels={}, case=case, source=name, options=effort.options(name) | own.get(name, {}))
        for name in dict.fromkeys(["exact", *sources])
    ]
    finer = [half for job in jobs if (half := halved(job)) is not None] if estimate else []
    every = run([*jobs, *finer], measure, place)
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
    said = (rows["exact"]["message"], *_faults(case, exact, yours.friction))
    rows["exact"]["message"] = "; ".join(filter(None, said))
    return [rows[name] for name in sources]


def measure(job: Job) -> Row:
    """Return the columns that every row has, and the response."""
    response = ask(job)
    return {**summary(response), "response": response}


def _beside(response: Response, exact: Response, p: float) -> dict[str, float]:
    error = late = math.nan
    if exact.slips:
        error = _apart(response.slips, exact.slips, math.nan)
    elif response.outcome is Outcome.ROCKED is exact.outcome and exact.peak_ratio > 0.0:
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


def _faults(case: Question, exact: Response, friction: float | None) -> tuple[str, ...]:
    """Return which premises of the exact solution a friction does not hold."""
    if friction is None or exact.outcome is Outcome.FAILED:
        return ()
    slides = f"slides: needs {exact.friction_needed:.3g}, has {friction:.3g}"
    found = (slides,) if friction < exact.friction_needed else ()
    if not isinstance(case.system, RockingFrame):
        return found
    sizes = sizes_of(case.system)
    return (*found, *frame_faults(case.system, case.motion, case.start, **sizes, friction=friction))


def sizes_of(frame: RockingFrame) -> dict[str, float]:
    """Return the distance of a frame's columns and the depth of its beam in the engines [m]."""
    return {"spacing": SPACING * frame.height, "depth": BEAM_DEPTH * frame.height}


def near_edge(case: Question, exact: Response) -> str:
    """Say where less than a hundredth of the amplitude decides whether the block overturns."""
    if exact.outcome is Outcome.FAILED or isinstance(case.system, SlidingBlock):
        return ""
    for factor in (1.01, 0.99):
        motion = _scaled(case.motion, factor)
        other = simulate(case.system, motion, start=case.start, duration=case.duration).outcome
        falls = [outcome is Outcome.OVERTURNED for outcome in (exact.outcome, other)]
        if falls[0] != falls[1] and other is not Outcome.FAILED:
            return (
                f"the answer hangs on less than 1 % of the amplitude: at {factor:g} "
                f"times it, the exact block {'overturns' if falls[1] else 'does not overturn'}"
            )
    return ""


def _scaled(motion: Motion, factor: float) -> Motion:
    if isinstance(motion, SinePulse):
        return replace(motion, amplitude=factor * motion.amplitude)
    return motion.scaled(factor) if isinstance(motion, Record) else motion


def is_valid(exact: Response) -> bool | None:
    """Return whether the pivot stays on the base in the exact solution; None if there is none."""
    return None if math.isnan(exact.min_normal) else exact.min_normal >= 0.0


def records(rows: Sequence[Row], note: str = "") -> list[dict[str, Any]]:
    """Return what a reader gets of each row, by name: numbers may be inf or nan.

    Its columns, with a note at the end of each message; min_normal, friction_needed and valid of
    the exact solution; slips [m] and the observables of the scene where there are any.
    """
    found: list[dict[str, Any]] = []
    for row in rows:
        exact, response = row["exact"], row["response"]
        item = {name: value for name, value in row.items() if name not in ("exact", "response")}
        item["message"] = "; ".join(filter(None, (item["message"], note)))
        item |= {"min_normal": exact.min_normal, "friction_needed": exact.friction_needed}
        item |= {"slips": list(response.slips)} if response.slips else {}
        found.append({**item, "valid": is_valid(exact), **response.observables})
    return found
