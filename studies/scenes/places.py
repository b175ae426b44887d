"""The pulses of several scenes, and the steps by which an impact falls elsewhere in one."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache
from typing import Any

from analytic import CartBlock, RockingFrame, simulate
from analytic.motion import SinePulse
from engines.declaration import Stepping
from studies.sources.registry import resolve

PULSES = ((0.4, 6.2832), (0.45, 8.0), (0.5, 9.0))
"""Amplitude [g] and circular frequency [rad/s] of full sines."""


def steps(
    source: str,
    frame: RockingFrame | CartBlock,
    motion: SinePulse,
    phases: int,
    duration: float | None = None,
) -> Iterator[dict[str, Any]]:
    """Yield the options by which the first impact falls into different parts of equal steps.

    With n = t/dt steps before an impact at t, a step of dt (1 + k/(N n)) has it the part k/N of a
    step earlier, for k = 0, 1, ..., N - 1.

    Parameters
    ----------
    source : str
    frame, motion
    phases : int
        N, at least 1.
    duration : float, optional
        As for `analytic.simulate`, whose first impact counts.

    Yields
    ------
    dict
        step, p dt of the frame or cart; one that is empty for a source without equal steps.

    Raises
    ------
    IndexError
        If the exact response has no impact.
    """
    asked = resolve(source)
    if not asked.engine or asked.used.stepping is not Stepping.FIXED:
        yield {}
        return
    used = asked.used
    step = used.step if math.isfinite(used.step) else used.step_s * frame.p
    impact = first_impact(frame, motion, duration) * frame.p
    for phase in range(phases):
        yield {"step": step * (1.0 + phase / phases * step / impact)}


@cache  # one for all sources
def first_impact(
    frame: RockingFrame | CartBlock, motion: SinePulse, duration: float | None
) -> float:
    """Return when the exact response has its first impact [s]; the arguments are those of `steps`.

    Raises
    ------
    IndexError
        If it has none.
    """
    return float(simulate(frame, motion, duration=duration).impacts[0].time)
