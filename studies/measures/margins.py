"""Which blocks of a grid a record overturns, and by which factor it overturns one."""

import math
from itertools import product

from analytic.block import RigidBlock
from analytic.conditioning import scaled
from analytic.response import Outcome
from studies.kit.jobs import Job, Row, answer, unanswered

GRID = list(product((0.07, 0.09, 0.11, 0.13, 0.15, 0.18, 0.22), (0.25, 0.35, 0.5, 0.7)))
"""Slenderness [rad] and half diagonal [m] of blocks."""
FACTORS = [2.0 ** (0.5 * step) for step in range(-4, 5)]
"""Factors on a record, of which the margin is the least that overturns."""
LETTERS = {Outcome.OVERTURNED: "f", Outcome.FAILED: "?"}


def block_of(alpha: float, radius: float) -> RigidBlock:
    """Return a block by its slenderness [rad] and half diagonal [m]."""
    return RigidBlock(width=2.0 * radius * math.sin(alpha), height=2.0 * radius * math.cos(alpha))


def measure(job: Job) -> Row:
    """Return an answer; or of GRID a letter a block, f for a fall; or the margin of the block."""
    block, motion = job.case.system, job.case.motion
    if job.labels["block"] == "grid":
        found = [scaled(block_of(*sides), motion)(1.0, 1.0)[1] for sides in GRID]
        letters = "".join(LETTERS.get(outcome, "-") for outcome in found)
        return {**unanswered(""), "outcome": "found", "grid": letters}
    if job.labels["block"] == "margin":
        solve = scaled(block, motion)  # type: ignore[arg-type]  # it is a RigidBlock
        falls = (each for each in FACTORS if solve(each, 1.0)[1] is Outcome.OVERTURNED)
        return {**unanswered(""), "outcome": "found", "margin": next(falls, math.inf)}
    return answer(job)
