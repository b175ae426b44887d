"""One look a step: take in where the block is, and choose the step that follows.

All that a run has to know beside the engine is kept in one `Run`, which compiled functions read and
write: `look` is called once a step for any world, or from within a world's own compiled loop.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from analytic.block import RigidBlock
from analytic.motion import SinePulse
from analytic.response import Problem, Response
from engines.declaration import Stepping
from engines.parts.compiled import FloatArray, State, kernel, shared, spend
from engines.run.ground import rows_of
from engines.run.steps import Pace, begin_pace, next_step
from engines.run.timetable import timetable
from engines.scene import Scene
from engines.watching.answer import problem_of, response_of
from engines.watching.history import sample
from engines.watching.observe import (
    EVENTS_A_LOOK,
    Watch,
    begin_watch,
    see,
)
from engines.watching.swing import Row
from engines.world import UNLIMITED, Grip, Moment, Pose, Resolution, Step

Lists = tuple[Any, FloatArray, FloatArray, FloatArray, FloatArray]
"""The ground, the stops, the loads, the rows of a history, and the events."""

GRIP, GRIPS = Step._fields.index("grip"), tuple(Grip)


class Run(State):
    """What is known of a run: how it steps, and what was seen.

    Attributes
    ----------
    pace : Pace
    watch : Watch
    """

    pace: Pace
    watch: Watch


@shared
def onward(run: Run, lists: Lists, pose: Pose) -> Step:
    """Return the step from where the block has the pose `pose`."""
    ground, stops, loads, _, _ = lists
    return next_step(run.pace, ground, stops, loads, pose, run.watch.lifted)


@shared
def undecided(run: Run, lists: Lists, pose: Pose) -> bool:
    """See the pose at the end of the step; return whether the run goes on."""
    _, _, _, rows, events = lists
    see(run.watch, rows, events, run.pace.time, run.pace.last_dt, pose)
    return not (run.watch.done or run.watch.problem)


@kernel
def look(
    runs: Sequence[Run],
    lists: Lists,
    step: FloatArray,
    x: float,
    z: float,
    theta: float,
    rate: float,
) -> bool:
    """See a pose, and choose the next step unless the run is over; return whether it goes on."""
    spend()
    run, pose = runs[0], Pose(x, z, theta, rate)
    if run.pace.time > 0.0 and not undecided(run, lists, pose):
        return False
    put_step(step, onward(run, lists, pose))
    return True


@shared
def put_step(numbers: FloatArray, step: Step) -> None:
    """Write a step down, for Python to read."""
    numbers[0], numbers[1], numbers[2] = step.dt_s, step.end_s, step.kick_s
    numbers[3], numbers[4] = step.pull_x, step.pull_z
    numbers[5], numbers[6], numbers[7] = step.base_kick, step.base_velocity, step.base_x
    numbers[8], numbers[9] = step.grip, step.side


class Look:
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
    runs : array (1,)
        What is known, a `Run`.
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
        self.runs = Run.blank()
        self.run = run = self.runs[0]
        begin_pace(run.pace, scene, dt_s, stepping, moment, resolution)
        begin_watch(run.watch, scene, dt_s, moment, resolution)
        ground = np.array(rows_of(scene.motion.segments().tolist()))
        table = timetable(scene, dt_s, resolution.time_s)
        rows = np.zeros((0, len(Row._fields)))
        if scene.times is not None:
            rows = np.array([Row(0.0, 0.0, *scene.start)])
            run.watch.rows = 1
        self.lists: Lists = (ground, *table, rows, np.zeros((0, 4)))
        self._times = scene.times
        self._numbers = np.zeros(len(Step._fields))

    @property
    def goes_on(self) -> bool:
        """Whether the response is neither decided nor spoilt."""
        watch = self.run.watch
        return not (watch.done or watch.problem)

    def make_room(self, looks: int) -> None:
        """Make room for what so many looks may write down."""
        *_, rows, events = self.lists
        watch = self.run.watch
        if self._times is not None:
            rows = roomy(rows, watch.rows, looks)
        # the response completes one more
        events = roomy(events, watch.events, EVENTS_A_LOOK * looks + 1)
        self.lists = (*self.lists[:3], rows, events)

    def next(self, pose: Pose) -> Step | None:
        """See the pose after a step; return the next step, or None where the run is over."""
        x, z, theta, rate = pose
        where = float(x), float(z), float(theta), float(rate)
        if not look(self.runs, self.lists, self._numbers, *where):
            return None
        numbers: list[Any] = self._numbers.tolist()
        numbers[GRIP] = GRIPS[int(numbers[GRIP])]
        return Step(*numbers)

    @property
    def problem(self) -> Problem | None:
        """Why the response is no longer that of a rocking block."""
        return problem_of(self.run.watch)

    def response(self, *, steps: int, wall_s: float) -> Response:
        """Return what was seen until now."""
        *_, rows, events = self.lists
        watch, history = self.run.watch, None
        if self._times is not None:
            history = sample(rows[: watch.rows], self._times)
        return response_of(watch, events, history, steps=steps, wall_s=wall_s)


def compile_look() -> None:
    """Compile what looks at a run, if that has not been done on this machine."""
    scene = Scene(
        block=RigidBlock(width=0.5, height=1.5), motion=SinePulse(amplitude=1.0, omega=1.0)
    )
    look = Look(scene, dt_s=1e-3)
    look.make_room(1)
    look.next(Pose(*(getattr(scene.beginning, name) for name in Pose._fields)))


def roomy(table: FloatArray, used: int, more: int) -> FloatArray:
    """Return a table, or a larger copy, that has room for so many more rows than are used."""
    if used + more <= len(table):
        return table
    larger = np.zeros((2 * (used + more), table.shape[1]))
    larger[:used] = table[:used]
    return larger
