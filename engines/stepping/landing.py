"""Steps that end on what happens: impacts, uplifts, and the corners of the base's motion.

What to expect comes from the poses seen until now and from the base's motion; what happens is the
engine's, whatever was expected. Before an impact each step covers half of the way that is left, so
that the contact about which the block turns is never out of reach of the next step; through the
impact the steps are too short for anything but the contact to act.
"""

import math

from engines.scene import Scene
from engines.stepping.steps import Choice
from engines.stepping.timetable import NEVER, Timetable
from engines.world import UNLIMITED, Grip, Moment, Pose, Resolution

SWING_PART = 8.0
"""A swing between impacts is resolved as finely as the time 1/p over this by ordinary steps, ..."""

LOAD_PART = 4.0
"""... and a load, during which the base can lift a block at rest, as 1/p over this, ..."""

COARSEST = 1.0 / 6.0
"""... each in steps no longer than this part of it."""

LEAST_LOAD = 0.02
"""A load is not resolved more finely than by this part of the ordinary step."""

SHORTEST_SWING = 1e-4
"""A swing that would last no longer than this, in units of 1/p, is left to come to rest."""

REMAINDER = 0.5
"""Part of the way to an event that each step of an approach leaves for the next."""

NEAR = 1e-6
"""An impact is near when less than this part of the ordinary step is left, or than the shortest
time that the engine resolves, or ..."""

MOST_ACCELERATION = 3e9
"""... the time in which this angular acceleration [rad/s2] would stop the block; engines
take what is much larger for a failure."""

UPLIFT_NEAR = 2e-3
"""An uplift is near when less than this part of the ordinary step is left."""

STRIKES = 4
"""Steps at least through an impact, in which the contact takes its effect, ..."""

MOST_STRIKES = 12
"""... and at most."""

SETTLED = 1e-6
"""An impact is over when a step changes the angular velocity by less than this part of it."""

FIRST_PART = 0.02
"""The first step after an impact, or of a run that begins aloft, is this part of the next ones: a
contact that has just taken all velocity out of its point lets that rise by the square of the step.
"""

TOUCHING = 1e-9
"""A corner lower above the base than this part of the width touches it."""


