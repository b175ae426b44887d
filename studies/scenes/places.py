"""The pulses of several scenes, and the steps by which an impact falls elsewhere in one."""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterator
from dataclasses import replace
from functools import cache
from typing import cast

from analytic import simulate
from analytic.motion import Motion
from engines.declaration import Stepping
from engines.layouts import System
from studies.old.jobs import Job
from studies.sources.registry import resolve

PULSES = ((0.4, 6.2832), (0.45, 8.0), (0.5, 9.0))
"""Amplitude [g] and circular frequency [rad/s] of full sines."""


def own_step(source: str, p: float) -> float:
    """Return the ordinary step of an engine with equal steps, times p; nan of other sources.

    Parameters
    ----------
    source : str
    p : float
        Frequency of the block [rad/s], for a step that is declared in seconds.
    """
    used = resolve(source).used if resolve(source).engine else None
    if used is None or used.stepping is not Stepping.FIXED:
        return math.nan
    return used.step if math.isfinite(used.step) else used.step_s * p


def placed(job: Job, phases: int, refined: float) -> Iterator[Job]:
    """Yield a job in steps by which the first impact falls into different parts of equal ones.

    With n = t/dt steps before an impact at t, a step of dt (1 + k/(N n)) has it the part k/N of a
    step earlier, for k = 0, 1, ..., N - 1. k is the label phase. A source without equal
    steps is asked once.

    Parameters
    ----------
    job : Job
        Of a frame, without options; its exact response has an impact.
    phases : int
        N, at least 1.
    refined : float
        Steps over the source's own; at another than 1 only who takes equal steps is asked.
    """
    step = own_step(job.source, job.block.p)
    if math.isnan(step):
        if refined == 1.0:
            yield replace(job, labels={**job.labels, "phase": 0})
        return
    impact = first_impact(job.block, cast(Hashable, job.motion), job.duration) * job.block.p
    for phase in range(phases):
        moved = step * (1.0 + phase / phases * step / impact)
        labels = {**job.labels, "phase": phase}
        yield replace(job, labels=labels, options={"step": refined * moved})


@cache  # one for all sources
def first_impact(block: System, motion: Hashable, duration: float | None) -> float:
    """Return when the exact response has its first impact [s], as of `analytic.simulate`."""
    return float(simulate(block, cast(Motion, motion), duration=duration).impacts[0].time)
