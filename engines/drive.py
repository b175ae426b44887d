"""One run: build the scene, take the steps, look on, and answer."""

import math
import time
from collections.abc import Callable
from dataclasses import replace
from typing import cast

from analytic.response import Problem, Reason, Response
from engines.declaration import Engine, Stepping
from engines.registry import find
from engines.scene import Scene
from engines.stepping.landing import LandingSteps
from engines.stepping.steps import FixedSteps, Looks, Policy, Stepper
from engines.watching.observe import Observer
from engines.world import (
    UNLIMITED,
    Moment,
    Resolution,
    SelfSteppingWorld,
    Step,
    SteppedWorld,
    World,
)

LOOK_AROUND = 256
"""Steps between two looks at the clock, and at what the engine knows to have gone wrong."""


class NotAvailableError(Exception):
    """An engine that is not installed, or cannot do what is asked of it; one line says why."""


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
        reason, as is one that the engine cannot do or whose library is not installed.

    Raises
    ------
    ValueError
        If the engine is unknown, or a preset or setting is not one of the engine's.
    """
    began = time.perf_counter()
    asked = find(engine)
    preset = asked.preset(scene.preset)
    try:
        world = build(asked, scene)
    except NotAvailableError as error:
        return Response.failure(str(error), reason=Reason.UNAVAILABLE)
    built = time.perf_counter()
    try:
        response = simulate_world(
            world,
            scene,
            preset.ordinary_step_s(scene),
            preset.stepping,
            asked.resolution(scene.block),
        )
    finally:
        world.close()
    return replace(response, setup_s=built - began)


def build(engine: Engine, scene: Scene) -> World:
    """Build a scene with an engine, in the preset and the settings that the scene names.

    Raises
    ------
    NotAvailableError
        If the engine cannot do what the scene asks for, or its library is not installed.
    ValueError
        If a preset or setting is not one of the engine's.
    """
    preset = engine.preset(scene.preset)
    lacking = engine.lacks(scene)
    if lacking:
        raise NotAvailableError(f"not available: {lacking}")
    settings = scene.choose(preset.settings)
    try:
        return engine.build(scene, settings, preset.ordinary_step_s(scene))
    except ImportError as error:
        words = f"not available: {error}; pip install '{engine.install}'"
        raise NotAvailableError(words) from error


def simulate_world(
    world: World,
    scene: Scene,
    dt_s: float,
    stepping: Stepping = Stepping.LANDING,
    resolution: Resolution = UNLIMITED,
) -> Response:
    """Step a built world until its response is decided; dt_s [s] is the ordinary step."""
    observer = Observer(scene, dt_s, world.moment, resolution)
    stepper = Stepper(_policy(scene, dt_s, stepping, world.moment, resolution), scene, world.moment)
    take = _taker(world, stepping)
    limit = math.inf if scene.time_limit_s is None else scene.time_limit_s
    steps, looks, problem = 0, 0, None
    pose = world.pose()
    started = time.perf_counter()
    while not observer.done and not problem:
        step = stepper.next(pose, observer.lifted)
        steps += take(step)
        looks += 1
        pose = world.pose()
        observer.see(step.end_s, step.dt_s, pose)
        problem = observer.broken
        if looks % LOOK_AROUND == 0 and not problem:
            late = time.perf_counter() - started > limit
            problem = _fault(world) or (_undecided(f"{limit:g} s") if late else None)
        if steps >= scene.max_steps and not observer.done:
            problem = problem or _undecided(f"{steps} steps")
    wall_s = time.perf_counter() - started
    problem = _fault(world) or problem
    if problem:
        reason, message = problem
        return Response.failure(message, reason=reason, steps=steps, wall_s=wall_s)
    return observer.response(steps=steps, wall_s=wall_s)


def _fault(world: World) -> Problem | None:
    """Return what the engine says has gone wrong."""
    message = world.fault()
    return Problem(Reason.FAULT, message) if message else None


def _undecided(limit: str) -> Problem:
    return Problem(Reason.UNDECIDED, f"not decided within {limit}")


def _policy(
    scene: Scene, dt_s: float, stepping: Stepping, moment: Moment, resolution: Resolution
) -> Policy:
    if stepping is Stepping.LANDING:
        return LandingSteps(scene, dt_s, moment, resolution)
    return Looks(scene, dt_s) if stepping is Stepping.OWN else FixedSteps(dt_s)


def _taker(world: World, stepping: Stepping) -> Callable[[Step], int]:
    """Return how a world takes a step; the answer is how many it took."""
    if stepping is Stepping.OWN:
        own = cast(SelfSteppingWorld, world)
        return lambda step: own.advance(step.end_s)
    stepped = cast(SteppedWorld, world)

    def take(step: Step) -> int:
        stepped.step(step)
        return 1

    return take