class LandingSteps:
    """Steps that end on impacts, on uplifts and on the corners of the base's motion.

    Parameters
    ----------
    scene : Scene
        What is being simulated.
    dt_s : float
        Ordinary step [s].
    moment : Moment, optional
        At which moment of a step the engine's velocity holds.
    resolution : Resolution, optional
        What the engine's numbers tell apart: nothing finer is asked of it.
    """

    def __init__(
        self,
        scene: Scene,
        dt_s: float,
        moment: Moment = Moment.MIDDLE,
        resolution: Resolution = UNLIMITED,
    ) -> None:
        block = scene.block
        self._dt = dt_s
        self._width, self._half_height = block.width, 0.5 * block.height
        # what a block that stands on one corner is accelerated by towards the other
        self._fall = scene.hints.fall * block.p**2 * math.sin(block.alpha)
        self._swing_part = min(SWING_PART * block.p * dt_s, COARSEST)
        self._load_part = min(LOAD_PART * block.p * dt_s, COARSEST)
        # a swing that rises by no more than the engine's numbers tell apart
        unseen = 2.0 * math.sqrt(2.0 * resolution.length_m / (block.width * self._fall))
        self._shortest = max(SHORTEST_SWING / block.p, resolution.time_s / COARSEST, unseen)
        self._least = max(NEAR * dt_s, resolution.time_s)
        self._touching = max(TOUCHING * block.width, resolution.length_m)
        self._settled = max(SETTLED, resolution.part)
        self._part = moment.value
        self._times = Timetable(scene, dt_s, resolution.time_s)
        self._side = scene.side
        self._resting, self._bouncing, self._approaching = not scene.side, False, False
        self._strikes, self._strike_s = 0, 0.0
        self._last = Choice(0.0, Grip.REST, 0.0)
        # between the moments of the last two velocities
        self._last_rate = self._between = 0.0

    def choose(self, time: float, pose: Pose, lifted: bool) -> Choice:
        """Choose the step from `time` [s] on, where the block has the pose `pose`."""
        self._times.pass_to(time)
        if self._strikes:
            choice = self._through(pose)
        elif self._resting and not lifted:
            choice = self._at_rest()
        else:
            choice = self._aloft(pose, lifted)
        self._between = self._part * choice.dt_s + (1.0 - self._part) * self._last.dt_s
        self._last, self._last_rate = choice, pose.rate
        return choice

    def _at_rest(self) -> Choice:
        """Step on through the calm; come slowly where the block may lift.

        Equal steps, whatever corners the base's motion has meanwhile: a change of step would let
        go of a corner that carries little, near the onset.
        """
        times = self._times
        if times.loaded:
            self._side = times.load.side
            return Choice(times.even(self._longest()), Grip.REST, self._side)
        self._side = 0.0
        if not times.lifts_next or times.calm > self._dt:
            return Choice(times.even_in_calm(self._dt), Grip.REST, 0.0)
        # a short last step, or the first one aloft would feel forces of the time before
        part = 1.0 if times.calm <= UPLIFT_NEAR * self._dt else 1.0 - REMAINDER
        return Choice(part * times.calm, Grip.REST, times.load.side)

    def _aloft(self, pose: Pose, lifted: bool) -> Choice:
        """Step on until an impact is near."""
        if self._resting:
            self._resting = self._bouncing = False
        if lifted and not self._approaching:
            self._side = math.copysign(1.0, pose.theta)
        if self._bouncing and not lifted and self._swing_s(pose) < self._shortest:
            return self._settle()
        longest = self._longest(pose) if self._between else FIRST_PART * self._longest(pose)
        ahead = self._until_impact(pose)
        self._approaching = self._approaching and ahead < math.inf
        if self._approaching or ahead < min(2.0 * longest, self._times.left):
            return self._towards_impact(ahead, longest, pose)
        return Choice(self._times.even(longest), Grip.SWING, self._side)

    def _towards_impact(self, ahead: float, longest: float, pose: Pose) -> Choice:
        if not self._approaching and ahead > longest:
            return Choice(0.5 * ahead, Grip.SWING, self._side)
        self._approaching = True
        least = max(self._least, abs(pose.rate) / MOST_ACCELERATION)
        if ahead > least and not self._stands(ahead, pose):
            return Choice((1.0 - REMAINDER) * ahead, Grip.APPROACH, self._side)
        self._approaching = False
        self._strikes, self._strike_s = 1, least
        return Choice(least, Grip.STRIKE, self._side)

    def _stands(self, ahead: float, pose: Pose) -> bool:
        """Whether the free corner touches the base as it is: the way that is left no longer halves.

        A rounding of its height would otherwise be approached for ever.
        """
        touches = self._last.grip is Grip.APPROACH and self._gap(pose) < self._touching
        return touches and (1.0 - REMAINDER) * ahead >= self._last.dt_s

    def _through(self, pose: Pose) -> Choice:
        """Step on in the shortest steps until the impact is over."""
        self._strikes += 1
        settled = abs(pose.rate - self._last_rate) <= self._settled * abs(pose.rate)
        over = self._strikes > STRIKES and settled and self._gap(pose) < self._touching
        if not over and self._strikes <= MOST_STRIKES:
            return Choice(self._strike_s, Grip.STRIKE, self._side)
        self._strikes, self._bouncing = 0, True
        if self._swing_s(pose) < self._shortest:
            return self._settle()
        self._side = math.copysign(1.0, pose.rate)
        return Choice(self._times.even(FIRST_PART * self._longest(pose)), Grip.SWING, self._side)

    def _settle(self) -> Choice:
        """Leave the block to its contacts."""
        self._resting = True
        return self._at_rest()

    def _until_impact(self, pose: Pose) -> float:
        """Time [s] until the free corner meets the base, if the acceleration stays as it is."""
        bend = -self._fall
        if self._between:
            bend = (pose.rate - self._last_rate) / self._between * self._side
        rate = pose.rate * self._side + (1.0 - self._part) * bend * self._last.dt_s
        angle = self._gap(pose) / self._width
        inside = rate * rate - 2.0 * bend * angle
        if rate >= 0.0 or inside < 0.0:
            return math.inf
        return max(2.0 * angle / (math.sqrt(inside) - rate), 0.0)

    def _gap(self, pose: Pose) -> float:
        """Height [m] of the free corner above the base."""
        raised = 0.5 * self._side * self._width * math.sin(pose.theta)
        return pose.z - self._half_height * math.cos(pose.theta) + raised

    def _swing_s(self, pose: Pose) -> float:
        """Duration [s] of the swing from one impact to the next, were there no load."""
        # the higher corner's height tells a swing from a block that leans in a soft contact
        reach = 0.5 * self._width * abs(math.sin(pose.theta))
        raised = max(pose.z - self._half_height * math.cos(pose.theta) + reach, 0.0)
        launched = math.sqrt(pose.rate * pose.rate + 2.0 * self._fall * raised / self._width)
        return 2.0 * launched / self._fall

    def _longest(self, pose: Pose | None = None) -> float:
        """Longest step [s] that resolves the load, and the swing if it is one between impacts."""
        load = self._times.load
        longest = self._dt
        if load is not NEVER:
            resolving = (load.end - load.begin) * self._load_part
            longest = min(longest, max(resolving, LEAST_LOAD * self._dt))
        if pose is not None and self._bouncing:
            longest = min(longest, max(self._swing_s(pose), self._shortest) * self._swing_part)
        return longest
