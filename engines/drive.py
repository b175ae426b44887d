"""One run: build the scene, take the steps, look on, and answer."""

import math
import time
from dataclasses import replace
from importlib import import_module
from typing import Protocol, cast

from analytic.response import Response
from engines.scene import Scene, World
from engines.stepping.landing import LandingSteps
from engines.stepping.steps import FixedSteps, Policy, Stepper
from engines.watching.observe import Observer

ENGINES = {"pybullet": "engines.adapters.bullet", "mujoco": "engines.adapters.mujoco"}
"""Name of an engine -> module of its adapter, imported when the engine is first asked for."""

LOOK_AT_CLOCK = 256
"""Steps between two looks at the clock."""


class Adapter(Protocol):
    """What the module of an engine provides."""

    def build(self, scene: Scene) -> World:
        """Build a scene, the block at rest on its base."""


def run(engine: str, scene: Scene) -> Response:
    """Simulate a scene with an engine.

    Parameters
    ----------
    engine : str
        A name in `ENGINES`.
    scene : Scene
        What to simulate, and how.

    Returns
    -------
    Response
        A run that diverges, leaves the problem or takes too long is a failed response with its
        reason.

    Raises
    ------
    ValueError
        If the engine is unknown, or a setting is not one of the engine's.
    """
    if engine not in ENGINES:
        raise ValueError(f"engine is {engine!r}; it must be one of {', '.join(ENGINES)}")
    adapter = cast(Adapter, import_module(ENGINES[engine]))
    began = time.perf_counter()
    world = adapter.build(scene)
    try:
        built = time.perf_counter()
        return replace(_simulate(world, scene), setup_s=built - began)
    finally:
        world.close()


def policy_of(scene: Scene, dt_s: float) -> Policy:
    """Return the stepping policy of a scene whose ordinary step is `dt_s` [s]."""
    return LandingSteps(scene, dt_s) if scene.preset == "landing" else FixedSteps(dt_s)


def _simulate(world: World, scene: Scene) -> Response:
    """Step a world until its response is decided."""
    observer = Observer(scene, world.dt_s)
    limit = math.inf if scene.time_limit_s is None else scene.time_limit_s
    stepper = Stepper(policy_of(scene, world.dt_s), scene)
    steps, problem = 0, ""
    pose = world.pose()
    started = time.perf_counter()
    while not observer.done and not problem:
        step = stepper.next(pose, observer.lifted)
        world.step(step)
        steps += 1
        pose = world.pose()
        observer.see(stepper.time, step.dt_s, pose)
        problem = observer.broken
        if steps % LOOK_AT_CLOCK == 0 and time.perf_counter() - started > limit:
            problem = f"not decided within {limit:g} s"
        elif steps >= scene.max_steps and not observer.done:
            problem = f"not decided within {steps} steps"
    wall_s = time.perf_counter() - started
    problem = world.fault() or problem
    if problem:
        return Response.failure(problem, steps=steps, wall_s=wall_s)
    return observer.response(steps=steps, wall_s=wall_s)
