"""One run: build the scene, take the steps, look on, and answer."""

import math
from collections.abc import Callable
from dataclasses import replace
from time import perf_counter
from typing import cast

from analytic.response import Problem, Reason, Response
from engines.declaration import Stepping, Use
from engines.run.look import Monitor
from engines.scene import Scene
from engines.world import (
    UNLIMITED,
    Driver,
    Resolution,
    SelfSteppingWorld,
    Step,
    SteppedWorld,
    World,
)

LAG = "floor_lag_m"
"""Observable: how far [m] a base that moves was from where it should have been, at most."""

LOOK_AROUND = 256
"""Steps between two looks at the clock, and at what the engine knows to have gone wrong."""


class NotAvailableError(Exception):
    """An engine that is not installed, or cannot do what is asked of it; one line says why."""


def run(use: Use) -> Response:
    """Simulate a scene as an engine is used for it.

    Parameters
    ----------
    use : Use
        What an engine's `use` of the scene returns.

    Returns
    -------
    Response
        A run that diverges, leaves the problem or takes too long is a failed response with its
        reason, as is one that the engine cannot do or whose library is not installed.
    """
    began = perf_counter()
    engine, preset, scene = use.engine, use.preset, use.scene
    try:
        world = build(use)
    except NotAvailableError as error:
        return Response.failure(str(error), reason=Reason.UNAVAILABLE)
    built = perf_counter()
    try:
        response = simulate_world(world, scene, use.dt_s, preset.stepping, use.resolution)
    finally:
        world.close()
    said = [] if scene.preset or preset is engine.best else [f"as {engine.name}:{preset.name}"]
    message = "; ".join(filter(None, (*said, response.message)))
    return replace(response, setup_s=built - began, message=message)


def build(use: Use) -> World:
    """Build a scene as an engine is used for it.

    Raises
    ------
    NotAvailableError
        If the engine cannot do what the scene asks for, or its library is not installed.
    """
    if use.lacking:
        raise NotAvailableError(f"not available: {use.lacking}")
    try:
        return use.build(use.scene, use.settings, use.dt_s)
    except ImportError as error:
        words = f"not available: {error}; pip install '{use.engine.install}'"
        raise NotAvailableError(words) from error


def simulate_world(
    world: World,
    scene: Scene,
    dt_s: float,
    stepping: Stepping = Stepping.LANDING,
    resolution: Resolution = UNLIMITED,
) -> Response:
    """Step a built world until its response is decided.

    Parameters
    ----------
    world : World, at the start of the scene
    scene : Scene
    dt_s : float, ordinary step [s]
    stepping : Stepping, optional, who chooses the steps
    resolution : Resolution, optional, what the engine's numbers tell apart

    Returns
    -------
    Response
        A failed one with its reason where the world fails or the limits of the scene are reached.
    """
    monitor = Monitor(scene, dt_s, stepping, world.moment, resolution)
    go = driven(monitor, world) if scene.compiled else None
    go = go or Stepper(monitor, world, stepping).go
    limit = math.inf if scene.time_limit_s is None else scene.time_limit_s
    steps, problem = 0, None
    started = perf_counter()
    while monitor.goes_on and not problem:
        monitor.make_room(LOOK_AROUND)
        steps += go(min(LOOK_AROUND, scene.max_steps - steps))
        if monitor.goes_on:
            late = perf_counter() - started > limit
            problem = _fault(world) or (_undecided(f"{limit:g} s") if late else None)
            if steps >= scene.max_steps:
                problem = problem or _undecided(f"{steps} steps")
    wall_s = perf_counter() - started
    problem = _fault(world) or monitor.problem or problem
    if problem:
        reason, message = problem
        return Response.failure(message, reason=reason, steps=steps, wall_s=wall_s)
    return _with_lag(monitor.response(steps=steps, wall_s=wall_s), world)


def _with_lag(response: Response, world: World) -> Response:
    lag = getattr(world, "lag_m", None)
    if lag is None:
        return response
    return replace(response, observables={**response.observables, LAG: float(lag)})


def driven(monitor: Monitor, world: World) -> Callable[[int], int] | None:
    """Return how a world takes up to so many steps at once; None where it cannot.

    What is returned takes how many at most, and returns how many it took.
    """
    drive: Driver | None = getattr(world, "drive", None)
    if drive is None:
        return None
    monitor.make_room(0)
    drive(monitor.runs, monitor.lists, 0)  # what is not compiled yet is so before the clock runs
    return lambda most: drive(monitor.runs, monitor.lists, most)


class Stepper:
    """Takes the steps of a run one by one, looking after each.

    Parameters
    ----------
    monitor : Monitor
        Looks on, and chooses the steps.
    world : World
        Takes them, or goes to their ends by itself.
    stepping : Stepping
        Which of both.
    """

    def __init__(self, monitor: Monitor, world: World, stepping: Stepping) -> None:
        self._monitor, self._world = monitor, world
        self._take = _taker(world, stepping)
        monitor.make_room(LOOK_AROUND)
        self._step = monitor.next(world.state())

    def go(self, most: int) -> int:
        """Take up to so many steps while the run goes on; return how many were taken."""
        taken = 0
        for _ in range(most):
            if self._step is None or taken >= most:
                break
            taken += self._take(self._step)
            self._step = self._monitor.next(self._world.state())
        return taken


def _fault(world: World) -> Problem | None:
    message = world.fault()
    return Problem(Reason.FAULT, f"{message}") if message else None


def _undecided(limit: str) -> Problem:
    return Problem(Reason.UNDECIDED, f"not decided within {limit}")


def _taker(world: World, stepping: Stepping) -> Callable[[Step], int]:
    """Return how a world takes a step; the answer is how many it took."""
    if stepping is Stepping.OWN:
        own = cast(SelfSteppingWorld, world)

        def advance(step: Step) -> int:
            taken = own.advance(step.end_s)
            if taken < 0:
                raise ValueError(f"the engine says that it took {taken} steps")
            return taken

        return advance
    stepped = cast(SteppedWorld, world)

    def take(step: Step) -> int:
        stepped.step(step)
        return 1

    return take
