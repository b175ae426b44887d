"""The paper's cases: the sweeps of figures 6 to 9, the time histories of figures 2, 4 and 5."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from itertools import product

import numpy as np

from analytic import RigidBlock, SinePulse, peak_ratios

PULSES = {"half-sine": 1, "full-sine": 2}
"""Half cycles of each pulse."""
SWEEPS = {
    6: ("half-sine", 0.05),
    7: ("half-sine", 0.1),
    8: ("full-sine", 0.1),  # so the paper's text; the caption repeats the 0.125 of figure 9
    9: ("full-sine", 0.125),
}
"""Pulse and excess e of each figure: its amplitude is (B/H + e) g."""
ASPECTS = (2, 3, 4)
"""H/B, the rows of panels."""
WIDTHS_M = (0.5, 1.0)
"""B [m], the columns of panels."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One point of the paper's sensitivity analysis: figure, pulse and excess [g] of `SWEEPS`."""

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
        omega, half_cycles = self.omega_over_p * self.block.p, PULSES[self.pulse]
        return SinePulse.in_g(self.amplitude_g, omega=omega, half_cycles=half_cycles)


@dataclass(frozen=True, slots=True)
class HistoryCase:
    """One panel of the paper's time histories: a pulse of `PULSES`, B and H [m]."""

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
        half_cycles = PULSES[self.pulse]
        return SinePulse.in_g(self.amplitude_g, omega=self.omega_rad_s, half_cycles=half_cycles)


HISTORIES = {
    2: (  # its caption does not name the pulse: both readings are drawn
        HistoryCase(2, "a", "half-sine", 1.0, 3.0, 0.4),
        HistoryCase(2, "b", "full-sine", 1.0, 3.0, 0.4),
    ),
    4: (
        HistoryCase(4, "a", "half-sine", 0.5, 3.0, 0.2),
        HistoryCase(4, "b", "half-sine", 0.5, 1.5, 0.4),
        HistoryCase(4, "c", "half-sine", 0.5, 1.0, 0.7),
    ),
    5: (
        HistoryCase(5, "a", "full-sine", 0.5, 3.0, 0.2),
        HistoryCase(5, "b", "full-sine", 0.5, 1.5, 0.4),
        HistoryCase(5, "c", "full-sine", 0.5, 1.0, 0.6),
    ),
}
"""Panels of each figure of time histories."""


def sweep_cases(figures: Iterable[int]) -> Iterator[Case]:
    """Yield the 240 cases of each figure: aspect ratio, width, then frequency."""
    for figure in figures:
        pulse, excess_g = SWEEPS[figure]
        for aspect, width_m, tenths in product(ASPECTS, WIDTHS_M, range(1, 41)):
            yield Case(
                figure=figure,
                pulse=pulse,
                excess_g=excess_g,
                aspect=aspect,
                width_m=width_m,
                omega_over_p=tenths / 10,
            )


@cache
def chosen_cases(quick: bool) -> dict[str, list[Case]]:
    """Return the cases of each set: "typical", with peaks near 0.3, and "near overturning"."""
    chosen: dict[str, list[Case]] = {"typical": [], "near overturning": []}
    for figure in (6, 8) if quick else (6, 7, 8, 9):
        known = [case for case in sweep_cases([figure]) if case.width_m == 0.5]
        posed = [
            (case.block.alpha, case.amplitude_g, case.omega_over_p, case.motion.half_cycles)
            for case in known
        ]
        peaks, _ = peak_ratios(*np.array(posed, np.float64).T)
        for aspect in ASPECTS:
            mine = np.isfinite(peaks) & np.array([case.aspect == aspect for case in known])
            survivors = np.where(mine, peaks, -np.inf)
            chosen["typical"].append(known[int(np.argmin(np.abs(survivors - 0.3)))])
            chosen["near overturning"].append(known[int(np.argmax(survivors))])
    return chosen
