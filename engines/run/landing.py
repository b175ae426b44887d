"""Steps that end on what happens: what a landing preset does to an engine, and why it may.

**The trouble.** An engine takes velocities and contact impulses once a step. A block that falls
onto its free corner does so somewhere within a step, and the engine sees it at the end: an error of
first order in the step, however good the contact is. Peaks before the first impact are a hundred
times better than those after it.

**The remedy.** Steps are chosen to end where something happens:

- *impacts*: from the last two states, the time until the free corner meets the base is a root of a
  parabola (`until_impact`). Each step then covers half of the way that is left (`APPROACH`), so
  that the pivot never falls out of reach of the next step, until the rest is a millionth of an
  ordinary step. A few steps that short go through the impact (`STRIKE`): gravity has no time to act
  in them, the contact alone does, until the rate has settled. The first step after is short;
- *uplifts*: a block at rest lifts where the base's acceleration exceeds g tan(alpha). A step ends
  on each of those times (`steps.timetable`), and those before it come slowly;
- *corners of the motion*: a step ends where the base's acceleration has a corner or a jump.

Between them steps are ordinary: even parts of what is left, fine enough for a swing and for a load.
The velocity of a leapfrog engine belongs to the middle of a step, so that a step after one of
another length needs the kick of both halves: gravity is scaled by kick_s/dt_s (`steps.advance`).

**Why it is legitimate.** A step says how long it is, what it is for, and which corner is expected
to hold; never what the state becomes. Positions and velocities are set once, before the first
step. The block lifts, strikes its base and comes to rest by the engine's own contact: no angle is
projected, no velocity overwritten, no restitution given. Where an expectation is wrong the steps
are merely chosen badly, and the error is that of equal steps.

**When it is not.** Where other bodies of the same world need steps of their own, or steps follow a
clock, nobody may choose them so: then `tuned` says what to expect. The pivot has to hold: where it
slides by more than a hundredth of the width, with a friction that a scene asks for, a run fails by
name (`watch.HOLD_WIDTHS`). And where a block bounces through swings of a few steps, or lies in a
soft contact, no impact can be foreseen.

What else a preset does is said beside its figures (`Preset.helped_by`).
"""

import math
from dataclasses import dataclass

from engines.run.steps import SAME_TIME, Pace, even
from engines.scene import Scene
from engines.world import Choice, ContactPhase, Moment, Pose, Resolution

SWING_PART, LOAD_PART = 8.0, 4.0
"""A swing, and a load that can lift a block at rest, are resolved as finely as 1/p over these."""

COARSEST, LEAST_LOAD = 1.0 / 6.0, 0.02
"""Neither is taken in longer steps than this part of it, nor a load in shorter than this of dt."""

SHORTEST_SWING = 1e-4
"""A swing that would last no longer than this, in units of 1/p, is left to come to rest."""

REMAINDER = 0.5
"""Part of the way to an event that each step of an approach leaves for the next."""

NEAR, MOST_ACCELERATION = 1e-6, 3e9
"""An impact is near when the time left is less than this part of the ordinary step, than the
shortest time that the engine resolves, or than that in which this angular acceleration [rad/s2]
would stop the block in a step; engines take what is much larger for a failure."""

UPLIFT_PART, UPLIFT_NEAR = 1.0 / 32.0, 2e-3
"""A block at rest takes steps of this part of the time until the base can lift it, each longer than
the one before by this part at most: a sudden change would let go of a corner."""

STRIKES, MOST_STRIKES, SETTLED = 4, 12, 1e-6
"""Steps through an impact, at least and at most; over once one changes the rate by less."""

FIRST_PART = 0.02
"""The first step aloft is this part of the next ones: a contact that has just taken all velocity
out of its point lets that rise by the square of the step."""

TOUCHING = 1e-9
"""A corner lower above the base than this part of the width touches it."""


