"""What an answer is worth: the verdict on a method's response to an extreme case."""

import enum
import math
from dataclasses import dataclass, replace

from analytic import simulate
from analytic.response import Outcome, Reason, Response
from studies.cases.extreme import Extreme
from studies.measures.energy import growth
from studies.measures.wrongness import FALL, NO_ANSWER, REST, WORDS, kinds_of
from studies.sources.registry import resolve

BAND, WIDE_BAND = 0.01, 0.1
"""Relative error of the peak that is accurate, and that is still a result."""
ENERGY_BAND = 0.01
"""Rise of the energy of free rocking, over its largest value, that counts as growth."""
EDGE_BAND = 2e-6
"""Relative difference of the amplitude within which an outcome that changes is hard to tell."""
SLIP_BAND = 0.01
"""Slip over the width that counts as sliding."""
SMALLEST = 1e-6
"""Peaks below this part of θcr may go unseen."""
SMALLEST_WORDS = "1e-6"
BANDS = (BAND, WIDE_BAND, ENERGY_BAND, SLIP_BAND, SMALLEST)
"""What the rows of a results folder depend on."""
LEFT = (Reason.SLID, Reason.THROWN)
"""How a run ends that leaves the problem, which is right where the reference does so."""


class Verdict(enum.Enum):
    """What an answer is worth."""

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

    @property
    def sentence(self) -> str:
        """The sentence a reader sees."""
        return _SENTENCES[self]


_SENTENCES = {
    Verdict.GOOD: f"outcome right, peak within {BAND:.0%} or {SMALLEST_WORDS} θcr",
    Verdict.UNSEEN: f"a rocking below {SMALLEST_WORDS} θcr not seen",
    Verdict.COARSE: f"peak within {WIDE_BAND:.0%}",
    Verdict.OFF: f"peak off by more than {WIDE_BAND:.0%}",
    Verdict.SLIDES: f"slides more than {SLIP_BAND:.0%} of B",
    Verdict.ENERGY: f"energy grows by more than {ENERGY_BAND:.0%}",
    Verdict.FALL: WORDS[FALL],
    Verdict.REST: f"{WORDS[REST]}, or the reverse",
    Verdict.FAILED: WORDS[NO_ANSWER],
    Verdict.INVALID: "the reference is not valid here",
}

ACCEPTED = (Verdict.GOOD, Verdict.UNSEEN, Verdict.INVALID)
"""Verdicts that are nobody's failure."""


@dataclass(frozen=True, slots=True)
class Judgement:
    """A verdict with its reason and its numbers.

    Attributes
    ----------
    verdict : Verdict
    reason : str
        Empty where all is right.
    error : float
        Of the peak, relative; nan unless both rocked and survived.
    energy_growth : float
        As of `studies.measures.energy.growth`.
    """

    verdict: Verdict
    reason: str
    error: float
    energy_growth: float


def judge(case: Extreme, source: str, response: Response) -> Judgement:
    """Hold a response to a case against the exact solution, and against what that is valid for.

    Parameters
    ----------
    case : Extreme
    source : str
        Whose response it is.
    response : Response
        Its energy is judged only where it has a history that goes on after the pulse.

    Returns
    -------
    Judgement
        INVALID where the reference does not hold for an engine, unless the response is right all
        the same, or the run broke down.

    Raises
    ------
    studies.sources.registry.UnknownSourceError
        If there is no such source.
    """
    exact = simulate(case.block, case.motion)
    error = relative_error(response, exact)
    grown = growth(case.block, case.motion, response)
    verdict, reason = _verdict(case, response, exact, error, grown)
    why = invalidity(case, source, exact)
    # a run that breaks down is no answer, whatever the reference
    broke = verdict is Verdict.FAILED and response.reason not in LEFT
    if why and not broke and verdict is not Verdict.GOOD:
        verdict, reason = Verdict.INVALID, f"{why} ({reason})"
    return Judgement(verdict, reason, error, grown)


def relative_error(response: Response, exact: Response) -> float:
    """Return the relative error of the peak, peak/exact - 1.

    Parameters
    ----------
    response, exact : Response

    Returns
    -------
    float
        nan unless both rocked and survived.
    """
    if {response.outcome, exact.outcome} != {Outcome.ROCKED}:
        return math.nan
    return response.peak_ratio / exact.peak_ratio - 1.0


def _verdict(
    case: Extreme, response: Response, exact: Response, error: float, grown: float
) -> tuple[Verdict, str]:
    found, right = response.outcome, exact.outcome
    wrong = str(kinds_of([found.value], [right.value])[0])
    slip = response.slip_m / case.block.width
    peak_error = f"peak {error:+.2g} of {exact.peak_ratio:.3g} θcr"
    absolute = abs(error) * exact.peak_ratio
    if wrong == NO_ANSWER:
        return Verdict.FAILED, response.message
    if wrong == REST and found is Outcome.AT_REST and exact.peak_ratio < SMALLEST:
        return Verdict.UNSEEN, f"the exact peak is {exact.peak_ratio:.1e} θcr"
    if wrong:
        edge = f", {EDGE_BAND:g} from its edge" if is_at_an_edge(case, right) else ""
        return Verdict(wrong), f"{found.value}; the exact solution: {right.value}{edge}"
    if grown > ENERGY_BAND:
        return Verdict.ENERGY, f"energy grows by {grown:.2g} in free rocking, {peak_error}"
    if slip > SLIP_BAND:
        return Verdict.SLIDES, f"the pivot slid {slip:.2g} B"
    if math.isnan(error) or abs(error) <= BAND or absolute <= SMALLEST:
        return Verdict.GOOD, ""
    return (Verdict.COARSE if abs(error) <= WIDE_BAND else Verdict.OFF), peak_error


def is_at_an_edge(case: Extreme, outcome: enum.Enum) -> bool:
    """Say whether the exact outcome is another one at an amplitude that hardly differs."""
    near = (replace(case, onsets=case.onsets * (1.0 + s * EDGE_BAND)) for s in (1.0, -1.0))
    return any(simulate(other.block, other.motion).outcome is not outcome for other in near)


def invalidity(case: Extreme, source: str, exact: Response) -> str:
    """Say why an engine may differ from the exact solution.

    Models, solvers and peers solve the same equation and may not.

    Parameters
    ----------
    case : Extreme
    source : str
    exact : Response
        The exact one to the case, with min_normal (in units of the weight) and friction_needed.

    Returns
    -------
    str
        Empty where it may not.
    """
    friction = friction_of(case, source)
    if math.isnan(friction):
        return ""
    if exact.min_normal < 0.0:
        return f"the pivot lifts off: N falls to {exact.min_normal:.2g} m g"
    if exact.friction_needed > friction:
        return f"it slides: friction {exact.friction_needed:.3g} needed, {friction:g} there"
    return ""


def friction_of(case: Extreme, source: str) -> float:
    """Return the coefficient of friction of an engine in a case.

    Parameters
    ----------
    case : Extreme
    source : str

    Returns
    -------
    float
        The case's own, at most what the engine takes, or else the preset's; nan for a source that
        is no engine.

    Raises
    ------
    studies.sources.registry.UnknownSourceError
        If there is no such source.
    """
    asked = resolve(source)
    if asked.kind != "engine":
        return math.nan
    chosen = case.options(source).get("friction")
    if chosen is None:
        chosen = asked.used.settings.friction
    return float(chosen)
