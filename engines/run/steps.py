"""Steps: when the base's motion changes or can lift a block, and what the base does in a step."""

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from analytic.motion import Motion
from engines.declaration import Stepping
from engines.run.ground import mean_velocity_over
from engines.scene import Scene
from engines.world import Choice, FloatArray, Moment, Resolution, Step

SAME_TIME = 1e-9
"""Times closer than this part of the ordinary step are the same."""

PULLS = np.array([1.0, -1.0])
"""Signs of the acceleration that lift a block, about its left corner and its right one."""

MIDDLE, END = Moment.MIDDLE.value, Moment.END.value

POLICIES = tuple(Stepping)
FIXED, LANDING, EVEN = map(POLICIES.index, (Stepping.FIXED, Stepping.LANDING, Stepping.OWN))


class Load(NamedTuple):
    """A time [s] during which the base can lift a block at rest, about its corner at -1 or 1."""

    begin: float
    end: float
    side: float


NEVER = Load(math.inf, math.inf, 0.0)


@dataclass(slots=True)
class Pace:
    """How a run steps, and where it is between the stops that no step may pass, and the loads."""

    policy: int  # which of `POLICIES` chooses
    dt: float  # ordinary step [s]
    part: float  # moment of a step's velocity, as its part
    gravity: float
    felt: bool  # a block on a base at rest carries the body force of the base's acceleration
    heaves: bool  # which is vertical, too
    same: float  # difference of two times that are the same [s]
    motion_end: float
    end: float  # of the observation at the least [s]
    time: float = 0.0  # end of the last step [s]; before 0 the base is at rest
    last_dt: float = 0.0
    velocity: float = 0.0  # of the base at the moment of the last velocity [m/s]
    rise: float = 0.0  # the same, upwards
    height: float = 0.0
    place: float = 0.0  # of the base at the step's end [m]
    stops: int = 0  # how many have passed, and how many loads
    loads: int = 0
    left: float = 0.0  # time until the next stop [s]
    time_to_uplift: float = 0.0  # until a block at rest may lift, or all ends [s]
    loaded: bool = False  # the first load that has not ended has begun
    lifts_next: bool = False  # that load is what ends the calm
    load_s: float = 0.0  # how long it lasts [s], inf if there is none
    load_side: float = 0.0


def begin_pace(
    scene: Scene, dt_s: float, stepping: Stepping, moment: Moment, resolution: Resolution
) -> Pace:
    """Return what the steps of a scene begin with, which land on impacts of what rocks alone."""
    lands = stepping is Stepping.LANDING and not scene.layout.rocking
    return Pace(
        policy=EVEN if lands else POLICIES.index(stepping),
        dt=dt_s,
        part=moment.value,
        gravity=scene.system.gravity,
        felt=scene.frame != "world",
        heaves=scene.heaves,
        same=max(SAME_TIME * dt_s, resolution.time_s),
        motion_end=scene.motion.duration,
        end=scene.watched,
        time=begin_of(scene, dt_s),
    )


def begin_of(scene: Scene, dt_s: float) -> float:
    """Return when [s] equal steps begin: so many before the motion as last for its rest."""
    return -math.ceil((scene.rest_s or 0.0) / dt_s * (1.0 - SAME_TIME)) * dt_s


def advance(pace: Pace, ground: Any, heaving: Any, choice: Choice) -> Step:
    """Return a chosen step over a ground (m + 1, 8), the base at its mean velocity, and move on.

    Heaving is the same of the motion upwards.
    """
    dt, phase, side = choice
    begin, end = pace.time, pace.time + dt
    end = 0.0 if abs(end) < 0.5 * dt else end  # the motion begins with a step, however many rest
    # from the moment of the last velocity to that of this one
    kick_s = pace.part * dt + (1.0 - pace.part) * pace.last_dt
    mean = mean_velocity_over(ground, begin, end)
    velocity, since, until = mean, begin, end
    if pace.part != MIDDLE:
        since, until = end, end if pace.part == END else end + dt
        velocity = mean_velocity_over(ground, since, until)
    base_kick, pace.velocity = velocity - pace.velocity, velocity
    lift = 0.0
    if pace.heaves:
        pace.height += dt * mean_velocity_over(heaving, begin, end)
        rise = mean_velocity_over(heaving, since, until)
        lift, pace.rise = rise - pace.rise if pace.felt else 0.0, rise
    pace.place += dt * mean
    pace.time, pace.last_dt = end, dt
    pull_x = -base_kick / dt if pace.felt else 0.0
    pull_z = -(pace.gravity * kick_s + lift) / dt
    purpose: Any = phase.value  # in compiled code a name has no number of its own
    now = dt, end, kick_s, pull_x, pull_z, base_kick, velocity, pace.place, purpose, side
    return Step(*now, pace.rise, pace.height)


