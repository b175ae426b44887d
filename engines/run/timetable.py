"""What is known of a run before it begins: when the base's motion changes, when it can lift."""

import math
from typing import NamedTuple

import numpy as np

from analytic.motion import Motion
from engines.parts.compiled import State, fill, shared
from engines.scene import Scene
from engines.world import FloatArray

SAME_TIME = 1e-9
"""Times closer than this part of the ordinary step are the same."""

WHOLE = 2.0**53
"""All numbers from here on are whole."""

PULLS = np.array([1.0, -1.0])
"""Signs of the acceleration that lift a block, about its left corner and its right one."""

MOST_AT_ONCE = 256
"""Accelerations that cost not much more together than one does."""


class Load(NamedTuple):
    """A time [s] during which the base accelerates enough to lift a block at rest.

    side is the corner that the block would turn about, -1 or 1.
    """

    begin: float
    end: float
    side: float


NEVER = Load(math.inf, math.inf, 0.0)


class Times(State):
    """Where a run stands between the stops that a step must not pass, and the loads.

    Attributes
    ----------
    same : float
        Difference [s] of two times that are the same.
    motion_end, end : float
        Of the motion and of the observation [s].
    stops, loads : int
        Stops and loads that have passed.
    left : float
        Time [s] left until the next stop.
    time_to_uplift : float
        Time [s] left until a block at rest may lift, or the motion or the observation ends.
    loaded : bool
        Whether the first load that has not ended has begun.
    lifts_next : bool
        Whether what ends the calm is a load.
    load_s, load_side : float
        How long that load lasts [s], inf if there is none, and its side.
    """

    same: float
    motion_end: float
    end: float
    stops: int
    loads: int
    left: float
    time_to_uplift: float
    loaded: bool
    lifts_next: bool
    load_s: float
    load_side: float


def timetable(scene: Scene, dt_s: float, resolved_s: float = 0.0) -> tuple[FloatArray, FloatArray]:
    """Return the stops [s] that a step must not pass, and the loads, a row each.

    A load begins where abs(u_g'') exceeds g tan(alpha) (EQUATIONS.md, "From (1) and (2)").

    Parameters
    ----------
    scene : Scene
        What is being simulated.
    dt_s : float
        Ordinary step [s].
    resolved_s : float, optional
        Times [s] closer than this are the same to the engine.
    """
    block = scene.system
    loads = loads_of(scene.motion, block.gravity * math.tan(block.alpha))
    ends = () if scene.duration is None else (scene.duration,)
    stops = {*scene.motion.breakpoints, *ends, *(t for load in loads for t in load[:2])}
    same = same_time(dt_s, resolved_s)
    later = [*sorted(stop for stop in stops if stop > same), math.inf]
    return np.array(later), np.array([*loads, NEVER])


def same_time(dt_s: float, resolved_s: float = 0.0) -> float:
    """Return the difference [s] of two times that are the same."""
    return max(SAME_TIME * dt_s, resolved_s)


def begin_times(times: Times, scene: Scene, dt_s: float, resolved_s: float = 0.0) -> None:
    """Stand before the first stop and the first load.

    Parameters
    ----------
    times : Times, to be filled
    scene, dt_s, resolved_s
        As for `timetable`.
    """
    end = math.inf if scene.duration is None else scene.duration
    fill(times, same=same_time(dt_s, resolved_s), motion_end=scene.motion.duration, end=end)


@shared
def pass_to(times: Times, stops: FloatArray, loads: FloatArray, time: float) -> None:
    """Move on to a time.

    Parameters
    ----------
    times : Times, moved on
    stops, loads : ndarray (k,), (l, 3), of `timetable`
    time : float, [s]
    """
    reached = time + times.same
    while stops[times.stops] <= reached:
        times.stops += 1
    while loads[times.loads, 1] <= reached:
        times.loads += 1
    begin, end, side = loads[times.loads, 0], loads[times.loads, 1], loads[times.loads, 2]
    times.load_s, times.load_side = end - begin if end < math.inf else math.inf, side
    over = math.inf
    if times.motion_end > reached:
        over = times.motion_end
    elif times.end > reached:
        over = times.end
    times.left = stops[times.stops] - time
    times.time_to_uplift = min(begin, over) - time
    times.loaded = begin <= reached
    times.lifts_next = begin == min(begin, over)


@shared
def even(left_s: float, longest: float) -> float:
    """Return the longest step [s] of which a whole number makes up a time.

    Parameters
    ----------
    left_s : float, the time [s]; inf where there is none to be made up
    longest : float, no longer than this [s]
    """
    if left_s == math.inf:
        return longest
    parts = left_s / longest * (1.0 - SAME_TIME)
    return left_s / (math.ceil(parts) if parts < WHOLE else parts)


def loads_of(motion: Motion, onset: float) -> list[Load]:
    """Return the times during which abs(u_g'') exceeds `onset` [m/s2], in order."""
    grid = np.union1d([0.0, motion.duration, *_turns(motion)], motion.breakpoints)
    above = PULLS[:, None] * motion.acceleration(grid) > onset
    pulled, change = np.nonzero(above[:, 1:] != above[:, :-1])
    crossings = _crossings(motion, PULLS[pulled], onset, grid[change], grid[change + 1])
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
    """Return the times [s] of the crests and zeros of the sines that make up a motion.

    Between two of them, and on a straight segment, the acceleration is monotonic.
    """
    times: list[float] = []
    for start, end, amplitude, omega, phase, _, _ in motion.segments().tolist():
        if amplitude != 0.0:
            first, last = (2.0 * (omega * t + phase) / math.pi for t in (0.0, end - start))
            quarters = np.arange(math.ceil(first), math.floor(last) + 1)
            times += (start + (0.5 * math.pi * quarters - phase) / omega).tolist()
    return times


def _crossings(
    motion: Motion, pull: FloatArray, onset: float, low: FloatArray, high: FloatArray
) -> FloatArray:
    """Return the times [s] at which pull u_g'' passes `onset`, each between two times.

    They are bracketed to the last digit, all at once and in as many parts as cost little more
    than two do.
    """
    above = pull * motion.acceleration(low) > onset
    parts = np.linspace(0.0, 1.0, max(MOST_AT_ONCE // max(len(low), 1), 2) + 1)[1:-1]
    while (np.nextafter(low, high) < high).any():
        inside = low + parts[:, None] * (high - low)
        early = (pull * motion.acceleration(inside) > onset) == above
        edges = np.vstack((low, inside, high))
        part, case = np.count_nonzero(early, axis=0), np.arange(len(low))
        low, high = edges[part, case], edges[part + 1, case]
    return high
