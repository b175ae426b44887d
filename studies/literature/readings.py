"""How the printed quantity is read from a source's answers."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import singledispatch

import numpy as np

from analytic.block import housner_restitution
from analytic.criteria import frictionless_fall
from analytic.maps import overturning_modes
from analytic.motion import FloatArray
from analytic.orbits import orbit_limits
from analytic.response import Outcome, Response
from studies.kit.jobs import Job, ask
from studies.kit.journal import Row
from studies.literature.prints import PROBLEMS
from studies.literature.problems import (
    Cascade,
    Drop,
    ModeEnd,
    OrbitLimit,
    Problem,
    Restitution,
    SteadyState,
    Threshold,
)
from studies.measures.orbits import orbit_of, sample_times
from studies.sources.registry import Source

Put = Callable[[Job], Response]

REACH = 0.02
"""Relative distance from the print within which a threshold is looked for."""
FINE, COARSE = 1e-11, 1e-6
"""Relative width to which it is bisected for a model, and for an engine."""
AMPLITUDES = np.geomspace(1.0001, 60.0, 6000)
"""Amplitudes, over g tan alpha, among which overturning after one impact is looked for."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading(Response):
    """A response, and the quantity that is read from it.

    Of a threshold, the response is that at the upper end of the range in which it is looked for.

    Attributes
    ----------
    values : tuple of float
        One number, or two for either side of the block, in the unit of `Problem.quantity`.
    """

    values: tuple[float, ...] = ()


def times_of(problem: Problem) -> FloatArray | None:
    """Return the times [s] at which a problem's response is sampled."""
    return sample_times(problem.pulse) if isinstance(problem, SteadyState | Cascade) else None


NAMED = {problem.name: problem for problem in PROBLEMS}


def solve_problem(job: Job, source: Source) -> Response:
    """Put a printed problem to a source, and read its quantity.

    A threshold is bisected within REACH of the print, to a relative width of COARSE for an engine
    and of FINE for all others; of other problems one response is enough.

    Parameters
    ----------
    job : Job
        Its label problem is a name of `NAMED`.
    source : Source

    Returns
    -------
    Response
        A `Reading`; a failed response with its reason where there is no quantity: the source
        failed, or its orbit does not repeat, or the model of the print has no threshold in that
        range. Where another source has none there, its response with a message.
    """
    problem = NAMED[str(job.labels["problem"])]

    def once(asked: Job) -> Response:
        return ask(asked, source)

    try:
        if isinstance(problem, Threshold):
            return _threshold(problem, job, once, FINE if source.kind != "engine" else COARSE)
        response = once(job)
        if response.outcome is Outcome.FAILED:
            return response
        return _with(response, *read(problem, response, job.source))
    except ValueError as error:
        return Response.failure(str(error))


@singledispatch
def read(problem: Problem, response: Response, source: str) -> tuple[float, ...]:
    """Return the quantity of a problem from a source's response."""
    raise TypeError(f"{problem!r} has no quantity")


@read.register
def _(problem: SteadyState, response: Response, source: str) -> tuple[float, ...]:
    orbit = orbit_of(problem.block, problem.pulse, response)
    if not orbit.period:
        raise ValueError("the response does not settle")
    return math.degrees(orbit.right), math.degrees(orbit.left)


@read.register
def _(problem: Cascade, response: Response, source: str) -> tuple[float, ...]:
    orbit = orbit_of(problem.block, problem.pulse, response)
    if not orbit.period:
        raise ValueError("the response does not repeat")
    return (float(orbit.period),)


@read.register
def _(problem: ModeEnd, response: Response, source: str) -> tuple[float, ...]:
    alpha, eta = problem.block.alpha, problem.block.restitution
    below, above = 0.8 * problem.printed[0].bounds[0], 1.2 * problem.printed[0].bounds[1]
    while above - below > 1e-4 * below:
        middle = 0.5 * (below + above)
        modes = overturning_modes(alpha, AMPLITUDES * math.tan(alpha), middle, 2, source, eta).mode
        below, above = (middle, above) if (modes == 1).any() else (below, middle)
    return (0.5 * (below + above),)


@read.register
def _(problem: OrbitLimit, response: Response, source: str) -> tuple[float, ...]:
    w = problem.pulse.omega / problem.block.p
    birth, loss = orbit_limits(problem.block.restitution, w, problem.half_periods)
    return (birth if problem.birth else loss,)


@read.register
def _(problem: Drop, response: Response, source: str) -> tuple[float, ...]:
    if source == problem.model:
        return frictionless_fall(problem.block, problem.start[0])
    strike = response.impacts[0]
    return strike.time, abs(strike.velocity_before)


@read.register
def _(problem: Restitution, response: Response, source: str) -> tuple[float, ...]:
    return (response.impacts[0].ratio / housner_restitution(problem.block.alpha),)


def _threshold(problem: Threshold, job: Job, once: Put, width: float) -> Response:
    low, high = (
        bound * (1.0 + sign * REACH)
        for bound, sign in zip(problem.printed[0].bounds, (-1.0, 1.0), strict=True)
    )

    def at(amplitude: float) -> Response:
        response = once(replace(job, motion=problem.at(amplitude)))
        if response.outcome is Outcome.FAILED:
            raise ValueError(response.message)
        return response

    first, last = at(low).outcome, at(high)
    if (first is Outcome.OVERTURNED) == (last.outcome is Outcome.OVERTURNED):
        words = f"{first.value} from {low:.4g} to {high:.4g}: no threshold there"
        if job.source == problem.model:
            raise ValueError(words)
        return replace(last, message=words)
    while high - low > width * low:
        middle = 0.5 * (low + high)
        same = (at(middle).outcome is Outcome.OVERTURNED) == (first is Outcome.OVERTURNED)
        low, high = (middle, high) if same else (low, middle)
    return _with(last, 0.5 * (low + high))


def _with(response: Response, *values: float) -> Reading:
    kept = {name: getattr(response, name) for name in Response.__slots__}
    return Reading(**{**kept, "history": None}, values=values)


def reduce(job: Job, response: Response) -> Row:
    """Return the columns that follow a problem's labels and source.

    Parameters
    ----------
    job : Job
    response : Response
        From `solve_problem`.

    Returns
    -------
    dict
        outcome and message, and value and other_side in the unit of the problem's quantity; nan
        where there is none.
    """
    values = response.values if isinstance(response, Reading) else ()
    one, other = (*values, math.nan, math.nan)[:2]
    return {
        "outcome": response.outcome.value,
        "value": one,
        "other_side": other,
        "message": response.message,
    }
