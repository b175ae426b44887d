"""Where the time of a step goes: clocks around its parts."""

from __future__ import annotations

import contextlib
import functools
import importlib
import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from analytic.response import Outcome, Response
from engines import ENGINES, Scene
from engines.declaration import Stepping
from engines.run.drive import build, run
from engines.run.monitor import Monitor
from engines.world import World
from studies.cases.paper import HISTORIES
from studies.precision.repeats import best_of

CASE = HISTORIES[5][1]
"""Figure 5-b: one impact before the peak, κ about 5."""


def share_table(engines: Sequence[str], budget_s: float) -> pd.DataFrame:
    """Return where the time of a step goes: the engine's own step, the adapter around it, the look.

    Each part is timed from within by a clock around it, whose own cost is taken off. The engine's
    own step is nan where no clock fits around it, and then counts as the adapter's; all are nan
    where the engine is not here. An engine that is stepped from a compiled loop has a row for that,
    too: the whole of its step, beside the engine's own as it was timed from Python.

    Parameters
    ----------
    engines : sequence of str
        Their names; each is asked with its best preset.
    budget_s : float
        Time [s] spent at most on each timing.

    Returns
    -------
    DataFrame
        engine, driver (of DRIVERS) and, in the columns SHARES, the time [s] of one step and of its
        parts.
    """
    return pd.DataFrame(row for engine in engines for row in _shares(engine, budget_s))


def _shares(engine: str, budget_s: float) -> Iterator[dict[str, Any]]:
    scene = Scene(system=CASE.block, motion=CASE.motion, compiled=False)
    # the first run of each driver may compile, which would spend the whole budget
    for compiled in (False, True):
        run(engine, replace(scene, compiled=compiled))
    plain = best_of(partial(run, engine, scene), budget_s)
    if plain.outcome is Outcome.FAILED:
        yield {"engine": engine, "driver": DRIVERS[0], **dict.fromkeys(SHARES, math.nan)}
        return
    response, spent = least_clocked(engine, scene, budget_s)
    clock_s = tick()
    per_step = {part: max(total / response.steps - clock_s, 0.0) for part, total in spent.items()}
    own = per_step.pop("engine", math.nan)
    rest = max(per_step["step"] - np.nan_to_num(own), 0.0)
    whole = plain.wall_s / plain.steps
    shares = (whole, own, rest, per_step["pose"], per_step["look"])
    yield {"engine": engine, "driver": DRIVERS[0], **dict(zip(SHARES, shares, strict=True))}
    if getattr(example_world(engine), "drive", None) is not None:
        at_once = best_of(partial(run, engine, replace(scene, compiled=True)), budget_s)
        unknown = dict.fromkeys(SHARES, math.nan)
        known = {"step_s": at_once.wall_s / at_once.steps, "engine_s": own}
        yield {"engine": engine, "driver": DRIVERS[1], **unknown, **known}


def least_clocked(engine: str, scene: Scene, budget_s: float) -> tuple[Response, dict[str, float]]:
    """Run with clocks around the parts; return the run that was disturbed least, and its sums."""
    sums: dict[float, dict[str, float]] = {}

    def clocked() -> Response:
        with clocks(engine) as spent:
            response = run(engine, scene)
        sums[response.wall_s] = spent
        return response

    least = best_of(clocked, budget_s)
    return least, sums[least.wall_s]


DRIVERS = ("Python", "compiled")
"""Who takes the steps one after the other."""

SHARES = ("step_s", "engine_s", "adapter_s", "pose_s", "look_s")
"""Columns of the table [s]: of a whole step, and of its parts."""


def tick() -> float:
    """Return what reading the clock twice costs [s]."""
    count = 20_000
    began = time.perf_counter()
    for _ in range(count):
        time.perf_counter()
        time.perf_counter()
    return (time.perf_counter() - began) / count


def own_step(engine: str) -> tuple[Any, str]:
    """Return where an engine's own step stands, and its name there."""
    library, _, path = ENGINES[engine].own_step.partition(":")
    *owners, name = path.split(".")
    return functools.reduce(getattr, owners, importlib.import_module(library)), name


def example_world(engine: str) -> World:
    """Return a world of an engine, closed: its class is wanted."""
    world = build(ENGINES[engine], Scene(system=CASE.block, motion=CASE.motion))
    world.close()
    return world


@contextlib.contextmanager
def clocks(engine: str) -> Iterator[dict[str, float]]:
    """Put clocks around the parts of a step while the context lasts; yield the sums [s]."""
    world = type(example_world(engine))
    stepping = ENGINES[engine].best.stepping
    places: dict[str, tuple[Any, str]] = {
        "step": (world, "advance" if stepping is Stepping.OWN else "step"),
        "pose": (world, "state"),
        "look": (Monitor, "next"),
    }
    if ENGINES[engine].own_step:
        places["engine"] = own_step(engine)
    spent = dict.fromkeys(places, 0.0)

    def timed(part: str, call: Callable[..., Any]) -> Callable[..., Any]:
        def measured(*arguments: Any, **named: Any) -> Any:
            start = time.perf_counter()
            try:
                return call(*arguments, **named)
            finally:
                spent[part] += time.perf_counter() - start

        return measured

    with contextlib.ExitStack() as undoing:
        for part, (owner, name) in places.items():
            kept = getattr(owner, name)
            undoing.callback(setattr, owner, name, kept)
            setattr(owner, name, timed(part, kept))
        yield spent
