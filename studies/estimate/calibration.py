"""Random cases that survive; estimates beside their true errors, and the factors on them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import islice

import pandas as pd

from analytic import simulate
from analytic.response import Outcome
from studies.cases.drawn import Drawn, RandomCase, draw
from studies.measures.differences import with_reference, with_reference_of_frames
from studies.measures.halving import BOUNDED, estimates_of
from studies.measures.wrongness import FALL, REST, wrong_in

CALIBRATE, TEST = "calibrate", "test"
"""What a case is for: to find the factors, or to hold them against errors that they never saw."""

RESOLVED = 1e-9
"""Errors below are as good as none: no estimate has to bound them."""

CONFIDENCE = 0.95
"""Of the interval of a factor."""


def survivors(seed: int, scene: Drawn = "block") -> Iterator[RandomCase]:
    """Yield without end the random cases in which the exact solution rocks and survives."""
    kept = (
        drawn
        for drawn in draw(seed, scene)
        if simulate(drawn.block, drawn.motion).outcome is Outcome.ROCKED
    )
    for number, drawn in enumerate(kept):
        yield replace(drawn, case=number)


def both_sets(
    cases: int, tests: int, seed: int, scene: Drawn = "block"
) -> Iterator[tuple[str, RandomCase]]:
    """Yield so many cases that test and so many that calibrate, each with what it is for.

    Those that test are drawn with the seed, those that calibrate with the next one.
    """
    for use, first, count in ((TEST, seed, tests), (CALIBRATE, seed + 1, cases)):
        for case in islice(survivors(first, scene), count):
            yield use, case


def beside_errors(rows: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each case and source: its estimate beside its error.

    Parameters
    ----------
    rows : DataFrame
        The columns of estimate.csv, half being 1 for the runs at half the step.

    Returns
    -------
    DataFrame
        The rows at the whole step with the columns of `with_reference`, estimate, and over: the
        error over the estimate, 0 where there is no error to speak of; nan unless both rocked.
    """
    held = with_reference_of_frames if "load" in rows else with_reference
    whole = held(rows[rows["half"] == 0]).reset_index(drop=True)
    whole["estimate"] = math.nan
    for _, mine in whole.groupby("set"):
        finer = rows[(rows["half"] == 1) & (rows["set"] == mine["set"].iloc[0])]
        whole.loc[mine.index, "estimate"] = estimates_of(mine, finer)
    errors = whole["error"].abs()
    over = (errors / whole["estimate"]).where(errors > RESOLVED, 0.0)
    return whole.assign(over=over.where(errors.notna() & whole["estimate"].notna()))


def factors(lines: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each source: by how much its estimates are to be multiplied.

    Parameters
    ----------
    lines : DataFrame
        From `beside_errors`.

    Returns
    -------
    DataFrame
        From the cases that calibrate: source, cases, survivors (in both), median_estimate,
        median_error, the factors that bound half, 95 % and all of the errors, the ends of the
        `interval` of the second, the parts that 3 and 10 estimates bound; wrong outcomes, and how
        many of them half the step tells by another one. From those that test: tested, the
        survivors, and bounded, how many of their errors the upper end bounds.
    """
    table = []
    for source, rows in lines.groupby("source", sort=False):
        found = _found(rows[rows["set"] == CALIBRATE])
        other = rows.loc[rows["set"] == TEST, "over"].dropna()
        bounded = int((other <= found["factor_95_high"]).sum())
        table.append({"source": source, **found, "tested": len(other), "bounded": bounded})
    return pd.DataFrame(table)


def _found(rows: pd.DataFrame) -> dict[str, float]:
    """Return what one source's cases that calibrate tell."""
    over = rows["over"].dropna()
    kept = rows.loc[over.index]
    wrong = rows[wrong_in(rows).isin((FALL, REST))]
    low, high = interval(over, BOUNDED)
    return {
        "cases": len(rows),
        "survivors": len(kept),
        "median_estimate": kept["estimate"].median(),
        "median_error": kept["error"].abs().median(),
        "factor_50": _quantile(over, 0.5),
        "factor_95": _quantile(over, BOUNDED),
        "factor_95_low": low,
        "factor_95_high": high,
        "factor_all": _quantile(over, 1.0),
        "within_3": (over <= 3.0).mean(),
        "within_10": (over <= 10.0).mean(),
        "wrong": len(wrong),
        "told": int((wrong["estimate"] == math.inf).sum()),
    }


def interval(values: pd.Series[float], level: float) -> tuple[float, float]:
    """Return the ends of the interval that holds a quantile with `CONFIDENCE`, whatever is drawn.

    How many of n values are below the quantile is binomial, so that its ends are values themselves
    (Conover, "Practical Nonparametric Statistics", 1999, section 3.2); the upper is inf where the
    values are too few for one.
    """
    from scipy.stats import binom

    ordered = values.sort_values(ignore_index=True)
    if ordered.empty:
        return 0.0, math.inf
    below = binom(len(ordered), level)
    first = max(int(below.ppf(0.5 * (1.0 - CONFIDENCE))) - 1, 0)
    last = int(below.ppf(0.5 * (1.0 + CONFIDENCE)))
    return float(ordered[first]), float(ordered[last]) if last < len(ordered) else math.inf


def _quantile(values: pd.Series[float], level: float) -> float:
    """Return the smallest value that so much of all are not above; nan without any."""
    ordered = values.sort_values(ignore_index=True)
    if ordered.empty:
        return math.nan
    return float(ordered[max(math.ceil(level * len(ordered)) - 1, 0)])
