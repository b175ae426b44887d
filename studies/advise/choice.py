"""The cheapest published setting that keeps an error."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from analytic.block import RigidBlock
from engines import ENGINES
from engines.declaration import Preset
from studies.advise.evidence import (
    COUNTS,
    counted,
    declared_value,
    extremes,
    in_words,
    random_runs,
    settings,
)
from studies.old.journal import Row
from studies.measures.differences import WELL_CONDITIONED
from studies.measures.finer import cheapest_kept
from studies.measures.presets import uses_of
from studies.measures.words import out_of, part

TARGETS = (0.1, 1e-2, 1e-3, 1e-4)
"""Errors that somebody may ask for."""

NOTHING = "nothing does"
"""What is said of a preset without a setting that keeps the error."""

NONE_FOUND: Row = {
    **dict.fromkeys(("value", "dt_s", "wall_s", "max_error"), math.nan),
    **dict.fromkeys(("runs", "cases", *COUNTS, "extreme_cases", "extreme_off"), 0),
}
"""Columns of advice about a setting, where there is none."""


def advice(
    published: Path, engines: Sequence[str], targets: Sequence[float], block: RigidBlock
) -> pd.DataFrame:
    """Return a line for each error, engine and preset: the cheapest setting that keeps it.

    Parameters
    ----------
    published : Path
        The folder of the published tables.
    engines : sequence of str
    targets : sequence of float
        Largest errors of the peak, relative.
    block : RigidBlock
        For which the step is given in seconds.

    Returns
    -------
    DataFrame
        The columns of advice.csv.
    """
    settled, runs = settings(published, engines), random_runs(published)
    rows: list[Row] = []
    for target in targets:
        known = counted(settled, runs, target)
        for engine, preset in ((name, preset) for name in engines for preset in uses_of(name)):
            mine = known[(known["engine"] == engine) & (known["preset"] == preset.name)]
            best = cheapest(mine, target)
            found = {} if best is None else _found(published, best, preset, target, block)
            message = "" if found else _message(mine, preset, target)
            use = {"target": target, "engine": engine, "preset": preset.name}
            rows.append({**use, **NONE_FOUND, **found, "message": message})
    lines = pd.DataFrame(rows)
    least = lines.groupby(["target", "engine"])["wall_s"].transform("min")
    return lines.assign(cheapest=lines["wall_s"] == least)


def _found(
    published: Path, best: pd.Series[Any], preset: Preset, target: float, block: RigidBlock
) -> Row:
    """Return the columns of a setting that keeps an error.

    Extreme cases are counted where they were run with the very setting that is advised.
    """
    engine, value = str(best["engine"]), float(best["value"])
    own = math.nan if preset.accuracy_knob else preset.step_s
    found = {name: best[name] for name in NONE_FOUND if name in best}
    found["dt_s"] = own if preset.accuracy_knob or math.isnan(value) else value / block.p
    if np.array_equal(value, declared_value(preset), equal_nan=True):
        source = engine if preset is ENGINES[engine].best else f"{engine}:{preset.name}"
        found |= extremes(published, source, target)
    return found


def cheapest(known: pd.DataFrame, target: float) -> pd.Series[Any] | None:
    """Return the cheapest setting of a preset that keeps an error; None where there is none.

    Parameters
    ----------
    known : DataFrame
        The settings of a preset from coarse to fine, with the columns of `counted`. One counts if
        it keeps the error with every finer one: a coarse step may be lucky.
    target : float
    """
    return cheapest_kept(known, _alone(known, target))


def _alone(known: pd.DataFrame, target: float) -> pd.Series[bool]:
    """Say which settings keep an error by themselves, whatever finer ones do."""
    return (known["max_error"] <= target) & (known["random_calm_off"] == 0)


def _message(known: pd.DataFrame, preset: Preset, target: float) -> str:
    if known.empty:
        return f"{NOTHING}: not in the published tables"
    alone = _alone(known, target)
    if alone.any():
        lucky = in_words(preset, float(known.loc[alone, "value"].iloc[-1]))
        return f"{NOTHING}: {lucky} would, but {_missed(known[~alone].iloc[-1], preset, target)}"
    best = known.sort_values("max_error").iloc[0]
    if not math.isfinite(best["max_error"]):
        return f"{NOTHING}: outcomes are wrong at every step"
    return f"{NOTHING}; the closest: {_missed(best, preset, target)}"


def _missed(line: pd.Series[Any], preset: Preset, target: float) -> str:
    """Say what a setting misses: on the published cases, or else on random ones."""
    at, error = in_words(preset, float(line["value"])), float(line["max_error"])
    if math.isinf(error):
        return f"an outcome is wrong at {at}"
    if error > target:
        return f"{part(error)} at {at}"
    off, calm = out_of(line["random_off"], line["random_cases"]), line["random_calm_off"]
    return f"{off} random cases are off at {at} ({calm} of them with κ < {WELL_CONDITIONED:g})"
