"""Errors along a method's settings: a lucky setting is told by those that are finer."""

from __future__ import annotations

from typing import Any

import pandas as pd


def with_every_finer(keeps: pd.Series[Any], *uses: pd.Series[Any]) -> pd.Series[bool]:
    """Return which settings keep an error together with every finer one.

    Parameters
    ----------
    keeps : Series of bool
        Whether each setting keeps it by itself, from coarse to fine.
    uses : Series
        What the settings are of, as a method, or an engine and a preset; by default all of one.
    """
    from_fine = keeps.astype(bool)[::-1]
    each = from_fine.groupby(list(uses), sort=False) if uses else from_fine
    return each.cummin()[::-1]


def cheapest_kept(
    lines: pd.DataFrame, keeps: pd.Series[Any], *uses: pd.Series[Any]
) -> pd.Series[Any] | None:
    """Return the fastest setting that keeps an error together with every finer one.

    Parameters
    ----------
    lines : DataFrame
        A line for each setting, from coarse to fine within its use, with wall_s [s].
    keeps, *uses : Series
        As for `with_every_finer`, under the index of the lines.

    Returns
    -------
    Series or None
        The line; None if there is none.
    """
    good = lines[with_every_finer(keeps, *uses)]
    return None if good.empty else good.sort_values("wall_s").iloc[0]


def joint(table: pd.DataFrame) -> pd.DataFrame:
    """Return both sets of a setting as one line: failures, largest error, mean time of a case."""
    total = table.assign(wall_s=table["wall_s"] * table["cases"])
    found = total.groupby(["method", "value"], sort=False).agg(
        cases=("cases", "sum"),
        failed=("failed", "sum"),
        max_error=("max_error", "max"),
        wall_s=("wall_s", "sum"),
        runs=("runs", "min"),
    )
    return found.assign(wall_s=found["wall_s"] / found["cases"]).reset_index()
