"""Many runs at once: steps that are known beforehand, taken side by side and looked at after.

Equal steps ask nothing of the state. So an engine can be given some hundred of them for every scene
at once, and what is seen of a scene is what its own run would see.
"""

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Any, cast

import numpy as np

from analytic.response import Problem, Reason, Response
from engines.declaration import BatchEngine, Engine, Stepping
from engines.parts.compiled import FloatArray, kernel
from engines.registry import find
from engines.run.drive import LAG, LOOK_AROUND
from engines.run.monitor import Lists, Monitor, Run, onward, put_step, undecided
from engines.scene import Scene
from engines.world import Moment, Pose, Step, Worlds


def alike(engine: Engine, scene: Scene) -> Hashable:
    """Return what the scenes of one batch have in common; None for a scene that is run alone.

    Parameters
    ----------
    engine : Engine
    scene : Scene
    """
    if not isinstance(engine, BatchEngine) or not engine.installed:
        return None
    preset = engine.used_for(scene)
    scene = preset.posed(scene)
    says = scene.preset is None and preset is not engine.best
    watched = scene.time_limit_s is not None or not scene.compiled
    if preset.stepping is not Stepping.FIXED or says or watched or engine.lacks(scene, preset):
        return None
    if engine.builder(scene.layout.asks, preset) is not engine.build:
        return None
    return preset.name, repr(preset.chosen(scene)), scene.frame, scene.layout.contacts


def run_together(name: str, scenes: Sequence[Scene]) -> list[Response]:
    """Simulate scenes that are `alike` with an engine, at once.

    Parameters
    ----------
    name : str, of the engine
    scenes : sequence of Scene

    Returns
    -------
    list of Response
        As `engines.run.drive.run` returns them one by one; a run time is a part of that of all.
    """
    began = perf_counter()
    engine = cast(BatchEngine, find(name))
    preset = engine.used_for(scenes[0])
    scenes = [preset.posed(scene) for scene in scenes]
    steps_s = [preset.ordinary_step_s(scene) for scene in scenes]
    worlds = engine.batch(scenes, preset.chosen(scenes[0]), np.array(steps_s))
    setup_s = (perf_counter() - began) / len(scenes)
    try:
        seen = [
            _Seen(
                scene,
                Monitor(
                    scene, dt_s, preset.stepping, worlds.moment, engine.resolution(scene.system)
                ),
            )
            for scene, dt_s in zip(scenes, steps_s, strict=True)
        ]
        step_s = _take_all(worlds, seen)
        return [replace(each.response(step_s * each.steps), setup_s=setup_s) for each in seen]
    finally:
        worlds.close()


@dataclass
class _Seen:
    """What was seen of one of the scenes."""

    scene: Scene
    monitor: Monitor
    steps: int = 0
    lag_m: float | None = None
    problem: Problem | None = None

    @property
    def goes_on(self) -> bool:
        return self.monitor.goes_on and self.problem is None

    def response(self, wall_s: float) -> Response:
        if self.problem:
            reason, message = self.problem
            return Response.failure(message, reason=reason, steps=self.steps, wall_s=wall_s)
        found = self.monitor.response(steps=self.steps, wall_s=wall_s)
        if self.lag_m is None:
            return found
        return replace(found, observables={**found.observables, LAG: self.lag_m})


def _take_all(worlds: Worlds, seen: Sequence[_Seen]) -> float:
    """Take steps until every response is decided; return the time [s] for each that was seen."""
    steps = np.zeros((len(seen), LOOK_AROUND, len(Step._fields)))
    first = seen[0].monitor
    first.make_room(0)
    plan(first.runs, first.lists, steps[0, :0])  # both are compiled before the clock runs
    watch(first.runs, first.lists, steps[0, :0], np.zeros((0, len(first.runs), len(Pose._fields))))
    started = perf_counter()
    going = np.ones(len(seen), dtype=bool)
    while going.any():
        left = min(each.scene.max_steps - each.steps for each in seen if each.goes_on)
        chunk = steps[:, : min(LOOK_AROUND, left)]
        for each, own in zip(seen, chunk, strict=True):
            if each.goes_on:
                each.monitor.make_room(len(own))
                plan(each.monitor.runs, each.monitor.lists, own)
        states = worlds.advance(Step(*np.moveaxis(chunk, -1, 0)), going)
        states = _checked(states, seen[0].scene, chunk)
        for number, each in enumerate(seen):
            if each.goes_on:
                _look_at(each, worlds, number, chunk[number], states[number])
        going = np.array([each.goes_on for each in seen])
    return (perf_counter() - started) / max(sum(each.steps for each in seen), 1)


