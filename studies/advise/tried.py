"""Random cases at the published steps: what each setting errs by on what it was not chosen by."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from studies.kit.journal import Row
from studies.measures.differences import (
    WELL_CONDITIONED,
    conditioning_of,
    exact_peaks,
    with_reference,
)

RANDOM = "steps/random.csv"
"""Table of the random cases at the settings that keep an error on the other published cases."""

SETTING = ["engine", "preset", "value"]
"""Columns that tell one setting from another."""

COUNTS = ["random_cases", "random_off", "random_calm_off"]
"""Columns of `counted`."""

EDGE = 0.1 / WELL_CONDITIONED
"""Relative change of a pulse that moves the peak of a well conditioned case by less than 10 %; a
case that overturns is near the edge where so much less, or more, of the pulse does not."""

DIGITS = 4
"""Digits of an error in the table."""


def judged(rows: Sequence[Row]) -> pd.DataFrame:
    """Return the columns of random.csv: a line for each setting and case.

    error is that of the peak, 0 where both overturn or stay at rest, inf where the outcome is
    another; condition is the larger of |κ|, |κη| and 1, of a case that overturns 1, or inf where
    it is near the edge.
    """
    compared = with_reference(pd.DataFrame(rows))
    error = compared["error"].abs().where(compared["agrees"], math.inf).fillna(0.0)
    lines = compared[[*SETTING, "case"]].assign(condition=_condition(compared), error=error)
    numbers = ["condition", "error"]
    return lines.assign(**{name: lines[name].map(_short) for name in numbers})


def _condition(compared: pd.DataFrame) -> pd.Series[float]:
    falls = compared["exact_outcome"] == "overturned"
    nearby = [
        exact_peaks(compared.assign(amplitude_g=compared["amplitude_g"] * (1.0 + sign * EDGE)))[0]
        for sign in (-1.0, 1.0)
    ]
    firm = pd.Series(np.isinf(nearby).all(axis=0), index=compared.index)
    return conditioning_of(compared).mask(falls & firm, 1.0).mask(falls & ~firm, math.inf)


def _short(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


def random_runs(published: Path) -> pd.DataFrame:
    """Return the published random cases at each setting; none where they were not run."""
    path = published / RANDOM
    columns = [*SETTING, "case", "condition", "error"]
    found = pd.read_csv(path) if path.is_file() else pd.DataFrame(columns=columns)
    return found.astype({"value": float})


def counted(known: pd.DataFrame, runs: pd.DataFrame, target: float) -> pd.DataFrame:
    """Return settings with the number of their random cases, and of those that are off.

    Parameters
    ----------
    known : DataFrame
        The columns of `studies.advise.evidence.settings`.
    runs : DataFrame
        From `random_runs`.
    target : float
        A case is off if its error is larger, and calm where its condition is below
        WELL_CONDITIONED.
    """
    off = runs["error"] > target
    calm = runs["condition"] < WELL_CONDITIONED
    marked = runs[SETTING].assign(random_cases=1, random_off=off, random_calm_off=off & calm)
    found = marked.groupby(SETTING, dropna=False)[COUNTS].sum().reset_index()
    # settings whose step is in seconds have no value, in both
    merged = known.astype({"value": float}).merge(found, on=SETTING, how="left")
    return merged.assign(**{name: merged[name].fillna(0).astype(int) for name in COUNTS})
