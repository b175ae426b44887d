"""The plane of an overturning map: frequency across, amplitude up, and the case at a point."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from analytic import RigidBlock, overturning_modes
from analytic.motion import FloatArray, SinePulse
from studies.cases.paper import PULSES

LEAST_ONSETS = 1.0
"""A map begins at g tan(alpha), below which the exact block stays at rest."""


def pulse_of(block: RigidBlock, pulse: str, onsets: float, omega_over_p: float) -> SinePulse:
    """Return a pulse whose amplitude is so many times g tan(alpha) of a block."""
    amplitude = onsets * math.tan(block.alpha) * block.gravity
    omega = omega_over_p * block.p
    return SinePulse(amplitude=amplitude, omega=omega, half_cycles=PULSES[pulse])


@dataclass(frozen=True, kw_only=True)
class Window:
    """A plane of pulses on blocks of one shape: omega/p, and amplitudes over g tan(alpha)."""

    pulse: str = "full-sine"
    aspect: float = 4.0
    low: float = 0.2
    high: float = 8.0
    onsets: float = 10.0
    columns: int = 1000
    rows: int = 1000

    def __post_init__(self) -> None:
        if not 0.1 <= self.aspect <= 100.0:
            raise ValueError(f"aspect is {self.aspect!r}; it must be from 0.1 to 100")

    @property
    def title(self) -> str:
        """What all points have in common."""
        return f"{self.pulse} pulse, H/B = {self.aspect:g}"

    @cached_property
    def block(self) -> RigidBlock:
        """The block."""
        return RigidBlock(width=0.5, height=0.5 * self.aspect)

    @property
    def cell(self) -> float:
        """Height of a cell."""
        return (self.onsets - LEAST_ONSETS) / self.rows

    def ratios(self, count: int) -> FloatArray:
        """Return omega/p in the middle of `count` columns."""
        return self.low + (np.arange(count) + 0.5) * (self.high - self.low) / count

    def amplitudes(self, count: int) -> FloatArray:
        """Return the amplitudes in the middle of `count` rows."""
        return LEAST_ONSETS + (np.arange(count) + 0.5) * (self.onsets - LEAST_ONSETS) / count

    def modes(self, model: str = "exact") -> NDArray[np.int32]:
        """Return how a model's block overturns in each cell, as in `Modes`; (columns, rows)."""
        alpha = math.atan(1.0 / self.aspect)
        ratios, amplitudes = self.ratios(self.columns), self.amplitudes(self.rows) * math.tan(alpha)
        pulse = PULSES[self.pulse]
        return overturning_modes(alpha, amplitudes, ratios[:, None], pulse, model).mode
