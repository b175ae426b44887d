"""When to step: a fixed step, or steps that land on what happens.

A policy chooses how long a step is. It never decides what the state becomes: the block lifts,
strikes its base and comes to rest by the engine's own contact, whatever the policy expects. What
it expects comes from the poses seen until now and from the base's motion.
"""

import bisect
import math
from typing import NamedTuple, Protocol

from engines.ground import Load, loads_of, mean_velocity_of
from engines.scene import Grip, Pose, Scene, Step

SWING_STEPS = 24
"""Steps at least in a swing between two impacts."""

LOAD_STEPS = 48
"""Steps at least while the base accelerates enough to lift a resting block, ..."""

LEAST_LOAD = 0.02
"""... but not below this part of the ordinary step."""

SHORTEST_SWING = 1e-4
"""A swing that would last no longer than this, in units of 1/p, is left to come to rest."""

REMAINDER = 0.1
"""Part of the way to an event that each step of an approach leaves for the next."""

NEAR = 1e-6
"""An impact is near when less than this part of the ordinary step is left."""

UPLIFT_NEAR = 2e-3
"""The same for an uplift, before which nothing moves."""

STRIKES = 4
"""Steps at least through an impact, in which the contact takes its effect, ..."""

MOST_STRIKES = 12
"""... and at most."""

SETTLED = 1e-6
"""An impact is over when a step changes the angular velocity by less than this part of it."""

