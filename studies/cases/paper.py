"""The paper's cases: the sweeps of figures 6 to 9, the time histories of figures 2, 4 and 5."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from analytic.block import GRAVITY, RigidBlock
from analytic.motion import Motion, SinePulse
from engines.layouts import System

PULSES = {"half-sine": 1, "full-sine": 2}
"""Half cycles of each pulse."""

SWEEPS = {
    6: ("half-sine", 0.05),
    7: ("half-sine", 0.1),
    8: ("full-sine", 0.1),
    9: ("full-sine", 0.125),
}
"""Pulse and excess e of each figure: its amplitude is (B/H + e) g.

The caption of figure 8 repeats the 0.125 of figure 9; the paper's text lists 0.1 and 0.125."""

ASPECTS = (2, 3, 4)
"""H/B, the rows of panels."""

WIDTHS_M = (0.5, 1.0)
"""B [m], the columns of panels."""

OMEGA_RATIOS = tuple(k / 10 for k in range(1, 41))
"""omega/p, the abscissa."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One point of the paper's sensitivity analysis.

    Attributes
    ----------
    figure, pulse, excess_g : int, str, float
        Of `SWEEPS`; the excess e is in g.
    aspect, width_m : float
        H/B, and B [m].
    omega_over_p : float
        Circular frequency of the pulse over p.
    """

    figure: int
    pulse: str
    excess_g: float
    aspect: float
    width_m: float
    omega_over_p: float

    @property
    def block(self) -> RigidBlock:
        """The block of this width and aspect ratio."""
        return RigidBlock(width=self.width_m, height=self.aspect * self.width_m)

    @property
    def amplitude_g(self) -> float:
        """Amplitude of the pulse over g: B/H and the excess."""
        return 1.0 / self.aspect + self.excess_g

    @property
    def motion(self) -> SinePulse:
        """The pulse."""
        return SinePulse(
            amplitude=self.amplitude_g * GRAVITY,
            omega=self.omega_over_p * self.block.p,
            half_cycles=PULSES[self.pulse],
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class HistoryCase:
    """One panel of the paper's time histories.

    Attributes
    ----------
    figure, panel, pulse : int, str, str
        The pulse is one of `PULSES`.
    width_m, height_m : float
        B and H [m].
    amplitude_g, omega_rad_s : float
        Amplitude [g] and circular frequency [rad/s] of the pulse.
    """

    figure: int
    panel: str
    pulse: str
    width_m: float
    height_m: float
    amplitude_g: float
    omega_rad_s: float = 2.0 * math.pi

    @property
    def block(self) -> RigidBlock:
        """The block."""
        return RigidBlock(width=self.width_m, height=self.height_m)

    @property
    def motion(self) -> SinePulse:
        """The pulse."""
        return SinePulse(
            amplitude=self.amplitude_g * GRAVITY,
            omega=self.omega_rad_s,
            half_cycles=PULSES[self.pulse],
        )


def _panel(figure: int, panel: str, pulse: str, size: tuple[float, float], a: float) -> HistoryCase:
    width, height = size
    return HistoryCase(
        figure=figure, panel=panel, pulse=pulse, width_m=width, height_m=height, amplitude_g=a
    )


HISTORIES = {
    # the caption of figure 2 does not name its pulse: both readings are drawn
    2: (
        _panel(2, "a", "half-sine", (1.0, 3.0), 0.4),
        _panel(2, "b", "full-sine", (1.0, 3.0), 0.4),
    ),
    4: (
        _panel(4, "a", "half-sine", (0.5, 3.0), 0.2),
        _panel(4, "b", "half-sine", (0.5, 1.5), 0.4),
        _panel(4, "c", "half-sine", (0.5, 1.0), 0.7),
    ),
    5: (
        _panel(5, "a", "full-sine", (0.5, 3.0), 0.2),
        _panel(5, "b", "full-sine", (0.5, 1.5), 0.4),
        _panel(5, "c", "full-sine", (0.5, 1.0), 0.6),
    ),
}
"""Panels of each figure of time histories."""


def sweep_cases(figures: Iterable[int]) -> Iterator[Case]:
    """Yield the 240 cases of each figure: aspect ratio, width, then frequency."""
    for figure in figures:
        pulse, excess_g = SWEEPS[figure]
        for aspect in ASPECTS:
            for width_m in WIDTHS_M:
                for omega_over_p in OMEGA_RATIOS:
                    yield Case(
                        figure=figure,
                        pulse=pulse,
                        excess_g=excess_g,
                        aspect=aspect,
                        width_m=width_m,
                        omega_over_p=omega_over_p,
                    )


def free_rocking_window(block: System, motion: Motion) -> float:
    """Return the time [s] of an observation: the motion and 8/p of free rocking, a few impacts.

    Parameters
    ----------
    block : System
        Of which p [rad/s] is used.
    motion : Motion
        From time 0; its duration [s] is used.
    """
    return motion.duration + 8.0 / block.p
