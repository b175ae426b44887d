"""The verdict on a method's response to an extreme case, with the numbers that decide it."""

import enum
import math
from dataclasses import replace
from functools import cache
from typing import Any

from analytic import conditioning, simulate
from analytic.response import Outcome, Reason, Response
from studies.cases.extreme import Extreme
from studies.measures.energy import growth
from studies.measures.wrongness import FALL, MEANINGS, NO_ANSWER, REST, WORDS, kinds_of
from studies.sources.registry import resolve

BAND, WIDE_BAND = 0.01, 0.1
"""Relative error of the peak that is accurate, and that is still a result."""
ENERGY_BAND, SLIP_BAND = 0.01, 0.01
"""Rise of the energy of free rocking over its largest value, and slip over B, that count."""
EDGE_BAND = 2e-6
"""Relative difference of the amplitude within which an outcome that changes is hard to tell."""
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


SENTENCES = {
    Verdict.GOOD: "outcome right, peak within 1 % or 1e-6 θcr",
    Verdict.UNSEEN: "misses a rocking below 1e-6 θcr",
    Verdict.COARSE: "peak within 10 %",
    Verdict.OFF: "peak off by more than 10 %",
    Verdict.SLIDES: "slides more than 1 % of B",
    Verdict.ENERGY: "energy grows by more than 1 %",
    Verdict.FALL: WORDS[FALL],
    Verdict.REST: f"{WORDS[REST]} ({MEANINGS[REST]})",
    Verdict.FAILED: WORDS[NO_ANSWER],
    Verdict.INVALID: "the reference is not valid here",
}
"""Verdict -> what a reader sees."""

ACCEPTED = (Verdict.GOOD, Verdict.UNSEEN, Verdict.INVALID)
"""Verdicts that are nobody's failure."""


@cache
def reference(case: Extreme) -> tuple[Response, float]:
    """Return the exact response to a case, and how its peak depends on the amplitude, κ."""
    return simulate(case.block, case.motion), conditioning(case.block, case.motion)[0]


def judge(case: Extreme, source: str, response: Response) -> dict[str, Any]:
    """Return the verdict on a source's response, and what compares it with the exact solution.

    The verdict is INVALID where the reference does not hold for an engine, unless the response is
    right all the same, or the run broke down. Its energy counts only where it has a history that
    goes on after the pulse.
    """
    exact, kappa = reference(case)
    both = response.outcome is Outcome.ROCKED is exact.outcome
    error = response.peak_ratio / exact.peak_ratio - 1.0 if both else math.nan
    grown = growth(case.block, case.motion, response)
    verdict, reason = _verdict(case, response, error, grown)
    friction = friction_of(case, source)
    why = invalidity(case, source)
    # a run that leaves the problem is right where the reference does so
    left = response.reason in (Reason.SLID, Reason.THROWN)
    broken = verdict is Verdict.FAILED and not left
    if why and not broken and verdict is not Verdict.GOOD:
        verdict, reason = Verdict.INVALID, f"{why} ({reason})"
    return {
        "exact_outcome": exact.outcome.value,
        "exact_peak": exact.peak_ratio,
        "error": error,
        "kappa": kappa,
        "energy_growth": grown,
        "slip_widths": response.slip_m / case.block.width,
        "friction": friction,
        "friction_needed": exact.friction_needed,
        "min_normal": exact.min_normal,
        "invalid": why,
        "verdict": verdict.value,
        "reason": reason,
        "failure": response.reason.name if response.reason else "",
    }


def _verdict(case: Extreme, response: Response, error: float, grown: float) -> tuple[Verdict, str]:
    exact, found = reference(case)[0], response.outcome
    wrong = str(kinds_of([found.value], [exact.outcome.value])[0])
    slip = response.slip_m / case.block.width
    peak_error = f"peak {error:+.2g} of {exact.peak_ratio:.3g} θcr"
    if wrong == NO_ANSWER:
        return Verdict.FAILED, response.message
    if wrong == REST and found is Outcome.AT_REST and exact.peak_ratio < SMALLEST:
        return Verdict.UNSEEN, f"the exact peak is {exact.peak_ratio:.1e} θcr"
    if wrong:
        edge = f", {EDGE_BAND:g} from its edge" if is_at_an_edge(case) else ""
        return Verdict(wrong), f"{found.value}; the exact solution: {exact.outcome.value}{edge}"
    if grown > ENERGY_BAND:
        return Verdict.ENERGY, f"energy grows by {grown:.2g} in free rocking, {peak_error}"
    if slip > SLIP_BAND:
        return Verdict.SLIDES, f"the pivot slid {slip:.2g} B"
    if math.isnan(error) or abs(error) <= BAND or abs(error) * exact.peak_ratio <= SMALLEST:
        return Verdict.GOOD, ""
    return (Verdict.COARSE if abs(error) <= WIDE_BAND else Verdict.OFF), peak_error


@cache
def is_at_an_edge(case: Extreme) -> bool:
    """Say whether the exact outcome is another one at an amplitude that hardly differs."""
    near = (replace(case, onsets=case.onsets * (1.0 + s * EDGE_BAND)) for s in (1.0, -1.0))
    right = reference(case)[0].outcome
    return any(simulate(other.block, other.motion).outcome is not right for other in near)


def invalidity(case: Extreme, source: str) -> str:
    """Say why an engine may differ from the exact solution; models solve its equation, and may not.

    Empty where it may not.
    """
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
