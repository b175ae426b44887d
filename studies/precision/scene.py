"""What a scene costs: the shares of a step, and what it leaves out."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pkgutil import resolve_name
from timeit import repeat
from typing import Any

import numpy as np

from analytic import simulate
from analytic.response import Outcome, Response
from engines.declaration import Engine
from studies.cases.paper import HISTORIES, free_rocking_window
from studies.kit.jobs import Job, Row, ask, summary
from studies.measures.costs import best_of, best_of_each

CASE = HISTORIES[5][1]
"""Figure 5-b, of which scenes are timed: one impact before the peak, κ about 5."""


def omissions() -> dict[str, dict[str, Any]]:
    """Return the options that put back what a scene leaves out, by the name of that; none first."""
    window, grid = free_rocking_window(CASE.block, CASE.motion), np.linspace(0.0, 1.0, 1001)
    return {
        "as it is": {},
        "free body instead of planar": {"settings": {"planar": False}},
        "full box instead of corners": {"settings": {"geometry": "box"}},
        "base moving in the world": {"frame": "world"},
        "8/p of free rocking after the pulse": {"duration": window},
        "the same, recorded as a history": {"duration": window, "times": window * grid},
        "steps all equal": {"preset": "fixed"},
    }


def share(job: Job) -> Row:
    """Return how long a step takes, and of that the engine's own [s].

    Of the latter a clock around it tells while Python takes the steps; nan where none fits there.
    """
    ask(job)  # the first may compile, which would spend the whole budget
    whole, _ = best_of(partial(ask, job), job.labels["budget_s"])
    if whole.outcome is Outcome.FAILED:
        return {**summary(whole), "step_s": math.nan, "engine_s": math.nan}
    interpreted = replace(job, options={"compiled": False})
    tick_s = 2.0 * min(repeat(time.perf_counter, number=1000, repeat=20)) / 1000.0
    own = dict[float, float]()

    def clocked() -> Response:
        with clock(job.asked.engine) as spent:
            response = ask(interpreted)
        own[response.wall_s] = sum(spent) - tick_s * len(spent)
        return response

    engine_s = math.nan
    if job.asked.engine in OWN_STEP:
        least, _ = best_of(clocked, job.labels["budget_s"])
        engine_s = max(own[least.wall_s] / least.steps, 0.0)
    return {**summary(whole), "step_s": whole.wall_s / whole.steps, "engine_s": engine_s}


OWN_STEP = {
    "rapier": "rapier3d:PhysicsWorld.step",
    "mujoco": "mujoco:mj_step",
    "drake": "pydrake.systems.analysis:Simulator.AdvanceTo",
    "dart": "dartpy:simulation.World.step",
    "physx": "sapien.physx:PhysxCpuSystem.step",
    "pybullet": "pybullet:stepSimulation",
}
"""Engine -> the function of its library that does nothing but its own step."""


@contextmanager
def clock(engine: str) -> Iterator[list[float]]:
    """Put a clock around an engine's own step while the context lasts; yield its times [s]."""
    place, _, name = OWN_STEP[engine].replace(":", ".").rpartition(".")
    owner: Any = resolve_name(place)
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


def has(
    engine: Engine, preset: str = "", settings: Row | None = None, frame: str = "base", **_: Any
) -> bool:
    """Return whether an engine has what is put back into its scene."""
    known = not preset or preset in [use.name for use in engine.presets]
    return (
        known and frame in engine.frames and engine.preset(preset or None).takes(**settings or {})
    )


def put_back(job: Job) -> Row:
    """Time a scene with what it leaves out, in turn with the scene as it is."""
    options = omissions()[str(job.labels["scene"])]
    observed = {name: options.pop(name) for name in ("duration", "times") if name in options}
    preset = options.pop("preset", "")
    source, case = f"{job.source}:{preset}" if preset else job.source, replace(job.case, **observed)
    posed = replace(job, case=case, source=source, options=options)
    asked = [partial(ask, posed), partial(ask, job)]
    (found, runs), (plain, _) = best_of_each(asked, job.labels["budget_s"])
    exact = simulate(CASE.block, CASE.motion).peak_ratio
    return {
        **summary(found),
        "runs": runs,
        "step_s": found.wall_s / max(found.steps, 1),
        "plain_s": plain.wall_s,
        "setup_s": found.setup_s,
        "error": found.peak_ratio / exact - 1.0,
    }
