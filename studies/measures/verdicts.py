"""The verdict on a method's response to an extreme case, with the numbers that decide it."""

import enum
import math
from functools import cache
from typing import Any

from analytic import conditioning, simulate
from analytic.response import Outcome, Reason, Response
from studies.cases.extreme import Extreme
from studies.measures.history import growth
from studies.measures.wrongness import FALL, NO_ANSWER, REST, kind_of
from studies.sources.registry import resolve

BAND, WIDE_BAND = 0.01, 0.1
"""Relative error of the peak that is accurate, and that is still a result."""
ENERGY_BAND, SLIP_BAND = 0.01, 0.01
"""Rise of the energy of free rocking over its largest value, and slip over B, that count."""
SMALLEST = 1e-6
"""Peaks below this part of θcr may go unseen."""


class Verdict(enum.Enum):
    """How an answer compares with the exact solution."""

    GOOD = "good"
    UNSEEN = "unseen"
    COARSE = "coarse"
    OFF = "off"
    SLIDES = "slides"
    ENERGY = "energy"
    FALL = FALL
    REST = REST
    FAILED = NO_ANSWER
    INVALID = "invalid"


ACCEPTED = (Verdict.GOOD, Verdict.UNSEEN, Verdict.INVALID)
"""Verdicts that are nobody's failure."""


@cache
def reference(case: Extreme) -> tuple[Response, float]:
    """Return the exact response to a case, and how its peak depends on the amplitude, κ."""
    return simulate(case.block, case.motion), conditioning(case.block, case.motion)[0]


def judge(case: Extreme, source: str, response: Response) -> dict[str, Any]:
    """Return the verdict on a source's response, and what compares it with the exact solution.

    It is INVALID where the reference does not hold, unless the answer is right, or the run broke.
    """
    exact, kappa = reference(case)
    both = exact.outcome is Outcome.ROCKED and not kind_of(response, exact)
    error = response.peak_ratio / exact.peak_ratio - 1.0 if both else math.nan
    grown = growth(case.block, case.motion, response)
    verdict, why = _verdict(case, response, error, grown), invalidity(case, source)
    # a run that leaves the problem is right where the reference does so
    left = response.reason in (Reason.SLID, Reason.THROWN)
    if why and verdict is not Verdict.GOOD and (left or verdict is not Verdict.FAILED):
        verdict = Verdict.INVALID
    return {
        "exact_outcome": exact.outcome.value,
        "exact_peak": exact.peak_ratio,
        "error": error,
        "kappa": kappa,
        "energy_growth": grown,
        "slip_widths": response.slip_m / case.block.width,
        "friction": friction_of(case, source),
        "friction_needed": exact.friction_needed,
        "min_normal": exact.min_normal,
        "invalid": why,
        "verdict": verdict.value,
        "failure": response.reason.name if response.reason else "",
    }


def _verdict(case: Extreme, response: Response, error: float, grown: float) -> Verdict:
    exact, found = reference(case)[0], response.outcome
    wrong = kind_of(response, exact)
    if found is Outcome.AT_REST and 0.0 < exact.peak_ratio < SMALLEST:
        return Verdict.UNSEEN
    if wrong:
        return Verdict(wrong)
    if grown > ENERGY_BAND:
        return Verdict.ENERGY
    if response.slip_m / case.block.width > SLIP_BAND:
        return Verdict.SLIDES
    if math.isnan(error) or abs(error) <= BAND or abs(error) * exact.peak_ratio <= SMALLEST:
        return Verdict.GOOD
    return Verdict.COARSE if abs(error) <= WIDE_BAND else Verdict.OFF


def invalidity(case: Extreme, source: str) -> str:
    """Say why an engine may differ from the exact solution; empty where it, or a model, may not."""
    exact, friction = reference(case)[0], friction_of(case, source)
    if math.isnan(friction):
        return ""
    if exact.min_normal < 0.0:
        return f"the pivot lifts off: N falls to {exact.min_normal:.2g} m g"
    if exact.friction_needed > friction:
        return f"it slides: friction {exact.friction_needed:.3g} needed, {friction:g} there"
    return ""


def friction_of(case: Extreme, source: str) -> float:
    """Return an engine's friction in a case, its own or else the preset's; nan of other sources."""
    asked = resolve(source)
    if asked.kind != "engine":
        return math.nan
    return float(case.options(source).get("friction", asked.used.settings.friction))
