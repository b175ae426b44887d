"""Base motions: acceleration, velocity and displacement of the ground, starting from rest."""

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

import numpy as np
from numpy.typing import ArrayLike

from analytic import checks
from analytic.block import GRAVITY
from analytic.kernels.law import FloatArray as FloatArray

SEGMENT_COLUMNS = ("start", "end", "amplitude", "omega", "phase", "offset", "slope")
"""Columns of `Motion.segments`: on [start, end] the ground acceleration is
amplitude sin(omega (t - start) + phase) + offset + slope (t - start). A row is a sine or a straight
line: uplifts are found for either, not for their sum."""

MOST_TURNS = 1e6
"""Half cycles of each motion of a base that moves both ways: uplifts are sought step by step."""
SAME_KNOT = 1e-12
"""Part of the duration within which ends of segments of both motions are one."""
MOST_PHASE = 1e6
"""Phase of a pulse [rad] up to which floating point holds ten digits of its angle."""


class Motion(Protocol):
    """What the reference and the engines need to know about a base motion."""

    @property
    def duration(self) -> float:
        """Time [s] at which the acceleration ends; the base then keeps its velocity."""

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """Times [s] at which the acceleration is not smooth, the first and the last included."""

    def acceleration(self, t: ArrayLike) -> FloatArray:
        """Ground acceleration [m/s2] at the times `t` [s]."""

    def velocity(self, t: ArrayLike) -> FloatArray:
        """Ground velocity [m/s] at the times `t` [s]."""

    def displacement(self, t: ArrayLike) -> FloatArray:
        """Ground displacement [m] at the times `t` [s]."""

    def segments(self) -> FloatArray:
        """Rows of `SEGMENT_COLUMNS`, consecutive, on each of which the acceleration is analytic."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SinePulse:
    """Ground acceleration a_p sin(omega t + phase) during a number of half cycles.

    The ground is at rest before. Where the phase is not 0 the acceleration jumps at the begin and
    the end; pi/2 makes a cosine.

    Parameters
    ----------
    amplitude : float
        a_p [m/s2]; a negative value is the mirror image.
    omega : float
        Circular frequency [rad/s].
    half_cycles : int
        1 for the half-sine pulse, 2 for the full-sine pulse.
    phase : float, optional
        Phase at time zero [rad], at most 1e6 of either sign: of more, digits are lost.

    Raises
    ------
    ValueError
        If one is out of range, floating point does not hold the square of omega, or the
        displacement of the ground overflows.

    Examples
    --------
    >>> pulse = SinePulse(amplitude=3.924, omega=6.2832, half_cycles=2)
    >>> round(pulse.duration, 5), round(float(pulse.acceleration(0.25)), 3)
    (1.0, 3.924)
    """

    amplitude: float
    omega: float
    half_cycles: int = 1
    phase: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "amplitude", checks.finite("amplitude", self.amplitude))
        object.__setattr__(self, "omega", checks.measurable("omega", self.omega))
        phase = checks.within("phase", self.phase, -MOST_PHASE, MOST_PHASE)
        object.__setattr__(self, "phase", phase)
        cycles = checks.whole("half_cycles", self.half_cycles, checks.MOST_HALF_CYCLES)
        object.__setattr__(self, "half_cycles", cycles)
        checks.finite_result(
            "the displacement of the ground",
            self.amplitude / self.omega**2 * (self.half_cycles * math.pi),
            f"amplitude is {self.amplitude!r} and omega {self.omega!r}",
        )

    @classmethod
    def in_g(cls, amplitude: float, *, omega: float, **rest: Any) -> "SinePulse":
        """Return the pulse whose amplitude is given in units of g."""
        return cls(amplitude=GRAVITY * checks.finite("amplitude", amplitude), omega=omega, **rest)

    @property
    def duration(self) -> float:
        """Length of the pulse [s]."""
        return self.half_cycles * math.pi / self.omega

    @property
    def breakpoints(self) -> tuple[float, float]:
        """Start and end of the pulse [s]."""
        return (0.0, self.duration)

    def acceleration(self, t: ArrayLike) -> FloatArray:
        """Ground acceleration [m/s2] at the times `t` [s]."""
        t = np.asarray(t, dtype=np.float64)
        during = (t >= 0.0) & (t <= self.duration)
        return np.where(during, self.amplitude * np.sin(self.omega * t + self.phase), 0.0)

    def velocity(self, t: ArrayLike) -> FloatArray:
        """Ground velocity [m/s] at the times `t` [s]; constant after the pulse."""
        half = 0.5 * self.omega * np.clip(np.asarray(t, dtype=np.float64), 0.0, self.duration)
        # cos f - cos(f + x) = 2 sin(f + x/2) sin(x/2) keeps its digits at small x
        grown = np.sin(self.phase + half) * np.sin(half)
        return np.asarray(2.0 * self.amplitude / self.omega * grown)

    def displacement(self, t: ArrayLike) -> FloatArray:
        """Ground displacement [m] at the times `t` [s]; linear after the pulse."""
        t = np.asarray(t, dtype=np.float64)
        during = np.clip(t, 0.0, self.duration)
        x = self.omega * during
        ahead = math.cos(self.phase) * (x - np.sin(x))
        across = 2.0 * math.sin(self.phase) * np.sin(0.5 * x) ** 2
        moved = self.amplitude / self.omega**2 * (ahead + across)
        return moved + self.velocity(self.duration) * np.maximum(t - self.duration, 0.0)

    def segments(self) -> FloatArray:
        """One row of `SEGMENT_COLUMNS`."""
        return np.array([[0.0, self.duration, self.amplitude, self.omega, self.phase, 0.0, 0.0]])


@dataclass(frozen=True, slots=True)
class Still:
    """Ground that does not move: for a block that is released from a tilt, or set turning.

    Examples
    --------
    >>> block = RigidBlock(width=0.5, height=1.5)
    >>> simulate(block, Still(), start=(0.5 * block.alpha, 0.0)).peak_ratio
    0.5000000000000001
    """

    duration: ClassVar[float] = 0.0
    breakpoints: ClassVar[tuple[float, float]] = (0.0, 0.0)

    def acceleration(self, t: ArrayLike) -> FloatArray:
        """Zero, at the times `t` [s]."""
        return np.zeros_like(np.asarray(t, dtype=np.float64))

    velocity = displacement = acceleration

    def segments(self) -> FloatArray:
        """One row of `SEGMENT_COLUMNS`, of no length."""
        return np.zeros((1, len(SEGMENT_COLUMNS)))


@dataclass(frozen=True, slots=True)
class Delayed:
    """A motion before which the ground is at rest for `rest_s` seconds, more than 0.

    Examples
    --------
    >>> round(Delayed(SinePulse.in_g(0.4, omega=6.0), rest_s=1.0).duration, 3)
    1.524
    """

    motion: Motion
    rest_s: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "rest_s", checks.positive("rest_s", self.rest_s))

    @property
    def duration(self) -> float:
        """Time [s] at which the acceleration ends."""
        return self.rest_s + self.motion.duration

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """Those of the motion, later, and the start [s]."""
        return (0.0, *(self.rest_s + t for t in self.motion.breakpoints))

    def acceleration(self, t: ArrayLike) -> FloatArray:
        """Ground acceleration [m/s2] at the times `t` [s]."""
        return self.motion.acceleration(np.asarray(t, dtype=np.float64) - self.rest_s)

    def velocity(self, t: ArrayLike) -> FloatArray:
        """Ground velocity [m/s] at the times `t` [s]."""
        return self.motion.velocity(np.asarray(t, dtype=np.float64) - self.rest_s)

    def displacement(self, t: ArrayLike) -> FloatArray:
        """Ground displacement [m] at the times `t` [s]."""
        return self.motion.displacement(np.asarray(t, dtype=np.float64) - self.rest_s)

    def segments(self) -> FloatArray:
        """Rows of `SEGMENT_COLUMNS`: the rest, and those of the motion, later."""
        rows = self.motion.segments().copy()
        rows[:, :2] += self.rest_s
        rest = np.zeros((1, len(SEGMENT_COLUMNS)))
        rest[0, 1] = self.rest_s
        return np.concatenate([rest, rows])


@dataclass(frozen=True, slots=True)
class BothWays:
    """A motion of the base with another one upwards; all but `segments` is of the horizontal one.

    Each has its own end; the duration is the longer one.
    """

    level: Motion
    upward: Motion

    def __post_init__(self) -> None:
        for name, motion in (("half_cycles", self.level), ("vertical_half_cycles", self.upward)):
            rows = motion.segments()
            turns = float(np.sum(rows[:, 3] * (rows[:, 1] - rows[:, 0]))) / math.pi
            if turns > MOST_TURNS:
                words = f"it must be at most {MOST_TURNS:g} where the base moves both ways"
                raise ValueError(f"{name} is {turns:g}; {words}")

    @property
    def duration(self) -> float:
        """Time [s] at which both accelerations have ended."""
        return max(self.level.duration, self.upward.duration)

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """Those of both [s]."""
        return tuple(sorted({*self.level.breakpoints, *self.upward.breakpoints}))

    @property
    def lowest(self) -> float:
        """Smallest acceleration upwards [m/s2]."""
        times = [np.array([*self.upward.breakpoints])]
        for start, end, amplitude, omega, phase, *_ in self.upward.segments().tolist():
            if amplitude != 0.0:
                trough = -math.copysign(0.5 * math.pi, amplitude) - phase
                first = trough + 2.0 * math.pi * math.ceil(-trough / (2.0 * math.pi))
                times.append(np.array([min(start + first / omega, end)]))
        return float(np.min(self.upward.acceleration(np.concatenate(times))))

    def acceleration(self, t: ArrayLike) -> FloatArray:
        """Ground acceleration [m/s2] at the times `t` [s]."""
        return self.level.acceleration(t)

    def velocity(self, t: ArrayLike) -> FloatArray:
        """Ground velocity [m/s] at the times `t` [s]."""
        return self.level.velocity(t)

    def displacement(self, t: ArrayLike) -> FloatArray:
        """Ground displacement [m] at the times `t` [s]."""
        return self.level.displacement(t)

    def scaled(self, factor: float) -> "BothWays":
        """Return both, of records, with their accelerations multiplied."""
        return BothWays(*(it.scaled(factor) for it in (self.level, self.upward)))  # type: ignore[attr-defined]

    def segments(self) -> FloatArray:
        """Rows of `SEGMENT_COLUMNS` twice, the second ones upwards, between the knots of both."""
        both = [motion.segments() for motion in (self.level, self.upward)]
        knots = np.unique(np.concatenate([rows[:, :2].ravel() for rows in both]))
        begins = knots[:-1][np.diff(knots) > SAME_KNOT * knots[-1]]
        ends = np.append(begins[1:], knots[-1])
        parts = []
        for rows in both:
            middle = 0.5 * (begins + ends)
            at = np.maximum(np.searchsorted(rows[:, 0], middle, side="right") - 1, 0)
            part = np.where((middle < rows[at, 1])[:, None], rows[at], 0.0)
            gone = begins - part[:, 0]
            part[:, 4] += part[:, 3] * gone
            part[:, 5] += part[:, 6] * gone
            part[:, 0], part[:, 1] = begins, ends
            parts.append(part)
        return np.hstack(parts)


def both_ways(level: Motion, upward: Motion) -> Motion:
    """Return two motions as one; the horizontal one alone where the other does not move."""
    return BothWays(level, upward) if np.any(upward.segments()[:, [2, 5, 6]]) else level
