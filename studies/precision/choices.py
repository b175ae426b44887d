"""Which setting of an engine for which accuracy: the cheapest, and what it does elsewhere."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pandas as pd

from studies.measures.finer import cheapest_kept, joint
from studies.precision.methods import METHODS
from studies.sources.registry import resolve

TYPICAL, NEAR, ALL = "typical", "near overturning", "all"
"""The sets of cases, and both together."""

TARGETS = (0.1, 1e-2, 1e-3, 1e-4)
"""Errors that somebody may ask for."""

EXACT = "Taylor series"
"""The method to whose time the others are compared."""


def choices(table: pd.DataFrame) -> dict[tuple[float, str], dict[str, Any]]:
    """Return the cheapest setting of an engine below each target, on typical cases and on all.

    Parameters
    ----------
    table : DataFrame
        The columns of work-precision.csv.

    Returns
    -------
    dict
        (target, TYPICAL or ALL) -> value, and setting: it and its method in words; wall_s: mean
        time of a case [s], and over_exact: that over the exact solution's, both over these cases;
        runs; typical_error, near_error: its largest errors, inf where an outcome is wrong. Nothing
        where no setting reaches the target.
    """
    engines = engines_of(table)
    errors = engines.set_index(["method", "value", "set"])["max_error"]
    among = {
        TYPICAL: (engines[engines["set"] == TYPICAL], table[table["set"] == TYPICAL]),
        ALL: (joint(engines), table),
    }
    found = {}
    for target, (cases, (lines, timed)) in itertools.product(TARGETS, among.items()):
        best = cheapest_below(lines, target)
        if best is not None:
            typical, near = (
                float(errors.get((best["method"], best["value"], name), math.nan))
                for name in (TYPICAL, NEAR)
            )
            found[target, cases] = {
                **best[["value", "wall_s", "runs"]],
                "setting": setting_of(best),
                "over_exact": best["wall_s"] / exact_cost(timed),
                "typical_error": typical,
                "near_error": near,
            }
    return found


def cheapest_below(lines: pd.DataFrame, target: float) -> pd.Series[Any] | None:
    """Return the cheapest line whose largest error is below a target, if there is one.

    Every finer setting of its method must stay below it, too: a coarse one may be lucky.

    Parameters
    ----------
    lines : DataFrame
        Those of each method from coarse to fine.
    target : float
    """
    keeps = (lines["failed"] == 0) & (lines["max_error"] <= target)
    return cheapest_kept(lines, keeps, lines["method"])


def engines_of(table: pd.DataFrame) -> pd.DataFrame:
    """Return the lines of the engines along their steps."""
    stepping = {
        name
        for name, method in METHODS.items()
        if method.stepping and resolve(method.source).kind == "engine"
    }
    return table[table["method"].isin(stepping)]


def exact_cost(lines: pd.DataFrame) -> float:
    """Return the mean time [s] of a case by the exact solution at its tightest tolerance."""
    exact = lines[lines["method"] == EXACT]
    tight = exact[exact["value"] == exact["value"].min()]
    return float(np.average(tight["wall_s"], weights=tight["cases"]))


def setting_of(line: pd.Series[Any]) -> str:
    """Return a method and its setting in words."""
    method = METHODS[str(line["method"])]
    if not method.setting:
        return str(line["method"])
    name = "p dt" if method.setting == "step" else method.setting
    return f"{line['method']} at {name} = {line['value']:g}"
