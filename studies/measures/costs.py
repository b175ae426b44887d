"""What a run costs: its time, the best of so many runs that it is known; and an error's."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from time import perf_counter
from typing import Any

import pandas as pd

from analytic.response import Response
from engines import ENGINES
from studies.kit.say import duration

LEAST_RUNS, LEAST_S = 5, 0.02
"""A time is of the best of so many runs at least, or marked; in that time [s] all gets warm."""
STEPPED = "A compiled loop over `mj_step` takes MuJoCo's steps; Python takes all others."
"""Said beside times of a step or of a case."""

EXACT = "Taylor series"
"""The method to whose time the others are compared."""


def enough(times: Sequence[float], spent_s: float, most_s: float) -> bool:
    """Return whether the shortest of some run times [s] is known, or the time for more is spent."""
    if spent_s >= most_s:
        return True
    if len(times) < LEAST_RUNS or spent_s < LEAST_S:
        return False
    shortest, next_shortest = sorted(times)[:2]
    return next_shortest <= 1.02 * shortest  # a minimum that came twice is no accident


def best_of(actions: Sequence[Callable[[], Response]], most_s: float) -> list[tuple[Response, int]]:
    """Return of each action the response with the shortest run and set-up times, and the runs."""
    # in turn, so that what else a machine does for a while meets all alike
    began, rounds, known = perf_counter(), list[list[Response]](), False
    while not known:
        rounds.append([action() for action in actions])
        spent_s = (perf_counter() - began) / len(actions)
        runs = [*zip(*rounds, strict=True)]
        known = all(enough([run.wall_s for run in of_one], spent_s, most_s) for of_one in runs)
    best = [min(of_one, key=lambda run: run.wall_s) for of_one in runs]
    setups_s = [min(run.setup_s for run in of_one) for of_one in runs]
    return [
        (replace(run, setup_s=setup_s), len(rounds))
        for run, setup_s in zip(best, setups_s, strict=True)
    ]


def cost_text(wall_s: float, runs: float) -> str:
    """Return a time [s] in words, with its runs where they are few: "12.4 ms (4 runs)"."""
    if math.isnan(wall_s):
        return "-"
    few = f" ({runs:.0f} run{'s' if runs != 1 else ''})" if runs < LEAST_RUNS else ""
    return f"{duration(wall_s)}{few}"


def exact_cost(lines: pd.DataFrame) -> float:
    """Return the mean time [s] of a case by the exact solution at its tightest; nan without it."""
    exact = lines[lines["method"] == EXACT]
    tight = exact[exact["value"] == exact["value"].min()]
    return float((tight["wall_s"] * tight["cases"]).sum() / (tight["cases"].sum() or math.nan))


def parts_of(method: str) -> tuple[str, str, str]:
    """Return a method's engine, preset and what else is varied; empty words of all others."""
    engine, _, varied = method.partition(" ")
    preset, _, dial = varied.partition(", ")
    return (engine, preset, dial) if engine in ENGINES else ("", "", "")


def cheapest_kept(
    lines: pd.DataFrame, keeps: pd.Series[Any], *methods: pd.Series[Any]
) -> pd.Series[Any] | None:
    """Return the line of least wall_s that keeps an error as every finer one does; None without."""
    from_fine = keeps.astype(bool)[::-1]
    kept = (from_fine.groupby(list(methods), sort=False) if methods else from_fine).cummin()[::-1]
    return lines[kept].sort_values("wall_s").iloc[0] if kept.any() else None


def cheapest_below(lines: pd.DataFrame, target: float) -> pd.Series[Any] | None:
    """Return the fastest setting, among those of methods, whose largest error is below a target."""
    keeps = (lines["failed"] == 0) & (lines["max_error"] <= target)
    return cheapest_kept(lines, keeps, lines["method"])


def joint(table: pd.DataFrame) -> pd.DataFrame:
    """Return both sets of a setting as one line: failures, largest error, mean time of a case."""
    total = table.assign(wall_s=table["wall_s"] * table["cases"])
    kinds = {"cases": "sum", "failed": "sum", "max_error": "max", "wall_s": "sum", "runs": "min"}
    found = total.groupby(["method", "value"], sort=False, as_index=False).agg(kinds)
    return found.assign(wall_s=found["wall_s"] / found["cases"])
