"""One response as the kernels take it: its start, checked, and its motion in units of 1/p and g."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from analytic.block import RigidBlock
from analytic.checks import check_tilt, finite, start_of
from analytic.frame import Rocker
from analytic.kernels.law import FloatArray, Laws, Start, law_of
from analytic.kernels.rest import strongest_between
from analytic.models import Model, find_model
from analytic.motion import BothWays, Motion

LEAST_TILT = 1e-30
"""Tilt over alpha, below which the time to the first impact is lost in a step of the solution."""
REST = (0.0, 0.0)
"""Rotation [rad] and angular velocity [rad/s] of a block at rest on its base."""
LEAST_LOSS = 0.02
"""Loss of velocity at an impact below which no more steps are expected."""


class Posed(NamedTuple):
    """A response to be solved: laws and start as the kernels take them, segments (m, 7) or (m, 14).

    They are in 1/p and g, not finite where they overflow; what is followed ends with until [1/p];
    times [s] are those of the history.
    """

    laws: Laws
    start: Start
    segments: FloatArray
    until: float
    times: FloatArray

    @property
    def steps(self) -> float:
        """Some number of steps that the exact solution may take."""
        _, end, _, omega, *_ = self.segments.T
        turns = float(np.sum(omega * np.diff(end, prepend=0.0))) / math.pi
        lost = 1.0 - max(law.eta for law in self.laws)
        bounces = (turns + self.until) / max(lost, LEAST_LOSS)
        return len(self.segments) + bounces

    def then_still(self, end: float) -> FloatArray:
        """Return the motion with one segment more, on which nothing moves until a time [1/p]."""
        still = np.zeros(self.segments.shape[1])
        still[:2] = self.segments[-1, 1], end
        return np.vstack([self.segments, still])


def pose(
    block: Rocker,
    motion: Motion,
    model: str | Model,
    start: tuple[float, float],
    duration: float | None = None,
    times: ArrayLike | None = None,
) -> Posed:
    """Return a response to be solved; the arguments, and their errors, are those of `simulate`."""
    laws = find_model(model).laws(block)
    check_vertical(block, motion, laws[0].linear)
    until, sampled = check_window(motion, duration, times)
    begin = folded(block, laws, motion, start, sampled)
    p, g = np.float64(block.p), np.float64(block.gravity)
    with np.errstate(all="ignore"):
        units = np.array([p, p, 1.0 / g, 1.0 / p, 1.0, 1.0 / g, 1.0 / (g * p)])
        segments = motion.segments()
        scaled = segments * np.resize(units, segments.shape[1])
        return Posed(laws, begin, scaled, until * block.p, sampled)


def check_vertical(block: object, motion: Motion, linear: bool = True) -> None:
    """Refuse a vertical motion, but of an exact block that it presses on its base all the time."""
    if not isinstance(motion, BothWays):
        return
    if linear or not isinstance(block, RigidBlock):
        raise ValueError("vertical is given; only the exact model of a RigidBlock takes it")
    if not motion.lowest > -block.gravity:
        allowed = f"above -{block.gravity:g}, the block's gravity, or it lifts off its base"
        raise ValueError(f"vertical falls to {motion.lowest:g} m/s2; it must stay {allowed}")


def strongest(motion: Motion) -> float:
    """Return the largest abs(acceleration) [m/s2] of a ground motion."""
    return float(strongest_between(motion.segments().tolist(), 0, 0.0, motion.duration))


def folded(
    block: Rocker, laws: Laws, motion: Motion, start: tuple[float, float], times: FloatArray
) -> Start:
    """Return a start folded to one side; ValueError if it is none, or a time is before it."""
    theta, rate = start_of(start, least=LEAST_TILT * block.alpha)
    check_tilt(theta, rate, law_of(laws, theta).saddle, lambda: strongest(motion) == 0.0)
    leaning = theta if theta != 0.0 else rate
    side = math.copysign(1.0, leaning) if leaning != 0.0 else 0.0
    if side != 0.0 and len(times) and times[0] < 0.0:
        raise ValueError(f"times begin at {times[0]}; they must not be before the start, at 0")
    return Start(side, abs(theta), side * rate / block.p)


def check_window(
    motion: Motion, duration: float | None, times: ArrayLike | None
) -> tuple[float, FloatArray]:
    """Return the time to follow a response to [s] and its sample times [s], as for `simulate`."""
    sampled = np.empty(0) if times is None else np.array(times, dtype=np.float64)
    if sampled.ndim != 1 or np.any(np.diff(sampled) < 0.0) or not np.all(np.isfinite(sampled)):
        raise ValueError("times must be a list of finite, increasing numbers")
    if duration is None:
        return max([motion.duration, *sampled[-1:].tolist()]), sampled
    until = finite("duration", duration)
    if until < motion.duration:
        raise ValueError(
            f"duration is {duration!r}; it must be at least that of the motion, {motion.duration}"
        )
    return until, sampled
