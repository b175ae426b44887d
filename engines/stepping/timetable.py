"""What is known of a run before it begins: when the base's motion changes, when it can lift."""

import math
from typing import NamedTuple

import numpy as np

from analytic.motion import FloatArray, Motion
from engines.scene import Scene

SAME_TIME = 1e-9
"""Times closer than this part of the ordinary step are the same."""

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


class Timetable:
    """The stops that a step must not pass, and the loads, as time goes by.

    Parameters
    ----------
    scene : Scene
        What is being simulated.
    dt_s : float
        Ordinary step [s].
    resolved_s : float, optional
        Times [s] closer than this are the same to the engine.
    """

    def __init__(self, scene: Scene, dt_s: float, resolved_s: float = 0.0) -> None:
        block, hints = scene.block, scene.hints
        self._same = max(SAME_TIME * dt_s, resolved_s)
        loads = loads_of(scene.motion, hints.onset * block.gravity * math.tan(block.alpha))
        if hints.swapped:
            loads = [load._replace(side=-load.side) for load in loads]
        ends = () if scene.duration is None else (scene.duration,)
        stops = {*scene.motion.breakpoints, *ends, *(t for load in loads for t in load[:2])}
        self._ends: tuple[float, ...] = (scene.motion.duration, *ends, math.inf)
        self._stops: list[float] = [*sorted(stop for stop in stops if stop > self._same), math.inf]
        self._loads = [*loads, NEVER]
        self._stop = self._load = 0
        self._now = 0.0

    def pass_to(self, time: float) -> None:
        """Move on to `time` [s]."""
        self._now = time
        while self._stops[self._stop] <= time + self._same:
            self._stop += 1
        while self._loads[self._load].end <= time + self._same:
            self._load += 1

    @property
    def left(self) -> float:
        """Time [s] left until the next stop."""
        return self._stops[self._stop] - self._now

    @property
    def calm(self) -> float:
        """Time [s] left until a block at rest may lift, or the motion or the observation ends."""
        return self._calm_end() - self._now

    def _calm_end(self) -> float:
        end = next(end for end in self._ends if end > self._now + self._same)
        return min(self.load.begin, end)

    @property
    def load(self) -> Load:
        """The present load or else the next."""
        return self._loads[self._load]

    @property
    def loaded(self) -> bool:
        """Whether the load is present."""
        return self.load.begin <= self._now + self._same

    @property
    def lifts_next(self) -> bool:
        """Whether what ends the calm is a load."""
        return self.load.begin == self._calm_end()

    def even(self, longest: float) -> float:
        """Longest step [s], up to `longest`, of which a whole number leads to the next stop."""
        return _even(self.left, longest)

    def even_in_calm(self, longest: float) -> float:
        """Longest step [s], up to `longest`, of which a whole number makes up the calm."""
        return _even(self.calm, longest)


def _even(left: float, longest: float) -> float:
    return longest if left == math.inf else left / math.ceil(left / longest * (1.0 - SAME_TIME))


def loads_of(motion: Motion, onset: float) -> list[Load]:
    """Return the times during which abs(u_g'') exceeds `onset` [m/s2]."""
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
