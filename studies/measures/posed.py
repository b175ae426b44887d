"""How many problems a sweep's cases are: similarity makes one of all that differ in size alone."""

from __future__ import annotations

from typing import NamedTuple

import pandas as pd

PROBLEM = ["figure", "aspect", "omega_over_p"]


class Posed(NamedTuple):
    """Cases, the problems that they are, in how many sizes; the ends of the amplitudes [onsets]."""

    cases: int
    problems: int
    sizes: int
    least: float
    largest: float

    @property
    def words(self) -> str:
        """What was posed, in words."""
        ends = dict.fromkeys(f"{value:.2g}" for value in (self.least, self.largest))
        all_of_them = self.cases == self.problems * self.sizes
        sizes = f", {'each in' if all_of_them else 'in up to'} {self.sizes} sizes"
        return (
            f"{self.cases} cases are {self.problems} problems{sizes if self.sizes > 1 else ''}, "
            f"at {' to '.join(ends)} times the onset"
        )


def posed(rows: pd.DataFrame) -> Posed:
    """Return what the rows of a sweep.csv were asked, whoever answered."""
    cases = rows[[*PROBLEM, "width_m", "excess_g"]].drop_duplicates()
    onsets = 1.0 + cases["excess_g"] * cases["aspect"]  # (B/H + e) g over g B/H
    problems = len(cases[PROBLEM].drop_duplicates())
    sizes = cases["width_m"].nunique()
    return Posed(len(cases), problems, sizes, float(onsets.min()), float(onsets.max()))