@dataclass(slots=True)
class Landing:
    """What is known of the block, and of what went before."""

    dt: float  # the ordinary step [s]
    least: float  # the shortest one [s]
    longest_rest: float  # the longest one of a block at rest [s]
    shortest: float  # the shortest swing that is followed [s]
    width: float
    half_height: float
    touching: float  # height below which a corner touches the base [m]
    # p^2 sin(alpha) [rad/s2], by which an upright block on one corner falls to the other
    fall: float
    swing_part: float  # of a swing, that a step may cover
    load_part: float  # of a load
    settled: float  # change of the rate, by its part, with which an impact is over
    part: float  # moment of a step's velocity
    side: float  # corner that the block turns about
    resting: bool
    bouncing: bool = False  # an impact began its swing
    approaching: bool = False  # the next impact is approached
    strikes: int = 0  # steps through the present impact
    strike_s: float = 0.0  # their length [s]
    last_dt: float = 0.0  # length of the last step [s]
    last_approach: bool = False  # whether it was of an approach
    last_rate: float = 0.0  # rate before it [rad/s]
    between: float = 0.0  # time between the moments of the last two velocities [s]


def begin_landing(scene: Scene, dt_s: float, moment: Moment, resolution: Resolution) -> Landing:
    """Return what landing steps begin with; nothing is asked of an engine beyond its resolution."""
    block = scene.system
    fall = block.p**2 * math.sin(block.alpha)
    # a swing that rises by no more than the engine's numbers tell apart
    unseen = 2.0 * math.sqrt(2.0 * resolution.length_m / (block.width * fall))
    return Landing(
        dt=dt_s,
        least=max(NEAR * dt_s, resolution.time_s),
        longest_rest=resolution.rest_factor * dt_s,
        shortest=max(SHORTEST_SWING / block.p, resolution.time_s / COARSEST, unseen),
        width=block.width,
        half_height=0.5 * block.height,
        touching=max(TOUCHING * block.width, resolution.length_m),
        fall=fall,
        swing_part=min(SWING_PART * block.p * dt_s, COARSEST),
        load_part=min(LOAD_PART * block.p * dt_s, COARSEST),
        settled=max(SETTLED, resolution.part),
        part=moment.value,
        side=scene.side,
        resting=not scene.side,
    )


def choose(to: Landing, pace: Pace, pose: Pose, lifted: bool) -> Choice:
    """Choose the next step from the block's pose after the last one, and whether it is aloft."""
    if to.strikes:
        choice = through(to, pace, pose)
    elif to.resting and not lifted:
        choice = at_rest(to, pace)
    else:
        choice = aloft(to, pace, pose, lifted)
    to.between = to.part * choice.dt_s + (1.0 - to.part) * to.last_dt
    to.last_dt, to.last_approach = choice.dt_s, choice.phase == ContactPhase.APPROACH
    to.last_rate = pose.rate
    return choice


def at_rest(to: Landing, pace: Pace) -> Choice:
    """Step through the calm, the longer the more is left, and slowly where the block may lift."""
    if pace.loaded:
        to.side = pace.load_side
        return Choice(even(pace.left, resolving(to, pace)), ContactPhase.REST, to.side)
    to.side = 0.0
    if UPLIFT_PART * pace.time_to_uplift > to.dt:
        longest = max(min((1.0 + UPLIFT_PART) * to.last_dt, to.longest_rest), to.dt)
        return Choice(min(UPLIFT_PART * pace.time_to_uplift, longest), ContactPhase.REST, 0.0)
    if not pace.lifts_next or pace.time_to_uplift * (1.0 - SAME_TIME) > to.dt:
        return Choice(even(pace.time_to_uplift, to.dt), ContactPhase.REST, 0.0)
    # a short last step, or the first one aloft would feel forces of the time before
    part = 1.0 if pace.time_to_uplift <= UPLIFT_NEAR * to.dt else 1.0 - REMAINDER
    return Choice(part * pace.time_to_uplift, ContactPhase.REST, pace.load_side)


def aloft(to: Landing, pace: Pace, pose: Pose, lifted: bool) -> Choice:
    """Step on until an impact is near."""
    if to.resting:
        to.resting = to.bouncing = False
    if lifted and not to.approaching:
        to.side = math.copysign(1.0, pose.theta)
    if to.bouncing and not lifted and swing_s(to, pose) < to.shortest:
        return settle(to, pace)
    longest = resolving(to, pace)
    if to.bouncing:
        longest = resolving_swing(to, pose, longest)
    if to.between == 0.0:
        longest = FIRST_PART * longest
    ahead = until_impact(to, pose)
    to.approaching = to.approaching and ahead < math.inf
    if to.approaching or ahead < min(2.0 * longest, pace.left):
        return towards_impact(to, ahead, longest, pose)
    return Choice(even(pace.left, longest), ContactPhase.SWING, to.side)


