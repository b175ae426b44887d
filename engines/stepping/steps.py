"""Steps: what a policy chooses, and what the base does meanwhile.

A policy chooses how long a step is. It never decides what the state becomes: the block lifts,
strikes its base and comes to rest by the engine's own contact, whatever the policy expects.
"""

from typing import NamedTuple, Protocol

from engines.scene import Scene
from engines.stepping.ground import mean_velocity_of
from engines.stepping.timetable import Timetable
from engines.world import Grip, Moment, Pose, Step


class Choice(NamedTuple):
    """How long a step is [s], what it is for, and the corner turned about (0: both hold)."""

    dt_s: float
    grip: Grip
    side: float


class Policy(Protocol):
    """Chooses the steps of a run."""

    def choose(self, time: float, pose: Pose, lifted: bool) -> Choice:
        """Choose the step from `time` [s] on, where the block has the pose `pose`."""


class Stepper:
    """Makes a policy's choices into steps, with what the base does meanwhile.

    Parameters
    ----------
    policy : Policy
        Chooses the steps.
    scene : Scene
        What is being simulated.
    moment : Moment, optional
        At which moment of a step the engine's velocity holds.
    """

    def __init__(self, policy: Policy, scene: Scene, moment: Moment = Moment.MIDDLE) -> None:
        self._policy = policy
        self._mean_velocity = mean_velocity_of(scene.motion.segments())
        self._gravity, self._felt = scene.block.gravity, scene.frame == "base"
        self._moment, self._part = moment, moment.value
        self._velocity = self._place = self._last_dt = 0.0
        self.time = 0.0

    def next(self, pose: Pose, lifted: bool) -> Step:
        """Return the next step and advance `time` [s] to its end."""
        dt, grip, side = self._policy.choose(self.time, pose, lifted)
        begin, end = self.time, self.time + dt
        # from the moment of the last velocity to that of this one
        kick_s = self._part * dt + (1.0 - self._part) * self._last_dt
        mean = self._mean_velocity(begin, end)
        velocity = mean if self._moment is Moment.MIDDLE else self._velocity_at(end, dt)
        base_kick, self._velocity = velocity - self._velocity, velocity
        self._place += dt * mean
        self.time, self._last_dt = end, dt
        pull_x = -base_kick / dt if self._felt else 0.0
        pull_z = -self._gravity * kick_s / dt
        return Step(dt, end, kick_s, pull_x, pull_z, base_kick, velocity, self._place, grip, side)

    def _velocity_at(self, end: float, dt: float) -> float:
        """Base velocity [m/s] to which the block's velocity after a step belongs."""
        return self._mean_velocity(end, end if self._moment is Moment.END else end + dt)


class FixedSteps:
    """Steps that are all equal.

    Parameters
    ----------
    dt_s : float
        Step [s].
    """

    def __init__(self, dt_s: float) -> None:
        self._choice = Choice(dt_s, Grip.SWING, 0.0)

    def choose(self, time: float, pose: Pose, lifted: bool) -> Choice:
        """Return the step."""
        return self._choice


class Looks:
    """Even steps between the corners of the base's motion, for an engine with steps of its own.

    Parameters
    ----------
    scene : Scene
        What is being simulated.
    dt_s : float
        Longest time [s] between two looks at the block.
    """

    def __init__(self, scene: Scene, dt_s: float) -> None:
        self._dt = dt_s
        self._times = Timetable(scene, dt_s)

    def choose(self, time: float, pose: Pose, lifted: bool) -> Choice:
        """Choose the time of the next look."""
        self._times.pass_to(time)
        return Choice(self._times.even(self._dt), Grip.SWING, 0.0)