def pass_to(pace: Pace, stops: FloatArray, loads: FloatArray) -> None:
    """See which stops and loads, (k,) and (l, 3) of `timetable`, lie ahead of the present time."""
    reached = pace.time + pace.same
    while stops[pace.stops] <= reached:
        pace.stops += 1
    while loads[pace.loads, 1] <= reached:
        pace.loads += 1
    begin, end, side = loads[pace.loads, 0], loads[pace.loads, 1], loads[pace.loads, 2]
    pace.load_s, pace.load_side = end - begin if end < math.inf else math.inf, side
    over = math.inf
    if pace.motion_end > reached:
        over = pace.motion_end
    elif pace.end > reached:
        over = pace.end
    pace.left = stops[pace.stops] - pace.time
    pace.time_to_uplift = min(begin, over) - pace.time
    pace.loaded = begin <= reached
    pace.lifts_next = begin == min(begin, over)


def even(left_s: float, longest: float) -> float:
    """Return the longest step [s] up to `longest` of which a whole number makes up a time [s]."""
    if left_s == math.inf:
        return longest
    parts = left_s / longest * (1.0 - SAME_TIME)
    return left_s / (math.ceil(parts) if parts < 2.0**53 else parts)


def timetable(scene: Scene, same: float) -> tuple[FloatArray, FloatArray]:
    """Return the stops [s], and the loads, in which abs(u_g'') exceeds g tan(alpha), a row each."""
    right, left = (scene.system.gravity * math.tan(alpha) for alpha in scene.alphas)
    # steps that land, which alone need them, take no vertical motion
    loads = [] if scene.heaves else loads_of(scene.motion, np.array([left, right]))
    stops = {*scene.motion.breakpoints, scene.watched, *(t for load in loads for t in load[:2])}
    later = [*sorted(stop for stop in stops if stop > same), math.inf]
    return np.array(later), np.array([*loads, NEVER])


def loads_of(motion: Motion, onsets: FloatArray) -> list[Load]:
    """Return the times during which each pull of u_g'' exceeds its onset [m/s2], in order."""
    grid = np.union1d([0.0, motion.duration, *_turns(motion)], motion.breakpoints)
    above = PULLS[:, None] * motion.acceleration(grid) > onsets[:, None]
    pulled, change = np.nonzero(above[:, 1:] != above[:, :-1])
    crossings = _crossings(motion, PULLS[pulled], onsets[pulled], grid[change], grid[change + 1])
    loads: list[Load] = []
    for number, pull in enumerate(PULLS.tolist()):
        corners = crossings[pulled == number].tolist()
        if above[number, 0]:
            corners.insert(0, 0.0)
        if above[number, -1]:
            corners.append(motion.duration)
        loads += [Load(*pair, -pull) for pair in zip(corners[::2], corners[1::2], strict=True)]
    return sorted(loads)


def _turns(motion: Motion) -> list[float]:
    """Return the times [s] of crests and zeros of a motion, monotonic between two of them."""
    times: list[float] = []
    for start, end, amplitude, omega, phase, _, _ in motion.segments().tolist():
        if amplitude != 0.0:
            first, last = (2.0 * (omega * t + phase) / math.pi for t in (0.0, end - start))
            quarters = np.arange(math.ceil(first), math.floor(last) + 1)
            times += (start + (0.5 * math.pi * quarters - phase) / omega).tolist()
    return times


def _crossings(
    motion: Motion, pull: FloatArray, onset: FloatArray, low: FloatArray, high: FloatArray
) -> FloatArray:
    """Return the times [s], each between two, at which pull u_g'' passes `onset`: to the digit."""
    above, case = pull * motion.acceleration(low) > onset, np.arange(len(low))
    parts = np.linspace(0.0, 1.0, max(256 // max(len(low), 1), 2) + 1)[1:-1]
    while (np.nextafter(low, high) < high).any():
        inside = low + parts[:, None] * (high - low)
        early = (pull * motion.acceleration(inside) > onset) == above
        edges, part = np.vstack((low, inside, high)), np.count_nonzero(early, axis=0)
        low, high = edges[part, case], edges[part + 1, case]
    return high
