"""The largest step that is stable, and the largest that is accurate, by bisection of its logarithm.

Stable is a step with which a method gives a finite answer of the right outcome whose free rocking
gains no energy; accurate one with which the peak is right within the band as well.
"""

import functools
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from analytic import simulate
from analytic.response import Response
from studies.cases.extreme import Extreme, contact_settings, takes_spring
from studies.old.jobs import Job, ask
from studies.old.journal import Row
from studies.measures.energy import growth
from studies.measures.verdicts import ENERGY_BAND, Verdict, invalidity, judge
from studies.sources.registry import Source, resolve

START, SMALLEST_STEP, LARGEST_STEP = 0.01, 1e-4, 1.0
"""p dt from which a search sets out, and between which it searches."""
FACTOR = 1.05
"""Factor within which a largest step is found; coarser in a quick study."""
QUICK_FACTOR = 1.3
SAMPLES = 400
OWN_CONTACT = 0.01
"""Time, in units of 1/p, of a contact that does not follow the step."""

PROBLEMS = (
    Extreme(name="peak before an impact", group="steps", half_cycles=1, onsets=1.5),
    Extreme(name="peak after an impact", group="steps"),
    Extreme(name="slender, H/B 50", group="steps", aspect=50.0),
    Extreme(name="squat, H/B 1", group="steps", aspect=1.0),
    Extreme(name="1 cm high", group="steps", width_m=0.01 / 3.0),
    Extreme(name="20 half-cycles", group="steps", half_cycles=20, omega_over_p=4.0, onsets=1.5),
)
QUICK = ("peak after an impact",)


@dataclass(frozen=True, slots=True, kw_only=True)
class Searched(Response):
    """The response with the largest accurate step, or else with START, and what the search found.

    largest_stable, largest_accurate are p dt, nan where none was found; runs is how many it took.
    """

    largest_stable: float
    largest_accurate: float
    runs: int


def step_jobs(sources: Iterable[str], quick: bool) -> list[Job]:
    """Return a search for each problem, source that steps, and contact time to try it with.

    Parameters
    ----------
    sources : iterable of str
        Names; those that do not step are left out.
    quick : bool
        One problem, and steps to QUICK_FACTOR instead of FACTOR.

    Returns
    -------
    list of Job
        Its labels are table ("steps"), case, contact_s [s], nan where a source has none of its own,
        and factor.
    """
    problems = [case for case in PROBLEMS if not quick or case.name in QUICK]
    return [
        search_job(case, source, contact_s, quick)
        for case in problems
        for source in sources
        if resolve(source).stepping
        for contact_s in contact_times(case, source)
    ]


def contact_times(case: Extreme, source: str) -> tuple[float, ...]:
    """Return the contact times [s] to try a source with; nan for one that has none of its own."""
    if is_sprung(source):
        return (math.nan, OWN_CONTACT / case.block.p)
    asked = resolve(source)
    return (asked.used.contact_s if asked.engine else math.nan,)


def is_sprung(source: str) -> bool:
    """Say whether a source is tried with a contact that does not follow the step, too."""
    return source.endswith(":fixed") and takes_spring(resolve(source))


def search_job(case: Extreme, source: str, contact_s: float, quick: bool) -> Job:
    """Return the job of one search."""
    return Job(
        labels={
            "table": "steps",
            "case": case.name,
            "contact_s": contact_s,
            "factor": QUICK_FACTOR if quick else FACTOR,
        },
        block=case.block,
        motion=case.motion,
        source=source,
        duration=case.duration,
        times=np.linspace(case.motion.duration, case.duration, SAMPLES),
    )


def problem(job: Job) -> Extreme:
    """Return the problem of a search."""
    return next(case for case in PROBLEMS if case.name == job.labels["case"])


def search(job: Job, source: Source, time_limit_s: float) -> Response:
    """Run a source with one step after another until both largest steps are known.

    Parameters
    ----------
    job : Job
        Of `step_jobs`.
    source : Source
    time_limit_s : float
        Of one run [s]: an engine's that takes longer is no answer.

    Returns
    -------
    Searched
    """
    limit = {"time_limit_s": time_limit_s} if source.kind == "engine" else {}
    case = problem(job)
    exact = simulate(case.block, case.motion)

    @functools.cache
    def run(step: float) -> Response:
        return ask(replace(job, options={**limit, **_at(job, step)}), source)

    def stable(step: float) -> bool:
        found = run(step)
        grown = growth(case.block, case.motion, found)
        return found.outcome is exact.outcome and not grown > ENERGY_BAND

    def accurate(step: float) -> bool:
        return stable(step) and judge(case, job.source, run(step)).verdict is Verdict.GOOD

    factor = float(job.labels["factor"])
    both = [largest_good(stable, factor), largest_good(accurate, factor)]
    steps = run.cache_info().currsize
    best = run(both[1]) if math.isfinite(both[1]) else run(START)
    return Searched(
        **{name: getattr(best, name) for name in Response.__slots__},
        largest_stable=both[0],
        largest_accurate=both[1],
        runs=steps,
    )


def _at(job: Job, step: float) -> dict[str, Any]:
    """Return the options at a step; a contact with a time of its own does not follow it."""
    time = float(job.labels["contact_s"]) * job.block.p
    if not is_sprung(job.source) or math.isnan(time):
        return {"step": step}
    return {"step": step, "settings": contact_settings(job.source, time, step)}


def largest_good(good: Callable[[float], bool], factor: float) -> float:
    """Return the largest step up to which all steps tried are good; nan if not even the smallest.

    From START to finer steps until one is good, to coarser ones until one is not, and between the
    two. A step beyond the first bad one that happens to be good does not count.
    """
    low = START
    while not good(low):
        low *= 0.25
        if low < SMALLEST_STEP:
            return math.nan
    high = low
    while good(high):
        low = high
        if high >= LARGEST_STEP:
            return LARGEST_STEP
        high = min(2.0 * high, LARGEST_STEP)
    while high > factor * low:
        middle = math.sqrt(low * high)
        low, high = (middle, high) if good(middle) else (low, middle)
    return low


def reduce_steps(job: Job, response: Response) -> Row:
    """Return the columns of steps.csv that follow the labels and source.

    Parameters
    ----------
    job : Job
        Of `step_jobs`.
    response : Response
        From `search`, or one that failed.

    Returns
    -------
    dict
        outcome, "searched" or failed; largest_stable and largest_accurate, p dt, and both over the
        contact time, nan where none was found; runs, invalid (why the reference does not hold) and
        message.
    """
    stable = accurate = math.nan
    runs = 0
    if isinstance(response, Searched):
        stable, accurate, runs = (
            response.largest_stable,
            response.largest_accurate,
            response.runs,
        )
    contact = float(job.labels["contact_s"]) * job.block.p
    case = problem(job)
    return {
        # a search that ends is an answer, though it be that no step is stable
        "outcome": "searched" if runs else response.outcome.value,
        "largest_stable": stable,
        "largest_accurate": accurate,
        "stable_over_contact": stable / contact,
        "accurate_over_contact": accurate / contact,
        "runs": runs,
        "invalid": invalidity(case, job.source, simulate(case.block, case.motion)),
        "message": response.message,
    }
