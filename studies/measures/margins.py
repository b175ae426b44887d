"""By which factor a record overturns a block, looked up on a short list of factors."""

import math

from analytic.conditioning import scaled
from analytic.response import Outcome
from studies.kit.jobs import Job, Row, answer, unanswered

MARGIN = "margin"
"""Block of a job that looks for a margin; any other one answers."""
FACTORS = [2.0 ** (0.25 * step) for step in range(-8, 9)]


def measure(job: Job) -> Row:
    """Return an answer; or the least of FACTORS on a record that overturns, inf if none does."""
    if job.labels["block"] != MARGIN:
        return answer(job)
    solve = scaled(job.case.system, job.case.motion)
    falls = (each for each in FACTORS if solve(each, 1.0)[1] is Outcome.OVERTURNED)
    return {**unanswered(""), "outcome": "found", "margin": next(falls, math.inf)}
