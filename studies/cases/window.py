"""The plane of an overturning map: what its columns mean, and the case at each of its points."""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from analytic.block import GRAVITY, RigidBlock
from analytic.conditioning import Conditioning, condition_numbers
from analytic.maps import Modes, overturning_modes
from analytic.motion import FloatArray, SinePulse
from studies.cases.paper import PULSES

Axis = Literal["frequency", "slenderness", "size"]
AXES = {
    "frequency": (0.2, 8.0, "frequency of the pulse  ω/p  [–]"),
    "slenderness": (0.05, 0.6, "slenderness  α  [rad]"),
    "size": (0.1, 0.8, "size of the block, as its frequency parameter  p/2π  [Hz]"),
}
"""What a map's columns may be, their range and label."""
LEAST_ONSETS = 1.0
"""A map begins at g tan(alpha), below which the exact block stays at rest."""
LIMITS = {
    "frequency": (1e-3, 1e3),
    "slenderness": (1e-2, 1.5),
    "size": (1e-3, 1e3),
    "onsets": (1.001, 1e3),
    "aspect": (0.1, 100.0),
}
"""Between which values the edges of every model are found, and in little time."""
LEAST_SPAN = 1.001
"""The range of the abscissa, its end over its beginning, is at least this."""


def _check(name: str, value: float, limits: tuple[float, float]) -> None:
    least, most = limits
    if not least <= value <= most:
        raise ValueError(f"{name} is {value!r}; it must be from {least:g} to {most:g}")


@dataclass(frozen=True, slots=True, kw_only=True)
class Window:
    """A plane of pulses: columns of one block and frequency, amplitudes in units of g tan(alpha).

    The abscissa goes from `low` to `high`, those of AXES where not given. `aspect` (H/B) holds
    unless alpha is the abscissa, `omega_over_p` only then, and `pulse_hz` where the size is. A
    ValueError names a value that is beyond LIMITS.
    """

    over: Axis = "frequency"
    pulse: str = "full-sine"
    aspect: float = 4.0
    omega_over_p: float = 3.0
    pulse_hz: float = 1.0
    low: float = math.nan
    high: float = math.nan
    onsets: float = 10.0
    columns: int = 1000
    rows: int = 1000

    def __post_init__(self) -> None:
        for name, default in zip(("low", "high"), AXES[self.over], strict=False):
            if math.isnan(getattr(self, name)):
                object.__setattr__(self, name, default)
            _check(name, getattr(self, name), LIMITS[self.over])
        if self.high < LEAST_SPAN * self.low:
            allowed = f"low must be the smaller, at most {self.high / LEAST_SPAN:g}"
            raise ValueError(f"low is {self.low!r} and high {self.high!r}; {allowed}")
        for name in ("onsets", "aspect"):
            _check(name, getattr(self, name), LIMITS[name])
        slowest, fastest = LIMITS["frequency"]
        _check("omega_over_p", self.omega_over_p, (slowest, fastest))
        if self.over == "size":
            _check("pulse_hz", self.pulse_hz, (slowest * self.high, fastest * self.low))

    @property
    def half_cycles(self) -> int:
        """Length of the pulse."""
        return PULSES[self.pulse]

    @property
    def title(self) -> str:
        """What all points have in common."""
        if self.over == "slenderness":
            return f"{self.pulse} pulse, ω/p = {self.omega_over_p:g}"
        shape = f"{self.pulse} pulse, H/B = {self.aspect:g}"
        return shape if self.over == "frequency" else f"{shape}, {self.pulse_hz:g} Hz"

    def centres(self, count: int) -> FloatArray:
        """Return the abscissae of `count` columns."""
        return self.low + (np.arange(count) + 0.5) * (self.high - self.low) / count

    def amplitudes(self, count: int) -> FloatArray:
        """Return `count` amplitudes over g tan(alpha)."""
        return LEAST_ONSETS + (np.arange(count) + 0.5) * (self.onsets - LEAST_ONSETS) / count

    def points(self, most: int) -> tuple[FloatArray, FloatArray]:
        """Return abscissae and amplitudes of a grid of at most so many columns and rows."""
        x, onsets = self.centres(min(self.columns, most)), self.amplitudes(min(self.rows, most))
        return np.repeat(x, len(onsets)), np.tile(onsets, len(x))

    def alpha(self, x: FloatArray) -> FloatArray:
        """Return the slenderness [rad] at abscissae."""
        return x if self.over == "slenderness" else np.full_like(x, math.atan(1.0 / self.aspect))

    def ratio(self, x: FloatArray) -> FloatArray:
        """Return omega/p at abscissae."""
        if self.over == "frequency":
            return x
        return self.pulse_hz / x if self.over == "size" else np.full_like(x, self.omega_over_p)

    def modes(self, x: FloatArray, onsets: FloatArray, model: str = "exact") -> Modes:
        """Return what happens to a model's block at points of the plane, broadcast."""
        alpha = self.alpha(x)
        amplitude = onsets * np.tan(alpha)
        return overturning_modes(alpha, amplitude, self.ratio(x), self.half_cycles, model)

    def condition_numbers(self, x: FloatArray, onsets: FloatArray) -> Conditioning:
        """Return the condition numbers of the exact peaks at points of the plane, broadcast."""
        alpha = self.alpha(x)
        return condition_numbers(alpha, onsets * np.tan(alpha), self.ratio(x), self.half_cycles)

    def case(self, x: float, onsets: float) -> tuple[RigidBlock, SinePulse]:
        """Return the block and the pulse of a point, for sources other than the models."""
        alpha = float(self.alpha(np.array(x)))
        width = 0.5
        if self.over == "size":
            width = 2.0 * 0.75 * GRAVITY / (2.0 * math.pi * x) ** 2 * math.sin(alpha)
        block = RigidBlock(width=width, height=width / math.tan(alpha))
        return block, SinePulse(
            amplitude=onsets * math.tan(alpha) * block.gravity,
            omega=float(self.ratio(np.array(x))) * block.p,
            half_cycles=self.half_cycles,
        )