def towards_impact(to: Landing, ahead: float, longest: float, pose: Pose) -> Choice:
    """Leave a part of the way, `ahead` [s], for the next step, or all to the shortest steps."""
    if not to.approaching and ahead > longest:
        return Choice(0.5 * ahead, ContactPhase.SWING, to.side)
    to.approaching = True
    least = max(to.least, abs(pose.rate) / MOST_ACCELERATION)
    if ahead > least and not stands(to, ahead, pose):
        return Choice((1.0 - REMAINDER) * ahead, ContactPhase.APPROACH, to.side)
    to.approaching = False
    to.strikes, to.strike_s = 1, least
    return Choice(least, ContactPhase.STRIKE, to.side)


def stands(to: Landing, ahead: float, pose: Pose) -> bool:
    """Return whether the free corner touches: its rounding would be approached for ever."""
    touches = to.last_approach and gap(to, pose) < to.touching
    return touches and (1.0 - REMAINDER) * ahead >= to.last_dt


def through(to: Landing, pace: Pace, pose: Pose) -> Choice:
    """Step on in the shortest steps until the impact is over."""
    to.strikes += 1
    settled = abs(pose.rate - to.last_rate) <= to.settled * abs(pose.rate)
    over = to.strikes > STRIKES and settled and gap(to, pose) < to.touching
    if not over and to.strikes <= MOST_STRIKES:
        return Choice(to.strike_s, ContactPhase.STRIKE, to.side)
    to.strikes, to.bouncing = 0, True
    if swing_s(to, pose) < to.shortest:
        return settle(to, pace)
    to.side = math.copysign(1.0, pose.rate)
    longest = resolving_swing(to, pose, resolving(to, pace))
    return Choice(even(pace.left, FIRST_PART * longest), ContactPhase.SWING, to.side)


def settle(to: Landing, pace: Pace) -> Choice:
    """Leave the block to its contacts."""
    to.resting = True
    return at_rest(to, pace)


def until_impact(to: Landing, pose: Pose) -> float:
    """Return the time [s] until the free corner meets the base, if the acceleration stays."""
    bend = -to.fall
    if to.between != 0.0:
        bend = (pose.rate - to.last_rate) / to.between * to.side
    rate = pose.rate * to.side + (1.0 - to.part) * bend * to.last_dt
    angle = gap(to, pose) / to.width
    inside = rate * rate - 2.0 * bend * angle
    if rate >= 0.0 or inside < 0.0:
        return math.inf
    return max(2.0 * angle / (math.sqrt(inside) - rate), 0.0)


def gap(to: Landing, pose: Pose) -> float:
    """Return the height [m] of the free corner above the base."""
    raised = 0.5 * to.side * to.width * math.sin(pose.theta)
    return pose.z - to.half_height * math.cos(pose.theta) + raised


def swing_s(to: Landing, pose: Pose) -> float:
    """Return the duration [s] of the swing from one impact to the next, were there no load."""
    # the higher corner's height tells a swing from a block that leans in a soft contact
    reach = 0.5 * to.width * abs(math.sin(pose.theta))
    raised = max(pose.z - to.half_height * math.cos(pose.theta) + reach, 0.0)
    launched = math.sqrt(pose.rate * pose.rate + 2.0 * to.fall * raised / to.width)
    return 2.0 * launched / to.fall


def resolving(to: Landing, pace: Pace) -> float:
    """Return the longest step [s] that resolves the load."""
    if pace.load_s == math.inf:
        return to.dt
    return min(to.dt, max(pace.load_s * to.load_part, LEAST_LOAD * to.dt))


def resolving_swing(to: Landing, pose: Pose, longest: float) -> float:
    """Return the longest step [s], up to `longest`, that resolves a swing between impacts."""
    return min(longest, max(swing_s(to, pose), to.shortest) * to.swing_part)
