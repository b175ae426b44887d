"""One look a step: take in where the bodies are, and choose the step that follows.

`look`, and all that it calls in this folder, are plain functions of plain states. A few short runs
are looked at by them as they are; for more, `compiled` makes one compiled function of them, to the
bit the same, whose states are numpy's records.
"""

import math
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, is_dataclass
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple, get_type_hints

import numpy as np
from numpy.typing import ArrayLike

from analytic.block import RigidBlock
from analytic.kernels.forms import Kernel
from analytic.kernels.kept import are_compiled
from analytic.motion import SinePulse
from engines.declaration import Stepping
from engines.run.frame import Spread, begin_spread, see_spread
from engines.run.ground import rows_of
from engines.run.landing import Landing, begin_landing, choose
from engines.run.rows import Row
from engines.run.slide import Slide, begin_slide, see_slide
from engines.run.steps import FIXED, LANDING, Pace, advance, begin_pace, even, pass_to, timetable
from engines.run.watch import EVENTS_A_LOOK, Watch, begin_watch, see
from engines.scene import Scene
from engines.world import Choice, ContactPhase, FloatArray, Moment, Pose, Resolution, Step

PACKAGE = Path(__file__).parents[1]
"""The folder of all that is compiled here."""

PHASE, PHASES = Step._fields.index("phase"), tuple(ContactPhase)


@dataclass(slots=True)
class Run:
    """What is known of a body that rocks; the first one steps and sees what concerns all."""

    pace: Pace
    landing: Landing
    watch: Watch
    spread: Spread
    slide: Slide


class Lists(NamedTuple):
    """What grows with motion and time: ground (m + 1, 8), stops, loads (l, 3), rows, events."""

    ground: FloatArray
    heaving: FloatArray  # as the ground, upwards
    stops: FloatArray
    loads: FloatArray
    rows: FloatArray
    events: FloatArray


def look(runs: Sequence[Run], lists: Lists, step: FloatArray, state: FloatArray) -> bool:
    """See a state (bodies, 4), and write the next step (12,); return whether the run goes on."""
    if runs[0].pace.last_dt > 0.0 and not undecided(runs, lists, state):
        return False
    chosen = next_step(runs, lists, state)
    step[0], step[1], step[2] = chosen.dt_s, chosen.end_s, chosen.kick_s
    step[3], step[4] = chosen.pull_x, chosen.pull_z
    step[5], step[6], step[7] = chosen.base_kick, chosen.base_velocity, chosen.base_x
    step[8], step[9] = chosen.phase, chosen.side
    step[10], step[11] = chosen.base_rise, chosen.base_z
    return True


def next_step(runs: Sequence[Run], lists: Lists, state: FloatArray) -> Step:
    """Return the step that follows a state, and advance to its end; see `look`."""
    run = runs[0]
    pace = run.pace
    choice = Choice(pace.dt, ContactPhase.SWING, 0.0)
    if pace.policy != FIXED:
        pass_to(pace, lists.stops, lists.loads)
        if pace.policy == LANDING:
            choice = choose(run.landing, pace, pose_in(state, 0), run.watch.lifted)
        else:
            choice = Choice(even(pace.left, pace.dt), ContactPhase.SWING, 0.0)
    return advance(pace, lists.ground, lists.heaving, choice)


def pose_in(state: FloatArray, body: int) -> Pose:
    """Return the pose of a body in a state."""
    row = state[body]
    return Pose(row[0], row[1], row[2], row[3])


def undecided(runs: Sequence[Run], lists: Lists, state: FloatArray) -> bool:
    """See the state at the end of a step; return whether the run goes on; see `look`."""
    first = runs[0]
    pace = first.pace
    if pace.time <= 0.0:  # nothing is looked at before the motion, nor where a box has crept to
        if first.slide.on:
            slide = first.slide
            slide.place = slide.origin = slide.stays_at = state[0][0] - slide.home
        return True
    if first.slide.on:
        see_slide(first.slide, lists.rows[0], lists.events[0], pace.time, pose_in(state, 0))
        return not (first.slide.done or first.slide.problem)
    see_spread(first.spread, first.watch, state)
    goes_on = False
    for body in range(len(runs)):
        watch = runs[body].watch
        if not watch.done:
            pose = pose_in(state, body)
            see(watch, lists.rows[body], lists.events[body], pace.time, pace.last_dt, pose)
        if watch.problem or watch.overturned:
            return False
        goes_on = goes_on or not watch.done
    return goes_on


