"""How long a step takes, and which part of that is the engine's own: by a clock around that."""

from __future__ import annotations

import contextlib
import functools
import importlib
import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import pandas as pd

from analytic.response import Outcome, Response
from engines import ENGINES, Scene
from engines.run.drive import run
from studies.cases.paper import HISTORIES
from studies.precision.repeats import best_of

CASE = HISTORIES[5][1]
"""Figure 5-b: one impact before the peak, κ about 5."""


def share_table(engines: Sequence[str], budget_s: float) -> pd.DataFrame:
    """Return how long a step takes, and of that the engine's own.

    Parameters
    ----------
    engines : sequence of str
        Their names; each is asked with its best preset.
    budget_s : float
        Time [s] spent at most on each timing.

    Returns
    -------
    DataFrame
        engine; step_s: time [s] of one step of a run; engine_s: of the engine's own step, by a
        clock around it while Python takes the steps, nan where no clock fits there. Both are nan
        where the engine is not here.
    """
    return pd.DataFrame(_shares(engine, budget_s) for engine in engines)


def _shares(engine: str, budget_s: float) -> dict[str, Any]:
    scene = Scene(system=CASE.block, motion=CASE.motion)
    run(engine, scene)  # the first may compile, which would spend the whole budget
    whole = best_of(partial(run, engine, scene), budget_s)
    if whole.outcome is Outcome.FAILED:
        return {"engine": engine, "step_s": math.nan, "engine_s": math.nan}
    own = own_s(engine, replace(scene, compiled=False), budget_s)
    return {"engine": engine, "step_s": whole.wall_s / whole.steps, "engine_s": own}


def own_s(engine: str, scene: Scene, budget_s: float) -> float:
    """Return the time [s] of an engine's own step in the run that was disturbed least."""
    if not ENGINES[engine].own_step:
        return math.nan
    clock_s = tick()
    sums: dict[float, float] = {}

    def clocked() -> Response:
        with clock(engine) as spent:
            response = run(engine, scene)
        sums[response.wall_s] = sum(spent) - clock_s * len(spent)
        return response

    least = best_of(clocked, budget_s)
    return max(sums[least.wall_s] / least.steps, 0.0)


def tick() -> float:
    """Return what reading the clock twice costs [s]."""
    count = 20_000
    began = time.perf_counter()
    for _ in range(count):
        time.perf_counter()
        time.perf_counter()
    return (time.perf_counter() - began) / count


@contextlib.contextmanager
def clock(engine: str) -> Iterator[list[float]]:
    """Put a clock around an engine's own step while the context lasts; yield its times [s]."""
    library, _, path = ENGINES[engine].own_step.partition(":")
    *owners, name = path.split(".")
    owner: Any = functools.reduce(getattr, owners, importlib.import_module(library))
    step, spent = getattr(owner, name), []

    def timed(*arguments: Any, **named: Any) -> Any:
        start = time.perf_counter()
        try:
            return step(*arguments, **named)
        finally:
            spent.append(time.perf_counter() - start)

    setattr(owner, name, timed)
    try:
        yield spent
    finally:
        setattr(owner, name, step)
