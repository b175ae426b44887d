"""Blocks from squat to slender under full-sine pulses, and what the reference needs for each."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import pandas as pd

from analytic import simulate
from analytic.block import GRAVITY, RigidBlock
from analytic.motion import SinePulse

ASPECTS = (1.0, 1.5, 2.0, 3.0)
"""H/B: the squatter, the less valid."""

WIDTH_M = 0.5
"""By similarity the map is that of any width."""

HALF_CYCLES = 2


@dataclass(frozen=True, slots=True, kw_only=True)
class ValidityCase:
    """A block under a full-sine pulse.

    Attributes
    ----------
    aspect : float
        H/B.
    onsets : float
        Amplitude over g B/H.
    omega_over_p : float
    """

    aspect: float
    onsets: float
    omega_over_p: float

    @property
    def block(self) -> RigidBlock:
        """The block."""
        return RigidBlock(width=WIDTH_M, height=self.aspect * WIDTH_M)

    @property
    def motion(self) -> SinePulse:
        """The pulse."""
        return SinePulse(
            amplitude=self.onsets * GRAVITY / self.aspect,
            omega=self.omega_over_p * self.block.p,
            half_cycles=HALF_CYCLES,
        )

    @property
    def labels(self) -> dict[str, float]:
        """The columns that name the case."""
        return {
            "aspect": self.aspect,
            "onsets": self.onsets,
            "omega_over_p": self.omega_over_p,
        }


def grid(onsets: Sequence[float], omegas: Sequence[float]) -> Iterator[ValidityCase]:
    """Yield the cases of a grid, for every one of ASPECTS.

    Parameters
    ----------
    onsets, omegas : sequence of float
        Amplitudes over g B/H, and frequencies omega/p.

    Yields
    ------
    ValidityCase
        By aspect ratio, then amplitude, then frequency.
    """
    for aspect, onset, omega in product(ASPECTS, onsets, omegas):
        yield ValidityCase(aspect=aspect, onsets=onset, omega_over_p=omega)


def reference_map(cases: Sequence[ValidityCase]) -> pd.DataFrame:
    """Return what the exact solution of each case needs to be one: the columns of map.csv."""
    rows = []
    for case in cases:
        exact = simulate(case.block, case.motion)
        rows.append(
            {
                **case.labels,
                "outcome": exact.outcome.value,
                "peak_ratio": exact.peak_ratio,
                "min_normal": exact.min_normal,
                "friction_needed": exact.friction_needed,
            }
        )
    return pd.DataFrame(rows)
