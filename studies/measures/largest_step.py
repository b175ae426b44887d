"""The largest step that is stable, and the largest that is accurate, by bisection of its logarithm.

Stable is a step with which a method gives a finite answer of the right outcome whose free rocking
gains no energy; accurate one with which the verdict is good as well.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from typing import Any

from analytic.response import Response
from studies.cases.extreme import Extreme, contact_settings, takes_spring
from studies.measures.verdicts import ENERGY_BAND, Verdict, invalidity, judge
from studies.sources.registry import resolve

START, SMALLEST_STEP, LARGEST_STEP = 0.01, 1e-4, 1.0
"""p dt from which a search sets out, and between which it searches."""
FACTOR, QUICK_FACTOR = 1.05, 1.3
"""Factor within which a largest step is found."""
PROBLEMS = (
    Extreme(name="peak before an impact", group="steps", half_cycles=1, onsets=1.5),
    Extreme(name="peak after an impact", group="steps"),
    Extreme(name="slender, H/B 50", group="steps", aspect=50.0),
    Extreme(name="squat, H/B 1", group="steps", aspect=1.0),
    Extreme(name="1 cm high", group="steps", width_m=0.01 / 3.0),
    Extreme(name="20 half-cycles", group="steps", half_cycles=20, omega_over_p=4.0, onsets=1.5),
)


def searches(sources: Sequence[str], quick: bool) -> Iterator[tuple[Extreme, str, float, float]]:
    """Yield problem, source, contact time [s] and factor of each search."""
    for case in PROBLEMS[1:2] if quick else PROBLEMS:
        for source in sources:
            for contact_s in contact_times(case, source):
                yield case, source, contact_s, QUICK_FACTOR if quick else FACTOR


def contact_times(case: Extreme, source: str) -> tuple[float, ...]:
    """Return the contact times [s] to try a source that steps with, nan for none of its own."""
    asked = resolve(source)
    if not asked.stepping:
        return ()
    if _is_sprung(source):  # also one that does not follow the step, of a hundredth of 1/p
        return (math.nan, 0.01 / case.block.p)
    return (asked.used.contact_s if asked.engine else math.nan,)


def _is_sprung(source: str) -> bool:
    """Say whether a source is tried with a contact that does not follow the step, too."""
    return source.endswith(":fixed") and takes_spring(resolve(source))


def largest_steps(
    case: Extreme,
    source: str,
    contact_s: float,
    factor: float,
    ask: Callable[[Mapping[str, Any]], Response],
) -> dict[str, Any]:
    """Return the largest stable and the largest accurate step of a source, p dt.

    `ask` makes of options the response to the case with them. Both steps are nan where none was
    found; message is of the response with the largest accurate step, or else with START.
    """
    contact = contact_s * case.block.p

    @cache
    def run(step: float) -> tuple[Response, dict[str, Any]]:
        options: dict[str, Any] = {"step": step}
        if _is_sprung(source) and not math.isnan(contact):
            options["settings"] = contact_settings(source, contact, step)
        response = ask(options)
        return response, judge(case, source, response)

    def stable(step: float) -> bool:
        response, found = run(step)
        right = response.outcome.value == found["exact_outcome"]
        return right and not found["energy_growth"] > ENERGY_BAND

    def accurate(step: float) -> bool:
        return stable(step) and run(step)[1]["verdict"] == Verdict.GOOD.value

    most = [largest_good(good, factor) for good in (stable, accurate)]
    runs = run.cache_info().currsize
    best, _ = run(START if math.isnan(most[1]) else most[1])
    return {
        # a search that ends is an answer, though it be that no step is stable
        "outcome": "searched",
        "largest_stable": most[0],
        "largest_accurate": most[1],
        "stable_over_contact": most[0] / contact,
        "accurate_over_contact": most[1] / contact,
        "runs": runs,
        "invalid": invalidity(case, source),
        "message": best.message,
    }


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
