"""What a run costs: its time, as the best of so many runs that it is known, and that in words."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from time import perf_counter

import pandas as pd

from analytic.response import Response
from engines import ENGINES
from studies.kit.say import duration
from studies.measures.presets import look_of

LEAST_RUNS = 5
"""A time is of the best of so many runs at least, or marked."""
LEAST_S = 0.02
"""Time [s] spent on runs at least: what is timed in it is warm."""
AGREED = 0.02
"""Part by which the two shortest may differ: a minimum that came twice is no accident."""
STEPPED = "A compiled loop over `mj_step` takes MuJoCo's steps; Python takes all others."
"""Said beside times of a step or of a case."""
OUTDATED = (
    "PyBullet's published times, but for `naive` and `recommended`, are those of a retired "
    "compiled loop, shorter than today's."
)
"""Said beside them until they are measured again."""

EXACT = "Taylor series"
"""The method to whose time the others are compared."""


def enough(times: Sequence[float], spent_s: float, most_s: float) -> bool:
    """Return whether the shortest of some run times is known, or nothing more may be spent on it.

    Parameters
    ----------
    times : sequence of float
        Run times so far [s], one at least.
    spent_s, most_s : float
        How long the runs took with all about them [s], and after what time there is no further one.
    """
    if spent_s >= most_s:
        return True
    if len(times) < LEAST_RUNS or spent_s < LEAST_S:
        return False
    shortest, next_shortest = sorted(times)[:2]
    return next_shortest <= (1.0 + AGREED) * shortest


def best_of(action: Callable[[], Response], most_s: float) -> tuple[Response, int]:
    """Return the response with the shortest run time and the shortest set-up time, and the runs."""
    return best_of_each([action], most_s)[0]


def best_of_each(
    actions: Sequence[Callable[[], Response]], most_s: float
) -> list[tuple[Response, int]]:
    """Return the same of several actions that are run in turn until the time of each is known.

    What else a machine does for a while meets them all alike.

    Parameters
    ----------
    actions : sequence of callable
        Each returns a response with its run time; repeated until `enough`.
    most_s : float
        Time [s] spent at most on each, in the mean.
    """
    began, rounds, known = perf_counter(), list[list[Response]](), False
    while not known:
        rounds.append([action() for action in actions])
        spent_s = (perf_counter() - began) / len(actions)
        runs = [*zip(*rounds, strict=True)]
        known = all(enough([run.wall_s for run in of_one], spent_s, most_s) for of_one in runs)
    return [
        (
            replace(
                min(of_one, key=lambda run: run.wall_s), setup_s=min(r.setup_s for r in of_one)
            ),
            len(of_one),
        )
        for of_one in runs
    ]


def cost_text(wall_s: float, runs: float, each: str = "") -> str:
    """Return a time, and what takes it, in words: "12.4 ms a case (4 runs)".

    Parameters
    ----------
    wall_s : float
        [s]; of nan the words are "-".
    runs : float
        Of how many runs it is the best; said where they are fewer than LEAST_RUNS.
    each : str, optional
        What takes the time, with a space before it.
    """
    if math.isnan(wall_s):
        return "-"
    few = f" ({runs:.0f} run{'s' if runs != 1 else ''})" if runs < LEAST_RUNS else ""
    return f"{duration(wall_s)}{each}{few}"


def exact_cost(lines: pd.DataFrame) -> float:
    """Return the mean time [s] of a case by the exact solution at its tightest; nan without it."""
    exact = lines[lines["method"] == EXACT]
    tight = exact[exact["value"] == exact["value"].min()]
    return float((tight["wall_s"] * tight["cases"]).sum() / (tight["cases"].sum() or math.nan))


def method_title(method: str) -> str:
    """Return how a method is called beside others: an engine by its title, with its preset."""
    engine, _, varied = method.partition(" ")
    if engine not in ENGINES:
        return method
    preset, comma, dial = varied.partition(", ")
    return f"{ENGINES[engine].title}, {look_of(preset).short}{comma}{dial}"


def costs_of(scenes: pd.DataFrame) -> pd.Series[float]:
    """Return the run times over those of the scene as it is, timed in turn where a table says."""
    first = scenes.groupby("engine")["wall_s"].transform("first")
    return scenes["wall_s"] / scenes.get("plain_s", first)