ROUNDING = 1e-9
"""Times closer than this part of the ordinary step are the same."""


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
    scene : Scene
        What is being simulated.
    dt_s : float
        Ordinary step [s].
    """

    def __init__(self, scene: Scene, dt_s: float) -> None:
        landing = scene.preset == "landing"
        self._policy: Policy = LandingSteps(scene, dt_s) if landing else FixedSteps(dt_s)
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


class LandingSteps:
    """Steps that end on impacts, on uplifts and on the corners of the base's motion.

    Parameters
    ----------
    scene : Scene
        What is being simulated.
    dt_s : float
        Ordinary step [s].
    """

    def __init__(self, scene: Scene, dt_s: float) -> None:
        block = scene.block
        self._dt = dt_s
        self._half_width, self._half_height = 0.5 * block.width, 0.5 * block.height
        # what a block at rest on one corner is accelerated by towards the other
        self._fall = block.p**2 * math.sin(block.alpha)
        self._shortest = SHORTEST_SWING / block.p
        self._loads = loads_of(scene.motion, block.gravity * math.tan(block.alpha), dt_s)
        ends = () if scene.duration is None else (scene.duration,)
        starts = (time for load in self._loads for time in (load.begin, load.end))
        self._stops = sorted({*scene.motion.breakpoints, *starts, *ends} - {0.0})
        self._side = 0.0
        self._resting, self._launched = True, False
        self._approaching = False
        self._strikes = 0
        self._strike = 0.0
        self._last_dt = self._last_rate = self._kick = 0.0

    def choose(self, time: float, pose: Pose, lifted: bool) -> Choice:
        """Choose the step from `time` [s] on, where the block has the pose `pose`."""
        choice = self._choose(time + ROUNDING * self._dt, pose, lifted)
        self._kick = 0.5 * (self._last_dt + choice.dt_s)
        self._last_dt, self._last_rate = choice.dt_s, pose.rate
        return choice

    def _choose(self, time: float, pose: Pose, lifted: bool) -> Choice:
        if self._strikes:
            return self._through(time, pose)
        if self._resting and lifted:
            self._resting = self._launched = False
        elif self._resting:
            return self._at_rest(time, pose)
        if not self._approaching and lifted:
            self._side = math.copysign(1.0, pose.theta)
        longest = self._longest(time, pose)
        ahead = self._until_impact(pose)
        if self._approaching or ahead < min(2.0 * longest, self._left(time)):
            return self._towards_impact(ahead, longest)
        return Choice(self._even(time, longest), Grip.SWING, self._side)

    def _at_rest(self, time: float, pose: Pose) -> Choice:
        load = self._load(time)
        if load is not None and load.begin <= time:
            self._side = load.side
            return Choice(self._even(time, self._longest(time, pose)), Grip.REST, load.side)
        self._side = 0.0
        left = self._left(time)
        if (
            load is not None
            and left <= self._dt
            and math.isclose(time + left, load.begin, abs_tol=ROUNDING * self._dt)
        ):
            rest = 0.0 if left <= UPLIFT_NEAR * self._dt else REMAINDER
            return Choice((1.0 - rest) * left, Grip.REST, load.side)
        return Choice(self._even(time, self._dt), Grip.REST, 0.0)

    def _towards_impact(self, ahead: float, longest: float) -> Choice:
        if not self._approaching and ahead > longest:
            return Choice(0.5 * ahead, Grip.SWING, self._side)
        self._approaching = True
        least = NEAR * self._dt
        if ahead > least and math.isfinite(ahead):
            return Choice((1.0 - REMAINDER) * ahead, Grip.APPROACH, self._side)
        self._approaching = False
        self._strikes, self._strike = 1, least
        return Choice(least, Grip.STRIKE, self._side)

    def _through(self, time: float, pose: Pose) -> Choice:
        """Step on in the shortest steps until the impact is over."""
        self._strikes += 1
        settled = abs(pose.rate - self._last_rate) <= SETTLED * abs(pose.rate)
        over = self._strikes > STRIKES and settled and self._gap(pose) <= 0.0
        if not over and self._strikes <= MOST_STRIKES:
            return Choice(self._strike, Grip.STRIKE, self._side)
        self._strikes = 0
        self._launched = True
        if 2.0 * abs(pose.rate) < self._fall * self._shortest:
            self._resting, self._side = True, 0.0
            return self._at_rest(time, pose)
        self._side = math.copysign(1.0, pose.rate)
        return Choice(self._even(time, self._longest(time, pose)), Grip.SWING, self._side)

    def _until_impact(self, pose: Pose) -> float:
        """Time [s] until the free corner reaches the base if the acceleration stays as it is."""
        side = self._side
        acceleration = (pose.rate - self._last_rate) / self._kick * side if self._kick else 0.0
        rate = pose.rate * side + 0.5 * acceleration * self._last_dt
        angle = self._gap(pose) / (2.0 * self._half_width)
        inside = rate * rate - 2.0 * acceleration * angle
        if rate >= 0.0 or inside < 0.0:
            return math.inf
        return max(2.0 * angle / (math.sqrt(inside) - rate), 0.0)

    def _gap(self, pose: Pose) -> float:
        """Height [m] of the free corner above the base."""
        raised = self._side * self._half_width * math.sin(pose.theta)
        return pose.z - self._half_height * math.cos(pose.theta) + raised

    def _longest(self, time: float, pose: Pose) -> float:
        """Longest step [s] that resolves the swing and the load."""
        longest = self._dt
        if self._launched and not self._resting:
            swing = math.sqrt(pose.rate**2 + 2.0 * self._fall * abs(pose.theta)) / self._fall
            longest = min(longest, max(2.0 * swing, self._shortest) / SWING_STEPS)
        load = self._load(time)
        if load is not None:
            resolved = max((load.end - load.begin) / LOAD_STEPS, LEAST_LOAD * self._dt)
            longest = min(longest, resolved)
        return longest

    def _load(self, time: float) -> Load | None:
        """Return the load at or next after a time."""
        i = bisect.bisect_right(self._loads, time, key=lambda load: load.end)
        return self._loads[i] if i < len(self._loads) else None

    def _left(self, time: float) -> float:
        """Time [s] left until the next stop."""
        i = bisect.bisect_right(self._stops, time)
        return self._stops[i] - time if i < len(self._stops) else math.inf

    def _even(self, time: float, longest: float) -> float:
        """Longest step [s] of which a whole number leads to the next stop."""
        left = self._left(time)
        if left == math.inf:
            return longest
        return left / math.ceil(left / longest * (1.0 - ROUNDING))
