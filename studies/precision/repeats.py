"""The best of several runs: as many as its run time needs to be known."""

import time
from collections.abc import Callable, Sequence

from analytic.response import Response

RUNS = 3
"""So many runs at least."""

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
    if len(times) < RUNS or spent_s < LEAST_S:
        return False
    shortest, next_shortest = sorted(times)[:2]
    return next_shortest <= (1.0 + AGREED) * shortest


def best_of(action: Callable[[], Response], most_s: float) -> tuple[Response, float]:
    """Return the response with the shortest run time, and the shortest set-up time [s].

    The action is repeated until `enough`.
    """
    began = time.perf_counter()
    responses = [action()]
    times = [responses[0].wall_s]
    while not enough(times, time.perf_counter() - began, most_s):
        responses.append(action())
        times.append(responses[-1].wall_s)
    best = min(responses, key=lambda response: response.wall_s)
    return best, min(response.setup_s for response in responses)
