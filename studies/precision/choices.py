"""Which setting of an engine for which accuracy: the cheapest, and what it does elsewhere."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from studies.measures.finer import cheapest_kept
from studies.measures.finer import joint as joint
from studies.precision.methods import METHODS
from studies.sources.registry import resolve

TYPICAL, NEAR = "typical", "near overturning"
"""The sets of cases."""

TARGETS = (0.1, 1e-2, 1e-3, 1e-4)
"""Errors that somebody may ask for."""

EXACT = "Taylor series"
"""The method to whose time the others are compared."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Choice:
    """The cheapest setting of an engine below a target.

    Attributes
    ----------
    value : float
    setting : str
        It and its method in words.
    wall_s : float
        Mean time of a case [s], over the cases among which it was chosen.
    over_exact : float
        That over the exact solution's.
    runs : int
        How often a case was timed at least.
    loop : str
        Who took the steps: compiled, or python.
    typical_error, near_error : float
        Its largest error on typical cases and near overturning; inf where an outcome is wrong.
    """

    value: float
    setting: str
    wall_s: float
    over_exact: float
    runs: int
    loop: str
    typical_error: float
    near_error: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Choices:
    """What to choose for a target on typical cases, and on all; None where nothing reaches it."""

    target: float
    typical: Choice | None
    everywhere: Choice | None


def choices(table: pd.DataFrame, loop: str = "") -> tuple[Choices, ...]:
    """Return what to choose for each target.

    Parameters
    ----------
    table : DataFrame
        The columns of work-precision.csv.
    loop : str, optional
        compiled or python, for the engines alone that are stepped so; by default all.
    """
    typical, engines = table[table["set"] == TYPICAL], engines_of(table)
    if loop:
        engines = engines[engines["driver"] == loop]
    errors = engines.set_index(["method", "value", "set"])["max_error"]

    def choose(among: pd.DataFrame, target: float, timed: pd.DataFrame) -> Choice | None:
        best = cheapest_below(among, target)
        if best is None:
            return None
        typical, near = (
            errors.get((best["method"], best["value"], name), math.nan) for name in (TYPICAL, NEAR)
        )
        return Choice(
            value=float(best["value"]),
            setting=setting_of(best),
            wall_s=float(best["wall_s"]),
            over_exact=float(best["wall_s"]) / exact_cost(timed),
            runs=int(best["runs"]),
            loop=str(best["driver"]),
            typical_error=float(typical),
            near_error=float(near),
        )

    return tuple(
        Choices(
            target=target,
            typical=choose(engines[engines["set"] == TYPICAL], target, typical),
            everywhere=choose(joint(engines), target, table),
        )
        for target in TARGETS
    )


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
