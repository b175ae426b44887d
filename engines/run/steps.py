"""Steps: how long they are, and what the base does meanwhile."""

from typing import Any

from engines.declaration import Stepping
from engines.parts.compiled import State, fill, shared
from engines.run import ground as plain
from engines.run.ground import Ground, mean_velocity_over
from engines.run.landing import Landing, begin_landing, choose
from engines.run.timetable import Times, begin_times, even, pass_to
from engines.scene import Scene
from engines.world import (
    UNLIMITED,
    Choice,
    ContactPhase,
    FloatArray,
    Moment,
    Pose,
    Resolution,
    Step,
)

for function in (
    plain.one_minus_sinc,
    plain.gained,
    plain.within,
    plain.segment_at,
    plain.mean_velocity_over,
):
    shared(function)  # they stay Python, for scripts that have nothing else

MIDDLE, END = Moment.MIDDLE.value, Moment.END.value

POLICIES = tuple(Stepping)
FIXED, LANDING, EVEN = map(POLICIES.index, (Stepping.FIXED, Stepping.LANDING, Stepping.OWN))


class Pace(State):
    """How a run steps, and where it is.

    Attributes
    ----------
    policy : int
        Which of `POLICIES` chooses.
    dt : float
        Ordinary step [s].
    part : float
        Part of a step that has passed at the moment of its velocity.
    gravity : float
        [m/s2].
    felt : bool
        Whether the block carries the body force of the base's acceleration, the base being at rest.
    time, last_dt : float
        End and length of the last step [s].
    velocity, place : float
        Of the base at the moment of the last velocity [m/s], and at the end of the step [m].
    times : Times
    landing : Landing
    """

    policy: int
    dt: float
    part: float
    gravity: float
    felt: bool
    time: float
    last_dt: float
    velocity: float
    place: float
    times: Times
    landing: Landing


def begin_pace(
    pace: Pace,
    scene: Scene,
    dt_s: float,
    stepping: Stepping,
    moment: Moment = Moment.MIDDLE,
    resolution: Resolution = UNLIMITED,
) -> None:
    """Prepare for the steps of a scene.

    Parameters
    ----------
    pace : Pace
        What is filled.
    scene : Scene
        What is being simulated.
    dt_s : float
        Ordinary step [s]; where an engine has steps of its own, the longest time between two looks.
    stepping : Stepping
        Who chooses the steps.
    moment : Moment, optional
        At which moment of a step the engine's velocity holds.
    resolution : Resolution, optional
        What the engine's numbers tell apart.
    """
    fill(
        pace,
        policy=policy_of(stepping, scene),
        dt=dt_s,
        part=moment.value,
        gravity=scene.system.gravity,
        felt=scene.frame != "world",
    )
    begin_times(pace.times, scene, dt_s, resolution.time_s)
    begin_landing(pace.landing, scene, dt_s, moment, resolution)


def policy_of(stepping: Stepping, scene: Scene) -> int:
    """Return which of `POLICIES` chooses: steps land on the impacts of what rocks."""
    lands = stepping is Stepping.LANDING
    return EVEN if lands and not scene.layout.rocking else POLICIES.index(stepping)


@shared
def next_step(
    pace: Pace, ground: Ground, stops: FloatArray, loads: FloatArray, pose: Pose, lifted: bool
) -> Step:
    """Return the next step, and advance to its end.

    Over the step the base has its mean velocity. In the frame "base" the block carries the body
    force -m u_g'' instead, the forcing of EQUATIONS.md, "From (1) and (2)".

    Parameters
    ----------
    pace : Pace, moved on
    ground : sequence of rows (m + 1, 8), from `ground.rows_of`
    stops : ndarray (k,), times that a step must not pass [s], of `timetable`
    loads : ndarray (l, 3), a `Load` a row, of `timetable`
    pose : Pose, of the block after the last step
    lifted : bool, whether it is aloft
    """
    dt, phase, side = chosen(pace, stops, loads, pose, lifted)
    begin, end = pace.time, pace.time + dt
    # from the moment of the last velocity to that of this one
    kick_s = pace.part * dt + (1.0 - pace.part) * pace.last_dt
    mean = mean_velocity_over(ground, begin, end)
    velocity = mean if pace.part == MIDDLE else velocity_at(pace, ground, end, dt)
    base_kick, pace.velocity = velocity - pace.velocity, velocity
    pace.place += dt * mean
    pace.time, pace.last_dt = end, dt
    pull_x = -base_kick / dt if pace.felt else 0.0
    pull_z = -pace.gravity * kick_s / dt
    purpose: Any = phase.value  # in compiled code a name has no number of its own
    return Step(dt, end, kick_s, pull_x, pull_z, base_kick, velocity, pace.place, purpose, side)


@shared
def velocity_at(pace: Pace, ground: Ground, end: float, dt: float) -> float:
    """Return the base velocity [m/s] to which the block's velocity after a step belongs.

    The step ends at `end` [s] and is `dt` [s] long.
    """
    return mean_velocity_over(ground, end, end if pace.part == END else end + dt)


@shared
def chosen(pace: Pace, stops: FloatArray, loads: FloatArray, pose: Pose, lifted: bool) -> Choice:
    """Choose the next step; one that is all equal says neither what it is for nor the corner.

    What it takes is said at `next_step`.
    """
    if pace.policy == FIXED:
        return Choice(pace.dt, ContactPhase.SWING, 0.0)
    pass_to(pace.times, stops, loads, pace.time)
    if pace.policy == LANDING:
        return choose(pace.landing, pace.times, pose, lifted)
    return Choice(even(pace.times.left, pace.dt), ContactPhase.SWING, 0.0)
