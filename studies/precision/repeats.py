"""The best of several runs: as many as its run time needs to be known."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from time import perf_counter

from analytic.response import Response
from studies.measures.costs import LEAST_RUNS

LEAST_S = 0.02
"""Time [s] spent on runs at least: what is timed in it is warm."""

AGREED = 0.02
"""Part by which the two shortest may differ: a minimum that came twice is no accident."""


def enough(times: Sequence[float], spent_s: float, most_s: float) -> bool:
    """Return whether the shortest of some run times is known, or nothing more may be spent on it.

    Parameters
    ----------
    times : sequence of float
        Run times so far [s], one at least.
    spent_s : float
        How long the runs took with all about them [s].
    most_s : float
        After this time [s] there is no further run.
    """
    if spent_s >= most_s:
        return True
    if len(times) < LEAST_RUNS or spent_s < LEAST_S:
        return False
    shortest, next_shortest = sorted(times)[:2]
    return next_shortest <= (1.0 + AGREED) * shortest


@dataclass(frozen=True, slots=True, kw_only=True)
class Timed(Response):
    """A response whose run time is the best of several.

    Attributes
    ----------
    runs : int
        How often it was timed.
    """

    runs: int

    @classmethod
    def of(cls, response: Response, runs: int) -> "Timed":
        """Return a response as one of so many timed runs."""
        known = {item.name: getattr(response, item.name) for item in fields(Response)}
        return cls(**known, runs=runs)


def best_of(action: Callable[[], Response], most_s: float) -> Timed:
    """Return the response with the shortest run time, and with the shortest set-up time.

    Parameters
    ----------
    action : callable
        Returns a response with its run time; repeated until `enough`.
    most_s : float
        Time [s] after which there is no further run.

    Returns
    -------
    Timed
    """
    return interleaved([action], most_s)[0]


def interleaved(actions: Sequence[Callable[[], Response]], most_s: float) -> list[Timed]:
    """Return the best response of each action, run in turn until the time of each is known.

    What else the machine does for a while meets them all alike, and is over before their last run.

    Parameters
    ----------
    actions : sequence of callable
        Each returns a response with its run time and its set-up time.
    most_s : float
        Time [s] spent at most on each, in the mean.
    """
    began = perf_counter()
    rounds: list[list[Response]] = []
    known = False
    while not known:
        rounds.append([action() for action in actions])
        spent_s = (perf_counter() - began) / len(actions)
        times = [[response.wall_s for response in runs] for runs in zip(*rounds, strict=True)]
        known = all(enough(of_one, spent_s, most_s) for of_one in times)
    return [_best(runs) for runs in zip(*rounds, strict=True)]


def _best(responses: Sequence[Response]) -> Timed:
    best = min(responses, key=lambda response: response.wall_s)
    setup_s = min(response.setup_s for response in responses)
    return Timed.of(replace(best, setup_s=setup_s), len(responses))
