"""One run: build the scene, take the steps, look on, and answer."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from time import perf_counter
from typing import cast

import numpy as np

from analytic.response import History, Impact, Outcome, Problem, Reason, Response
from engines.declaration import Stepping, Use
from engines.run import frame
from engines.run.history import sample
from engines.run.look import Monitor, pays_to_compile
from engines.run.slide import DISTANCE, SINCE, STOP, Slide, end_slip, observables_of
from engines.run.watch import (
    BEAM_SLIPPED,
    DIVERGED,
    HOLD_WIDTHS,
    IMPACT,
    KIND,
    REST,
    SANK,
    SLID,
    SLIPPED,
    THROWN,
    UPLIFT,
    WHEN,
    Watch,
    complete,
)
from engines.scene import Scene
from engines.world import UNLIMITED, FloatArray, Resolution, SelfSteppingWorld, Step, World

LAG = "floor_lag_m"
"""Observable: how far [m] a base that moves was from where it should have been, at most."""

LOOK_AROUND = 256
"""Steps between two looks at the clock, and at what the engine knows to have gone wrong."""


SINK_WIDTHS = 0.05
"""Of a corner deeper in the base than this part of the width a reader should know."""

PIVOT_SLID = "the pivot slid {:.3g} m along the base"
BEAM_SLID = "the beam slid {:.3g} m along the columns' tops"


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
    """Step a built world, at the start of the scene, until its response is decided.

    That is a failed one with its reason where the world fails or the scene's limits are reached.
    """
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
    first = monitor.runs[0]
    seen: list[Watch | Slide] = [first.slide, *(run.watch for run in monitor.runs)]
    problem = _fault(world) or next(filter(None, map(problem_of, seen)), problem)
    if problem:
        reason, message = problem
        return Response.failure(message, reason=reason, steps=steps, wall_s=wall_s)
    found, lag = answer_of(scene, monitor), getattr(world, "lag_m", None)
    lags = {} if lag is None else {LAG: float(lag)}
    observables = {**found.observables, **lags}
    return replace(found, steps=steps, wall_s=wall_s, observables=observables)


class Stepper:
    """Takes the steps of a run one by one, looking after each; `monitor` chooses them."""

    def __init__(self, monitor: Monitor, world: World, stepping: Stepping) -> None:
        self._monitor, self._world, self._own = monitor, world, stepping is Stepping.OWN
        monitor.make_room(LOOK_AROUND)
        self._step = monitor.next(world.state())

    def go(self, most: int) -> int:
        """Take up to so many steps while the run goes on; return how many were taken."""
        taken = 0
        for _ in range(most):
            if self._step is None or taken >= most:
                break
            taken += self._advance(self._step) if self._own else 1
            if not self._own:
                self._world.step(self._step)
            self._step = self._monitor.next(self._world.state())
        return taken

    def _advance(self, step: Step) -> int:
        taken: int = cast(SelfSteppingWorld, self._world).advance(step.end_s)
        if taken < 0:
            raise ValueError(f"the engine says that it took {taken} steps")
        return taken


def _fault(world: World) -> Problem | None:
    message = world.fault()
    return Problem(Reason.FAULT, f"{message}") if message else None


def _undecided(limit: str) -> Problem:
    return Problem(Reason.UNDECIDED, f"not decided within {limit}")


def problem_of(watch: Watch | Slide) -> Problem | None:
    """Return why the response is no longer that of what was posed, where there is a reason."""
    if not watch.problem:
        return None
    if watch.problem in (SLIPPED, BEAM_SLIPPED):
        slid = (PIVOT_SLID if watch.problem == SLIPPED else BEAM_SLID).format(watch.far)
        most = HOLD_WIDTHS * 2.0 * cast(Watch, watch).half_width
        assumed = f"steps that land on impacts assume that it holds, and allow at most {most:.3g} m"
        return Problem(Reason.SLID, f"{slid}; {assumed}")
    words = {
        DIVERGED: (Reason.DIVERGED, "the engine's state is not finite"),
        SANK: (Reason.SANK, f"the block sank {watch.far:.3g} m, through the base"),
        THROWN: (Reason.THROWN, f"the block was thrown {watch.far:.3g} m off the base"),
        SLID: (Reason.SLID, PIVOT_SLID.format(watch.far)),
    }
    return Problem(*words[int(watch.problem)])


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


def response_of(watch: Watch, events: FloatArray, history: History | None) -> Response:
    """Return what was seen of a body; there is room for one more of its events (k, 4)."""
    complete(watch, events)
    if watch.overturned:
        outcome, ratio = Outcome.OVERTURNED, math.inf
    elif watch.rocked:
        outcome, ratio = Outcome.ROCKED, float(watch.peak / watch.alpha)
    else:
        outcome, ratio = Outcome.AT_REST, 0.0
    seen = events[: watch.events]
    uplifts, impacts, rests = (seen[seen[:, KIND] == kind] for kind in (UPLIFT, IMPACT, REST))
    return Response(
        outcome=outcome,
        peak_ratio=ratio,
        crossed=bool(watch.crossed or watch.overturned),
        impacts=tuple(Impact(*impact) for impact in impacts[:, WHEN:].tolist()),
        uplifts=tuple(uplifts[:, WHEN].tolist()),
        rests=tuple(rests[:, WHEN].tolist()),
        message=_remark(watch),
        history=history,
        slip_m=float(watch.slide),
        sink_m=float(watch.sink),
        hop_m=float(watch.highest),
    )


def _remark(watch: Watch) -> str:
    """Say what a reader should know of a usable response: how deep it stood, how far it slid."""
    width, said = 2.0 * watch.half_width, []
    if watch.sunk > width * SINK_WIDTHS:
        said.append(f"the block sank {watch.sunk:.3g} m into the base")
    for words, far in ((PIVOT_SLID, watch.slide), (BEAM_SLID, watch.beam_slide)):
        if far > width * HOLD_WIDTHS and not watch.slides:
            said.append(words.format(far))
    return "; ".join(said)


def together(responses: Sequence[Response], observables: Mapping[str, float]) -> Response:
    """Return the response of bodies that rock together, and what was seen beside them.

    It is the first one's; it has overturned if one has, and its peak is the largest.
    """
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


def slide_response(slide: Slide, slips: FloatArray, history: History | None) -> Response:
    """Return what was seen of a box that slides; the last slip counts as far as it got."""
    end_slip(slide, slips, slide.time, slide.place)
    slide.way = 0.0
    seen = slips[: slide.slips]
    slid = Outcome.SLID if slide.slips else Outcome.AT_REST
    return Response(
        outcome=Outcome.OVERTURNED if slide.overturned else slid,
        peak_ratio=math.inf if slide.overturned else 0.0,
        slips=tuple(seen[:, DISTANCE].tolist()),
        slip_times=tuple(map(tuple, seen[:, [SINCE, STOP]].tolist())),
        slip_m=float(max(abs(seen[:, DISTANCE]), default=0.0)),
        sink_m=float(slide.depth),
        history=history,
        observables=observables_of(slide),
    )
