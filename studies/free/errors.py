"""How far a response of free rocking is from the closed forms of its model."""

import itertools
import math

import numpy as np

from analytic import MODELS, RigidBlock
from analytic.criteria import free_amplitude, quarter_period
from analytic.motion import FloatArray
from analytic.response import Outcome, Response
from studies.kit.jobs import Job, summary
from studies.kit.journal import Row

SWINGS = 3
"""Swings after the fall from the tilt that are compared."""
IMPACTS = 20
"""Impacts, at most, over which the times of a source drift from those of the closed form."""
LEAST_SWING = 1e-3
"""Part of alpha that the swing after an impact must reach for its drift to count."""


def reduce(job: Job, response: Response) -> Row:
    """Return how far the free rocking of a released block is from the closed forms of its model.

    The closed forms are `analytic.criteria.quarter_period` (Housner 1963; exactly, by elliptic
    integrals) and `next_amplitude`, by energy. The fall from the tilt counts as a quarter of a
    period, and begins the drift.

    Parameters
    ----------
    job : Job
        Of `studies.free.study.released`: its start is at rest, and its model the source's.
    response : Response
        With the history from the release to the end of the swings that are compared.

    Returns
    -------
    dict
        The columns of `summary`; swings, those that are compared; period_error and decay_error, the
        largest relative errors of the time between impacts and of the next rotation; timed_impacts,
        and drift_p, by how much the last of them is late, in units of 1/p. nan unless the block
        rocked so often.
    """
    model = job.asked.model
    period_error = decay_error = drift = math.nan
    timed = 0
    theta, _ = job.options["start"]
    tops = turning_points(response, theta)
    if response.outcome is Outcome.ROCKED and len(tops) > 1:
        times = [impact.time for impact in response.impacts]
        fall = quarter_period(job.block, theta, model)
        periods = [
            (later - before) / (2.0 * quarter_period(job.block, top, model)) - 1.0
            for before, later, top in zip(times, times[1:], tops[1:], strict=False)
        ]
        period_error = max(map(abs, [times[0] / fall - 1.0, *periods]))
        decays = [
            after / next_amplitude(job.block, before, model) - 1.0
            for before, after in itertools.pairwise(tops)
        ]
        decay_error = max(map(abs, decays))
        swings = swing_times(job.block, theta, model)
        timed = 1 + len(swings)
        if len(times) >= timed:
            drift = (times[timed - 1] - fall - sum(swings)) * job.block.p
    return {
        **summary(job, response),
        "swings": max(len(tops) - 1, 0),
        "period_error": period_error,
        "decay_error": decay_error,
        "timed_impacts": timed,
        "drift_p": drift,
    }


def swing_times(block: RigidBlock, theta: float, model: str) -> list[float]:
    """Return the times between the impacts that are timed, after a fall.

    Each is twice the `quarter_period` of the rotation that it reaches, by energy.

    Parameters
    ----------
    block : RigidBlock
    theta : float
        Rotation [rad] of the release at rest, above 0 and below the model's saddle.
    model : str
        A key of `analytic.MODELS`.

    Returns
    -------
    list of float
        [s], from the first impact on: at most IMPACTS - 1, and none of a swing that stays below
        LEAST_SWING of alpha.

    Raises
    ------
    KeyError
        If there is no such model.
    """
    times: list[float] = []
    top = next_amplitude(block, theta, model)
    while len(times) < IMPACTS - 1 and top >= LEAST_SWING * block.alpha:
        times.append(2.0 * quarter_period(block, top, model))
        top = next_amplitude(block, top, model)
    return times


def next_amplitude(block: RigidBlock, theta: float, model: str) -> float:
    """Return the rotation [rad] that follows the impact after `theta`, by energy."""
    law = MODELS[model].law(block.alpha, block.restitution)
    if not law.linear:
        return free_amplitude(block, theta, 1)
    left = law.eta**2 * theta * (2.0 * law.saddle - theta)
    return left / (law.saddle + math.sqrt(law.saddle**2 - left))


def turning_points(response: Response, theta: float) -> list[float]:
    """Return the rotation [rad] of the release, and the largest in each of the first swings."""
    history = response.history
    if history is None or not response.impacts:
        return []
    size, tops = np.abs(history.theta), [theta]
    times = [impact.time for impact in response.impacts[: SWINGS + 1]]
    for begin, end in itertools.pairwise(times):
        inside = np.nonzero((history.time > begin) & (history.time < end))[0]
        if inside.size < 5:
            break
        tops.append(crest(size, inside))
    return tops


def crest(theta: FloatArray, inside: np.ndarray[tuple[int, ...], np.dtype[np.intp]]) -> float:
    """Return the maximum of the parabola through the largest sample and its neighbours."""
    place = int(inside[np.argmax(theta[inside])])
    place = min(max(place, 1), len(theta) - 2)
    left, top, right = theta[place - 1 : place + 2]
    bend = left - 2.0 * top + right
    return float(top - (right - left) ** 2 / (8.0 * bend)) if bend < 0.0 else float(top)
