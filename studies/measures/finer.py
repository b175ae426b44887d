"""Errors along a method's settings: a lucky setting is told by those that are finer."""

from __future__ import annotations

from typing import Any

import pandas as pd


def with_every_finer(keeps: pd.Series[Any], *uses: pd.Series[Any]) -> pd.Series[bool]:
    """Return which settings, from coarse to fine, keep an error together with every finer one.

    `keeps` says whether each does by itself, and `uses` of what they are settings, as a method, or
    an engine and a preset; without, all are of one.
    """
    from_fine = keeps.astype(bool)[::-1]
    each = from_fine.groupby(list(uses), sort=False) if uses else from_fine
    return each.cummin()[::-1]


def cheapest_kept(
    lines: pd.DataFrame, keeps: pd.Series[Any], *uses: pd.Series[Any]
) -> pd.Series[Any] | None:
    """Return the line of least wall_s among those `with_every_finer`; None if there is none."""
    good = lines[with_every_finer(keeps, *uses)]
    return None if good.empty else good.sort_values("wall_s").iloc[0]


def cheapest_below(lines: pd.DataFrame, target: float) -> pd.Series[Any] | None:
    """Return the fastest setting, among those of methods, whose largest error is below a target.

    The lines are those of work-precision.csv, or `joint` ones.
    """
    keeps = (lines["failed"] == 0) & (lines["max_error"] <= target)
    return cheapest_kept(lines, keeps, lines["method"])


def joint(table: pd.DataFrame) -> pd.DataFrame:
    """Return both sets of a setting as one line: failures, largest error, mean time of a case."""
    total = table.assign(wall_s=table["wall_s"] * table["cases"])
    kinds = {"cases": "sum", "failed": "sum", "max_error": "max", "wall_s": "sum", "runs": "min"}
    found = total.groupby(["method", "value"], sort=False, as_index=False).agg(kinds)
    return found.assign(wall_s=found["wall_s"] / found["cases"])
