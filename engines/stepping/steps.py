"""Steps: what a policy chooses, and what the base does meanwhile.

A policy chooses how long a step is. It never decides what the state becomes: the block lifts,
strikes its base and comes to rest by the engine's own contact, whatever the policy expects.
"""

from typing import NamedTuple, Protocol

from engines.scene import Grip, Pose, Scene, Step
from engines.stepping.ground import mean_velocity_of


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
    """

    def __init__(self, policy: Policy, scene: Scene) -> None:
        self._policy = policy
        self._mean_velocity = mean_velocity_of(scene.motion)
        self._velocity = self._last_dt = 0.0
        self.time = 0.0

    def next(self, pose: Pose, lifted: bool) -> Step:
        """Return the next step and advance `time` [s] to its end."""
        dt, grip, side = self._policy.choose(self.time, pose, lifted)
        end = self.time + dt
        velocity = self._mean_velocity(self.time, end)
        step = Step(dt, 0.5 * (self._last_dt + dt), velocity - self._velocity, grip, side)
        self._velocity, self._last_dt, self.time = velocity, dt, end
        return step


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