class Monitor:
    """Looks at a run, in ordinary steps dt_s [s] of an engine whose velocity holds at a moment."""

    def __init__(
        self, scene: Scene, dt_s: float, stepping: Stepping, moment: Moment, resolution: Resolution
    ) -> None:
        rocking = scene.layout.rocking
        pace = begin_pace(scene, dt_s, stepping, moment, resolution)
        # with a preset's own friction a slide is said, and is no failure up to SLIDE_WIDTHS
        lands = stepping is Stepping.LANDING and scene.friction is not None
        self.runs: Sequence[Run] = [
            Run(
                pace,
                begin_landing(scene, dt_s, moment, resolution),
                begin_watch(scene, body, dt_s, lands, moment, resolution),
                begin_spread(scene.layout),
                Slide() if rocking else begin_slide(scene),
            )
            for body in scene.bodies[: max(rocking, 1)]
        ]
        ground, heaving = (np.array(rows_of(each)) for each in (scene.shaking, scene.heaving))
        rows = np.zeros((len(self.runs), 0, len(Row._fields)))
        if scene.times is not None:
            rows = np.array([[Row(0.0, 0.0, *scene.start)]] * len(self.runs))
            for run in self.runs:
                run.watch.rows = run.slide.rows = 1
        events = np.zeros((len(self.runs), 0, 4))
        self.lists = Lists(ground, heaving, *timetable(scene, pace.same), rows, events)
        self._scene = scene
        self._look: Any = compiled(look) if scene.compiled else look
        self._step, self._last = np.zeros(len(Step._fields)), np.empty(0)
        self._shape = len(scene.bodies), len(Pose._fields)
        if scene.compiled:
            self.runs = records(self.runs)

    @property
    def goes_on(self) -> bool:
        """Whether the response is neither decided nor spoilt."""
        slide = self.runs[0].slide
        if slide.on:
            return not (slide.done or slide.problem)
        watches = [run.watch for run in self.runs]
        spoilt = any(watch.problem or watch.overturned for watch in watches)
        return not (spoilt or all(watch.done for watch in watches))

    def make_room(self, looks: int) -> None:
        """Make room for what so many looks may write down, and one event to complete the last."""
        slide, watches = self.runs[0].slide, [run.watch for run in self.runs]
        rows, events = self.lists.rows, self.lists.events
        if self._scene.times is not None:
            rows = _roomy(rows, max(*(watch.rows for watch in watches), slide.rows), looks)
        used = max(*(watch.events for watch in watches), slide.slips)
        events = _roomy(events, used, EVENTS_A_LOOK * looks + 1)
        self.lists = self.lists._replace(rows=rows, events=events)

    def next(self, state: ArrayLike) -> Step | None:
        """See the state (bodies, 4) after a step; return the next one, or None if all is over."""
        # most engines fill the same array again
        where = self._last if state is self._last else self._checked(state)
        # plain numbers are the faster ones for Python
        seen: Any = where if self._scene.compiled else where.tolist()
        if not self._look(self.runs, self.lists, self._step, seen):
            return None
        numbers: list[Any] = self._step.tolist()
        numbers[PHASE] = PHASES[int(numbers[PHASE])]
        return Step(*numbers)

    def _checked(self, state: ArrayLike) -> FloatArray:
        where = np.asarray(state, dtype=np.float64)
        if where.shape != self._shape:
            words = f"it must be {self._shape}, a row for each body"
            raise ValueError(f"the engine's state has the shape {where.shape}; {words}")
        self._last = where
        return where


def _roomy(tables: FloatArray, used: int, more: int) -> FloatArray:
    """Return tables (bodies, rows, columns) that have room for so many more rows than are used."""
    if used + more <= tables.shape[1]:
        return tables
    larger = np.zeros((len(tables), 2 * (used + more), tables.shape[2]))
    larger[:, :used] = tables[:, :used]
    return larger


LOADING, COMPILING = 20_000, 100_000
"""Steps in Python that take as long as to load compiled code, and to compile it."""

patience: float | None = None
"""Steps for which this process goes on in Python: as many as take as long."""


def pays_to_compile(scene: Scene, dt_s: float) -> bool:
    """Return whether to look by compiled code, which is decided before a run, by its steps."""
    global patience
    if not scene.compiled or os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0"):
        return False
    if patience is None:
        patience = LOADING + (0 if are_compiled(PACKAGE) else COMPILING)
    patience -= scene.watched / dt_s
    return patience < 0.0 or Kernel.cases == math.inf  # there are many cases to come


def compile_look() -> None:
    """Compile what looks at a run, if that has not been done on this machine."""
    block, pulse = RigidBlock(width=0.5, height=1.5), SinePulse(amplitude=1.0, omega=1.0)
    scene = Scene(system=block, motion=pulse)
    monitor = Monitor(scene, 1e-3, Stepping.LANDING, Moment.MIDDLE, Resolution())
    monitor.make_room(1)
    monitor.next([[getattr(body.at, name) for name in Pose._fields] for body in scene.bodies])


def records(states: Sequence[Any]) -> Any:
    """Return states as an array of numpy's records, which compiled code reads and writes."""
    made = np.zeros(len(states), _record(_kind_of(states[0])))
    made[:] = [_values_of(each) for each in states]
    return made


def _kind_of(state: Any) -> np.dtype[Any]:
    """Return the type of the record of a state, by what its fields are declared as."""
    kinds, hints = [], get_type_hints(type(state))
    for item in fields(state):
        value, hint = getattr(state, item.name), hints[item.name]
        if is_dataclass(value):
            kinds.append((item.name, _kind_of(value)))
        elif isinstance(value, np.ndarray):
            kinds.append((item.name, np.dtype((value.dtype, value.shape))))
        else:
            kinds.append((item.name, np.dtype(hint)))
    return np.dtype(kinds, align=True)


def _values_of(value: Any) -> Any:
    if is_dataclass(value):
        return tuple(_values_of(getattr(value, item.name)) for item in fields(value))
    return value


@cache
def _record(kind: np.dtype[Any]) -> np.dtype[Any]:
    """Return one object for equal types: numba would compare two, for long, at every call."""
    return np.dtype((np.record, kind))


@cache
def compiled(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function of states compiled with all functions that it calls."""
    return Kernel(function, PACKAGE, arrays=True).compiled
