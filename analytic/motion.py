"""Base motions: acceleration, velocity and displacement of the ground, starting from rest."""

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from analytic.checks import finite, positive
from analytic.kernels.law import FloatArray as FloatArray

SEGMENT_COLUMNS = ("start", "end", "amplitude", "omega", "phase", "offset", "slope")
"""Columns of `Motion.segments`: on [start, end] the ground acceleration is
amplitude sin(omega (t - start) + phase) + offset + slope (t - start). A row is a sine or a straight
line: uplifts are found for either, not for their sum."""


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
    """Ground acceleration a_p sin(omega t) during a number of half cycles.

    Parameters
    ----------
    amplitude : float
        a_p [m/s2]; a negative value is the mirror image.
    omega : float
        Circular frequency [rad/s].
    half_cycles : int
        1 for the half-sine pulse, 2 for the full-sine pulse.

    Raises
    ------
    ValueError
        If the amplitude is not finite, omega not positive and finite, or half_cycles not a
        positive integer.
    """

    amplitude: float
    omega: float
    half_cycles: int = 1

    def __post_init__(self) -> None:
        object.__setattr__(self, "amplitude", finite("amplitude", self.amplitude))
        object.__setattr__(self, "omega", positive("omega", self.omega))
        if self.half_cycles != int(positive("half_cycles", self.half_cycles)):
            raise ValueError(f"half_cycles is {self.half_cycles!r}; it must be a whole number")
        object.__setattr__(self, "half_cycles", int(self.half_cycles))

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
        return np.where(during, self.amplitude * np.sin(self.omega * t), 0.0)

    def velocity(self, t: ArrayLike) -> FloatArray:
        """Ground velocity [m/s] at the times `t` [s]; constant after the pulse."""
        phase = self.omega * np.clip(np.asarray(t, dtype=np.float64), 0.0, self.duration)
        # 1 - cos x = 2 sin(x/2)^2 keeps its digits at small x
        return 2.0 * self.amplitude / self.omega * np.sin(0.5 * phase) ** 2

    def displacement(self, t: ArrayLike) -> FloatArray:
        """Ground displacement [m] at the times `t` [s]; linear after the pulse."""
        t = np.asarray(t, dtype=np.float64)
        during = np.clip(t, 0.0, self.duration)
        phase = self.omega * during
        moved = self.amplitude / self.omega**2 * (phase - np.sin(phase))
        return moved + self.velocity(self.duration) * np.maximum(t - self.duration, 0.0)

    def segments(self) -> FloatArray:
        """One row of `SEGMENT_COLUMNS`."""
        return np.array([[0.0, self.duration, self.amplitude, self.omega, 0.0, 0.0, 0.0]])
