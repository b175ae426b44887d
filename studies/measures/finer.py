"""Errors along a method's settings: a lucky setting is told by those that are finer."""

from __future__ import annotations

from typing import Any

import pandas as pd


def cheapest_kept(
    lines: pd.DataFrame, keeps: pd.Series[Any], *methods: pd.Series[Any]
) -> pd.Series[Any] | None:
    """Return the line of least wall_s that keeps an error as every finer one does; None without.

    The lines are settings from coarse to fine, of one method or of those in `methods`; `keeps` says
    whether each keeps the error by itself.
    """
    from_fine = keeps.astype(bool)[::-1]
    kept = (from_fine.groupby(list(methods), sort=False) if methods else from_fine).cummin()[::-1]
    return lines[kept].sort_values("wall_s").iloc[0] if kept.any() else None


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
