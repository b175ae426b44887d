"""One run: build the scene, take the steps, look on, and answer."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from time import perf_counter
from typing import Any

import numpy as np

from analytic.response import History, Outcome, Problem, Reason, Response
from engines.declaration import Stepping, Use
from engines.run import frame
from engines.run.look import Monitor, pays_to_compile
from engines.run.slide import slide_response
from engines.run.verdict import problem_of, response_of
from engines.scene import Scene
from engines.world import UNLIMITED, FloatArray, Resolution, World

LAG, YAW = "floor_lag_m", "yaw_deg"
"""Observables: how far [m] a moving base was off at most; the first body's yaw [degrees]."""

LOOK_AROUND = 256
"""Steps between two looks at the clock, and at what the engine knows to have gone wrong."""


class NotAvailableError(Exception):
    """An engine that is not installed, or cannot do what is asked of it; one line says why."""


def run(use: Use) -> Response:
    """Simulate a scene as an engine is used for it (`Engine.use`).

    A run that diverges, leaves the problem or takes too long is a failed response with its reason,
    as is one that the engine cannot do or whose library is not installed.
    """
    compiles = pays_to_compile(use.scene, use.dt_s)
    if not compiles:
        try:  # what numpy would only warn of is for compiled code, as what Python raises
            with np.errstate(divide="raise", over="raise", invalid="raise"):
                return _run(use, False)
        except (ArithmeticError, ValueError):
            pass
    return _run(use, True)


def _run(use: Use, compiles: bool) -> Response:
    began = perf_counter()
    engine, preset, scene = use.engine, use.preset, replace(use.scene, compiled=compiles)
    try:
        world = build(replace(use, scene=scene))
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
    """Build a scene as an engine is used for it; NotAvailableError if it cannot be."""
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
    """Step a built world until its response is decided, the world fails or limits are reached."""
    monitor, drive = Monitor(scene, dt_s, stepping, world.moment, resolution), None
    if scene.compiled and (drive := getattr(world, "drive", None)):
        monitor.make_room(0)
        drive(monitor.runs, monitor.lists, 0)  # what is not compiled yet is so before the clock
    else:
        stepper = Stepper(monitor, world, stepping)
    limit = math.inf if scene.time_limit_s is None else scene.time_limit_s
    steps, problem = 0, None
    started = perf_counter()
    while monitor.goes_on and not problem:
        monitor.make_room(LOOK_AROUND)
        most = min(LOOK_AROUND, scene.max_steps - steps)
        steps += drive(monitor.runs, monitor.lists, most) if drive else stepper.go(most)
        if monitor.goes_on:
            late = perf_counter() - started > limit
            problem = _fault(world) or (_undecided(f"{limit:g} s") if late else None)
            if steps >= scene.max_steps:
                problem = problem or _undecided(f"{steps} steps")
    wall_s = perf_counter() - started
    slide = monitor.runs[0].slide
    watches = [run.watch for run in monitor.runs]
    seen = [(watch.problem, watch.far, 2.0 * watch.half_width) for watch in watches]
    found = [problem_of(*each) for each in ((slide.problem, slide.far, slide.width), *seen)]
    problem = _fault(world) or next(filter(None, found), problem)
    if problem:
        reason, message = problem
        return Response.failure(message, reason=reason, steps=steps, wall_s=wall_s)
    answer, lag = answer_of(scene, monitor), getattr(world, "lag_m", None)
    yaw = getattr(world, "yaw", None)
    beside = {LAG: lag, YAW: None if yaw is None else abs(math.degrees(yaw))}
    known = {name: float(value) for name, value in beside.items() if value is not None}
    observables = {**answer.observables, **known}
    return replace(answer, steps=steps, wall_s=wall_s, observables=observables)


class Stepper:
    """Takes the steps of a run one by one, looking after each; `monitor` chooses them."""

    def __init__(self, monitor: Monitor, world: Any, stepping: Stepping) -> None:
        self._monitor, self._world, self._own = monitor, world, stepping is Stepping.OWN
        monitor.make_room(LOOK_AROUND)
        self._step = monitor.next(world.state())

    def go(self, most: int) -> int:
        """Take up to so many steps while the run goes on; return how many were taken."""
        taken = 0
        for _ in range(most):
            if self._step is None or taken >= most:
                break
            more = self._world.advance(self._step.end_s) if self._own else 1
            if more < 0:
                raise ValueError(f"the engine says that it took {more} steps")
            if not self._own:
                self._world.step(self._step)
            taken += more
            self._step = self._monitor.next(self._world.state())
        return taken


def _fault(world: World) -> Problem | None:
    message = world.fault()
    return Problem(Reason.FAULT, f"{message}") if message else None


def _undecided(limit: str) -> Problem:
    return Problem(Reason.UNDECIDED, f"not decided within {limit}")


def answer_of(scene: Scene, monitor: Monitor) -> Response:
    """Return what was seen of a scene until now."""

    def history(rows: FloatArray, count: int) -> History | None:
        return None if scene.times is None else sample(rows[:count], scene.times)

    runs, rows, events = monitor.runs, monitor.lists.rows, monitor.lists.events
    slide = runs[0].slide
    if slide.on:
        return slide_response(slide, events[0], history(rows[0], slide.rows))
    each = [
        response_of(run.watch, its_events, history(its_rows, run.watch.rows))
        for run, its_rows, its_events in zip(runs, rows, events, strict=True)
    ]
    return together(each, frame.observables_of(runs[0].spread, scene.system.alpha))


def together(responses: Sequence[Response], observables: Mapping[str, float]) -> Response:
    """Return one response for all; it overturns if one does, and its peak is the largest."""
    first, *others = responses
    if not others:
        return replace(first, observables=observables) if observables else first
    fallen = [each for each in responses if each.outcome is Outcome.OVERTURNED]
    peaks = {f"peak_{number + 1}": each.peak_ratio for number, each in enumerate(responses)}
    return replace(
        first,
        outcome=Outcome.OVERTURNED if fallen else first.outcome,
        peak_ratio=max(each.peak_ratio for each in responses),
        crossed=any(each.crossed for each in responses),
        message=next((each.message for each in responses if each.message), ""),
        observables={**peaks, **observables},
    )


def sample(rows: FloatArray, times: Sequence[float]) -> History:
    """Sample a response at those of some times that it reached: over a step theta is a parabola.

    Its curvature is that of the calmer neighbour, so that it does not reach across an impact.
    """
    time, rate_s, theta, rate = rows.T
    wanted = np.asarray(times, dtype=np.float64)
    wanted = wanted[wanted <= time[-1]]
    # rows[0] is the start, so that step i leads from row i - 1 to row i
    step = np.clip(np.searchsorted(time, wanted), 1, len(time) - 1)
    bend = _bends(rate_s[1:], rate[1:])[step - 1]
    since, left = wanted - time[step - 1], time[step] - wanted
    chord = (theta[step] - theta[step - 1]) / (time[step] - time[step - 1])
    return History(
        time=wanted,
        theta=theta[step - 1] + chord * since - 0.5 * bend * since * left,
        velocity=rate[step] + bend * (wanted - rate_s[step]),
    )


def _bends(rate_s: FloatArray, rate: FloatArray) -> FloatArray:
    """Angular acceleration [rad/s2] of each step, from its calmer neighbour."""
    if len(rate) == 1:
        return np.zeros(1)
    between = np.diff(rate) / np.diff(rate_s)
    before = np.concatenate((between[:1], between))
    after = np.concatenate((between, between[-1:]))
    return np.where(np.abs(before) < np.abs(after), before, after)
