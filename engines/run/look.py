"""One look a step: take in where the block is, and choose the step that follows.

All that a run has to know beside the engine is kept in one `Run`, which compiled functions read and
write: `look` is called once a step for any world, or from within a world's own compiled loop.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from analytic.block import RigidBlock
from analytic.motion import SinePulse
from analytic.response import History, Problem, Response
from engines.declaration import Stepping
from engines.parts.compiled import State, interpreted, kernel, shared, spend
from engines.run.answer import problem_of, response_of, slide_response, together
from engines.run.frame import Spread, begin_spread, observables_of, see_spread
from engines.run.ground import rows_of
from engines.run.history import sample
from engines.run.slide import Slide, begin_slide, see_slide
from engines.run.steps import Pace, begin_pace, next_step
from engines.run.timetable import timetable
from engines.run.watch import EVENTS_A_LOOK, Row, Watch, begin_watch, see
from engines.scene import Scene
from engines.world import UNLIMITED, ContactPhase, FloatArray, Moment, Pose, Resolution, Step

Lists = tuple[Any, FloatArray, FloatArray, FloatArray, FloatArray]
"""The ground, the stops and the loads, as for `engines.run.steps.next_step`; and of each body that
rocks the rows of a history (bodies, k, 4), a `Row` each, and the events (bodies, k, 4), their
columns as in `engines.run.watch`."""

PHASE, PHASES = Step._fields.index("phase"), tuple(ContactPhase)


class Run(State):
    """What is known of a run: how it steps, and what was seen.

    A run has one for each body that rocks, and one where there is none; the first one steps, and
    sees what concerns all.

    Attributes
    ----------
    pace : Pace
    watch : Watch
        Of the body, where it rocks.
    spread : Spread
        Of a frame.
    slide : Slide
        Of a box that slides.
    """

    pace: Pace
    watch: Watch
    spread: Spread
    slide: Slide


@shared
def onward(runs: Sequence[Run], lists: Lists, state: FloatArray) -> Step:
    """Return the step that follows a state, and advance to its end.

    Parameters
    ----------
    runs : sequence of Run, one for each body that rocks
    lists : tuple, see `Lists`
    state : ndarray (bodies, 4), a `Pose` a row
    """
    ground, stops, loads, _, _ = lists
    run = runs[0]
    return next_step(run.pace, ground, stops, loads, pose_in(state, 0), run.watch.lifted)


@shared
def pose_in(state: FloatArray, body: int) -> Pose:
    """Return the pose of a body in a state."""
    row = state[body]
    return Pose(row[0], row[1], row[2], row[3])


@shared
def undecided(runs: Sequence[Run], lists: Lists, state: FloatArray) -> bool:
    """See the state at the end of the step; return whether the run goes on.

    Parameters
    ----------
    runs, lists, state
        As for `onward`.
    """
    _, _, _, rows, events = lists
    first = runs[0]
    if first.slide.on:
        see_slide(first.slide, rows[0], events[0], first.pace.time, pose_in(state, 0))
        return not (first.slide.done or first.slide.problem)
    see_spread(first.spread, state, first.watch.alpha)
    first.watch.beam_slide = first.spread.slide
    goes_on = False
    for body in range(len(runs)):
        watch = runs[body].watch
        if not watch.done:
            pose = pose_in(state, body)
            see(watch, rows[body], events[body], first.pace.time, first.pace.last_dt, pose)
        if watch.problem or watch.overturned:
            return False
        goes_on = goes_on or not watch.done
    return goes_on


@kernel
def monitor(runs: Sequence[Run], lists: Lists, step: FloatArray, state: FloatArray) -> bool:
    """See a state, and choose the next step unless the run is over; return whether it goes on.

    Parameters
    ----------
    runs, lists, state
        As for `onward`; the runs are updated, and lists written.
    step : ndarray (10,), where the next step is written, as by `put_step`

    Raises
    ------
    SpentError
        If it is interpreted, and one look too many for that.
    """
    spend()
    if runs[0].pace.time > 0.0 and not undecided(runs, lists, state):
        return False
    put_step(step, onward(runs, lists, state))
    return True


@shared
def put_step(numbers: FloatArray, step: Step) -> None:
    """Write a step down, for Python to read.

    Parameters
    ----------
    numbers : ndarray (10,), to be written in the order of the fields
    step : Step
    """
    numbers[0], numbers[1], numbers[2] = step.dt_s, step.end_s, step.kick_s
    numbers[3], numbers[4] = step.pull_x, step.pull_z
    numbers[5], numbers[6], numbers[7] = step.base_kick, step.base_velocity, step.base_x
    numbers[8], numbers[9] = step.phase, step.side


class Monitor:
    """Looks at a run from Python.

    Parameters
    ----------
    scene : Scene
        What is being simulated.
    dt_s : float
        Ordinary step [s].
    stepping : Stepping
        Who chooses the steps.
    moment : Moment, optional
        At which moment of a step the engine's velocity holds.
    resolution : Resolution, optional
        What the engine's numbers tell apart.

    Attributes
    ----------
    runs : array
        What is known, a `Run` for each body that rocks.
    lists : tuple
        And what of it grows with the motion and the run; see `Lists`.
    """

    def __init__(
        self,
        scene: Scene,
        dt_s: float,
        stepping: Stepping = Stepping.LANDING,
        moment: Moment = Moment.MIDDLE,
        resolution: Resolution = UNLIMITED,
    ) -> None:
        rocking = scene.layout.rocking
        self.runs = Run.blank(max(rocking, 1))
        first = self.runs[0]
        begin_pace(first.pace, scene, dt_s, stepping, moment, resolution)
        # with a preset's own friction a slide is said, and is no failure up to SLIDE_WIDTHS
        lands = stepping is Stepping.LANDING and scene.friction is not None
        for run, body in zip(self.runs, scene.bodies[:rocking], strict=False):
            begin_watch(run.watch, scene, body, dt_s, lands, moment, resolution)
        begin_spread(first.spread, scene.layout)
        if not rocking:
            begin_slide(first.slide, scene)
        ground = np.array(rows_of(scene.motion.segments().tolist()))
        table = timetable(scene, dt_s, resolution.time_s)
        rows = np.zeros((len(self.runs), 0, len(Row._fields)))
        if scene.times is not None:
            rows = np.array([[Row(0.0, 0.0, *scene.start)]] * len(self.runs))
            for run in self.runs:
                run.watch.rows = run.slide.rows = 1
        self.lists: Lists = (ground, *table, rows, np.zeros((len(self.runs), 0, 4)))
        self._times, self._alpha = scene.times, scene.system.alpha
        self._numbers = np.zeros(len(Step._fields))
        self._shape = len(scene.bodies), len(Pose._fields)
        self._plain, self._last = interpreted(), np.empty(0)
        self._monitor: Any = monitor

    @property
    def watches(self) -> Sequence[Watch]:
        """What was seen of each body that rocks."""
        return [run.watch for run in self.runs]

    @property
    def goes_on(self) -> bool:
        """Whether the response is neither decided nor spoilt."""
        slide = self.runs[0].slide
        if slide.on:
            return not (slide.done or slide.problem)
        spoilt = any(watch.problem or watch.overturned for watch in self.watches)
        return not (spoilt or all(watch.done for watch in self.watches))

    def make_room(self, looks: int) -> None:
        """Make room for what so many looks may write down."""
        *_, rows, events = self.lists
        if self._times is not None:
            kept = max(*(watch.rows for watch in self.watches), self.runs[0].slide.rows)
            rows = roomy(rows, kept, looks)
        # the response completes one more
        used = max(*(watch.events for watch in self.watches), self.runs[0].slide.slips)
        events = roomy(events, used, EVENTS_A_LOOK * looks + 1)
        self.lists = (*self.lists[:3], rows, events)

    def next(self, state: ArrayLike) -> Step | None:
        """See the state after a step; return the next step, or None where the run is over.

        Parameters
        ----------
        state : array_like (bodies, 4), a `Pose` a row

        Raises
        ------
        ValueError
            If the state has another shape.
        """
        # most engines fill the same array again
        where = self._last if state is self._last else self._checked(state)
        # plain numbers are the faster ones for Python
        seen: Any = where.tolist() if self._plain else where
        if not self._monitor(self.runs, self.lists, self._numbers, seen):
            return None
        if self._monitor is monitor and not self._plain:
            self._monitor = monitor.compiled  # it is, by now
        numbers: list[Any] = self._numbers.tolist()
        numbers[PHASE] = PHASES[int(numbers[PHASE])]
        return Step(*numbers)

    def _checked(self, state: ArrayLike) -> FloatArray:
        where = np.asarray(state, dtype=np.float64)
        if where.shape != self._shape:
            words = f"it must be {self._shape}, a row for each body"
            raise ValueError(f"the engine's state has the shape {where.shape}; {words}")
        self._last = where
        return where

    @property
    def problem(self) -> Problem | None:
        """Why the response is no longer that of what was posed."""
        seen: list[Watch | Slide] = [self.runs[0].slide, *self.watches]
        return next((problem_of(each) for each in seen if each.problem), None)

    def response(self, *, steps: int, wall_s: float) -> Response:
        """Return what was seen until now."""
        *_, rows, events = self.lists
        first = self.runs[0]
        if first.slide.on:
            history = self._history(rows[0, : first.slide.rows])
            found = slide_response(first.slide, events[0], history)
        else:
            each = [
                response_of(run.watch, its_events, self._history(its_rows[: run.watch.rows]))
                for run, its_rows, its_events in zip(self.runs, rows, events, strict=True)
            ]
            found = together(each, observables_of(first.spread, self._alpha))
        return replace(found, steps=steps, wall_s=wall_s)

    def _history(self, rows: FloatArray) -> History | None:
        return None if self._times is None else sample(rows, self._times)


def compile_monitor() -> None:
    """Compile what looks at a run, if that has not been done on this machine."""
    scene = Scene(
        system=RigidBlock(width=0.5, height=1.5), motion=SinePulse(amplitude=1.0, omega=1.0)
    )
    monitor = Monitor(scene, dt_s=1e-3)
    monitor.make_room(1)
    monitor.next([[getattr(body.at, name) for name in Pose._fields] for body in scene.bodies])


def roomy(tables: FloatArray, used: int, more: int) -> FloatArray:
    """Return tables, or larger copies, that have room for so many more rows than are used.

    Parameters
    ----------
    tables : ndarray (bodies, rows, columns)
    used, more : int, rows
    """
    if used + more <= tables.shape[1]:
        return tables
    larger = np.zeros((len(tables), 2 * (used + more), tables.shape[2]))
    larger[:, :used] = tables[:, :used]
    return larger