def _look_at(
    each: _Seen, worlds: Worlds, number: int, steps: FloatArray, states: FloatArray
) -> None:
    taken = watch(each.monitor.runs, each.monitor.lists, steps, states)
    each.steps += taken
    lags = getattr(worlds, "lag_m", None)
    if lags is not None:
        each.lag_m = max(each.lag_m or 0.0, float(np.max(lags[number][:taken])))
    fault = worlds.fault(number)
    seen = each.monitor.problem
    # what went wrong after a response was decided is not its own
    if fault and (each.monitor.goes_on or (seen and seen.reason is Reason.DIVERGED)):
        each.problem = Problem(Reason.FAULT, fault)
    elif seen:
        each.problem = seen
    elif each.monitor.goes_on and each.steps >= each.scene.max_steps:
        each.problem = Problem(Reason.UNDECIDED, f"not decided within {each.steps} steps")


def _checked(states: FloatArray, scene: Scene, steps: FloatArray) -> FloatArray:
    states = np.ascontiguousarray(states, dtype=np.float64)
    shape = (*steps.shape[:2], len(scene.bodies), len(Pose._fields))
    if states.shape != shape:
        raise ValueError(f"the engine's states have the shape {states.shape}; it must be {shape}")
    return states


@kernel
def plan(runs: Sequence[Run], lists: Lists, steps: FloatArray) -> None:
    """Write down the steps that come next, whatever the state.

    Parameters
    ----------
    runs, lists
        As for `engines.run.monitor.onward`; the runs are moved on.
    steps : ndarray (steps, 10), to be written in the order of the fields of `Step`
    """
    nowhere = np.zeros((1, 4))
    for number in range(len(steps)):
        put_step(steps[number], onward(runs, lists, nowhere))


@kernel
def watch(runs: Sequence[Run], lists: Lists, steps: FloatArray, states: FloatArray) -> int:
    """See the states after some steps while the run goes on; return how many were taken.

    Parameters
    ----------
    runs, lists
        As for `engines.run.monitor.undecided`, updated.
    steps : ndarray (steps, 10), from `plan`
    states : ndarray (steps, bodies, 4), a `Pose` a row, at the end of each
    """
    pace = runs[0].pace
    for number in range(len(steps)):
        pace.last_dt, pace.time = steps[number, 0], steps[number, 1]
        if not undecided(runs, lists, states[number]):
            return number + 1
    return len(steps)


def alone(
    batch: Callable[[Sequence[Scene], Any, FloatArray], Worlds],
    scene: Scene,
    settings: Any,
    dt_s: float,
) -> "Alone":
    """Build one scene with an engine that knows only batches.

    Parameters
    ----------
    batch : callable, see `BatchEngine.batch`
    scene : Scene
    settings : the engine's settings
    dt_s : float, ordinary step [s]
    """
    return Alone(batch([scene], settings, np.array([dt_s])), scene)


class Alone:
    """A batch of one as a world; see `engines.world.SteppedWorld`."""

    def __init__(self, worlds: Worlds, scene: Scene) -> None:
        self._worlds, self._going = worlds, np.ones(1, dtype=bool)
        at = [body.at for body in scene.bodies]
        self._state = np.array([[each.x, each.z, each.theta, each.rate] for each in at])
        self.moment: Moment = worlds.moment
        self.lag_m: float | None = None

    def step(self, step: Step) -> None:
        """Advance by a step."""
        steps = Step(*np.array(step, dtype=np.float64)[:, None, None])
        self._state[:] = self._worlds.advance(steps, self._going)[0, 0]
        lags = getattr(self._worlds, "lag_m", None)
        if lags is not None:
            self.lag_m = max(self.lag_m or 0.0, float(lags[0, 0]))

    def state(self) -> FloatArray:
        """Read the bodies' poses back."""
        return self._state

    def fault(self) -> str:
        """Say what has gone wrong."""
        return self._worlds.fault(0)

    def close(self) -> None:
        """Release the engine's memory."""
        self._worlds.close()
