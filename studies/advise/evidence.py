"""What the published tables know of every setting: on how many cases, how wrong, how dear."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from engines import ENGINES
from engines.declaration import Preset
from studies.cases.paper import sweep_cases
from studies.old.journal import Row
from studies.old.tables import read_table
from studies.measures.differences import (
    WELL_CONDITIONED,
    conditioning_of,
    exact_peaks,
    with_reference,
)
from studies.measures.finer import joint
from studies.measures.presets import uses_of
from studies.measures.verdicts import ACCEPTED
from studies.sources.registry import resolve

LADDER = "precision/work-precision.csv"
"""Table of the errors and times of methods along their steps."""

PAPER = ("sweep/summary.csv", "presets/summary.csv")
"""Tables of the paper's cases, with each preset as it is declared."""

EXTREME, SHAPES = "stability/stability.csv", "validate/errors.csv"
"""Tables of the cases that a setting is not chosen by, and of the shapes of the random ones."""

TABLES = (LADDER, *PAPER, EXTREME, SHAPES)
"""Tables without which there is no advice."""

SETTINGS = ["engine", "preset", "value", "wall_s", "runs", "cases", "max_error"]
"""Columns of `settings`."""


def settings(published: Path, engines: Sequence[str]) -> pd.DataFrame:
    """Return a line for each setting that was published.

    Parameters
    ----------
    published : Path
        The folder of the published tables.
    engines : sequence of str

    Returns
    -------
    DataFrame
        engine, preset; value: p dt, or the accuracy knob of an engine with steps of its own, nan
        for a step that the library has in seconds; wall_s: mean time of a case [s]; runs: how
        often each was timed at least; cases; max_error: the largest error of the peak, inf where
        an outcome is wrong or a case failed. Those of a preset from coarse to fine.
    """
    found = pd.concat([along_steps(published, engines), of_paper(published, engines)])
    # where both tables know a setting, the ladder's time is the best of several
    lines = found.groupby(SETTING, sort=False, dropna=False, as_index=False).agg(
        wall_s=("wall_s", "first"),
        runs=("runs", "first"),
        cases=("cases", "sum"),
        max_error=("max_error", "max"),
    )
    uses = [ENGINES[name].preset(preset) for name, preset in lines[SETTING[:2]].to_numpy()]
    steps = lines["value"].fillna(pd.Series(map(declared_step, uses)))
    preset = lines.groupby(SETTING[:2], sort=False).ngroup()
    return lines.iloc[np.lexsort((-steps, preset))].reset_index(drop=True)


def published_engines(published: Path) -> list[str]:
    """Return the names of the engines that were taken along their steps."""
    known = set(along_steps(published, list(ENGINES))["engine"])
    return [name for name in ENGINES if name in known]


def read_from(published: Path) -> list[str]:
    """Return the names of the published tables from which advice follows."""
    return [*TABLES, *([RANDOM] if (published / RANDOM).is_file() else [])]


def aspects(published: Path) -> tuple[float, float]:
    """Return the smallest and the largest H/B of the random cases."""
    found = pd.read_csv(published / SHAPES, usecols=["aspect"])["aspect"]
    return float(found.min()), float(found.max())


def along_steps(published: Path, engines: Sequence[str]) -> pd.DataFrame:
    """Return the settings of the ladder: every preset along its steps, both sets of cases."""
    uses = pd.DataFrame(
        [(f"{name} {use.name}", name, use.name) for name in engines for use in uses_of(name)],
        columns=["method", "engine", "preset"],
    )
    lines = joint(pd.read_csv(published / LADDER)).merge(uses, on="method")
    worst = lines["max_error"].where(lines["failed"] == 0, math.inf)
    return lines.assign(max_error=worst)[SETTINGS]


def of_paper(published: Path, engines: Sequence[str]) -> pd.DataFrame:
    """Return each preset, as it is declared, on the paper's cases."""
    lines = pd.concat([pd.read_csv(published / name) for name in PAPER], ignore_index=True)
    lines = lines[lines["figure"].astype(str) == "all"].drop_duplicates("source")
    asked = lines["source"].map(resolve)
    lines = lines[[source.engine in engines for source in asked]]
    asked = asked[lines.index]
    return lines.assign(
        engine=[source.engine for source in asked],
        preset=[source.preset for source in asked],
        value=[declared_value(source.used) for source in asked],
        max_error=lines["max_error"].where(lines["agree"] == lines["cases"], math.inf),
        wall_s=lines["wall_s"] / lines["cases"],
        runs=1,
    )[SETTINGS]


def options_at(preset: Preset, value: float) -> dict[str, Any]:
    """Return the options of a scene that set a preset to a value.

    Parameters
    ----------
    preset : Preset
    value : float
        p dt, or that of the preset's accuracy knob; nan for its own step, which needs no option.

    Returns
    -------
    dict
        For `engines.scene.Scene`.
    """
    if math.isnan(value):
        return {}
    return (
        {"settings": {preset.accuracy_knob[0]: value}} if preset.accuracy_knob else {"step": value}
    )


def declared_value(preset: Preset) -> float:
    """Return p dt, or the accuracy knob, as a preset is declared; nan for a step in seconds."""
    if preset.accuracy_knob is not None:
        return float(getattr(preset.settings, preset.accuracy_knob[0]))
    return preset.ordinary_step()


def in_words(preset: Preset, value: float) -> str:
    """Return a setting of a preset: its p dt, its accuracy knob, or the library's own step.

    Parameters
    ----------
    preset, value
        As for `options_at`.
    """
    if math.isnan(value):
        return "its own step"
    return f"{'p dt' if preset.accuracy_knob is None else preset.accuracy_knob[0]} = {value:g}"


def declared_step(preset: Preset) -> float:
    """Return what `declared_value` does; of a step in seconds, the largest p dt in the paper."""
    if math.isnan(preset.step_s):
        return declared_value(preset)
    return preset.step_s * max(case.block.p for case in sweep_cases((6,)))


def extremes(published: Path, source: str, target: float) -> dict[str, int]:
    """Count the extreme cases of a preset, as it is declared, that are off.

    Off is another outcome, a failure, or an error above the target; cases where the reference does
    not hold, or whose rocking is too small to be seen, are not counted.

    Parameters
    ----------
    published : Path
        The folder of the published tables.
    source : str
        The preset's name in them: "mujoco:fixed", or "mujoco" for the best.
    target : float
        Largest error of the peak, relative.

    Returns
    -------
    dict
        extreme_cases, the number of cases, and extreme_off, of those that are off.
    """
    table = read_table(published / EXTREME)
    mine = table[table["source"] == source]
    good = [verdict.value for verdict in ACCEPTED if verdict.value != "good"]
    mine = mine[~mine["verdict"].isin(good)]
    right = mine["outcome"] == mine["exact_outcome"]
    return {
        "extreme_cases": len(mine),
        "extreme_off": int((~right | (mine["error"].abs() > target)).sum()),
    }


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
    numbers = lines[["condition", "error"]].map(f"{{:.{DIGITS}g}}".format).astype(float)
    return lines.assign(condition=numbers["condition"], error=numbers["error"])


def _condition(compared: pd.DataFrame) -> pd.Series[float]:
    falls = compared["exact_outcome"] == "overturned"
    nearby = [
        exact_peaks(compared.assign(amplitude_g=compared["amplitude_g"] * (1.0 + sign * EDGE)))[0]
        for sign in (-1.0, 1.0)
    ]
    firm = pd.Series(np.isinf(nearby).all(axis=0), index=compared.index)
    return conditioning_of(compared).mask(falls & firm, 1.0).mask(falls & ~firm, math.inf)


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
