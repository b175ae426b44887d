"""The cheapest published setting that keeps an error."""

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from analytic.block import RigidBlock
from engines import ENGINES
from engines.declaration import Preset
from studies.advise.evidence import (
    declared_step,
    declared_value,
    elsewhere,
    in_words,
    settings,
)
from studies.kit.journal import Row
from studies.measures.words import part

NOTHING = "nothing does"
"""What is said of a preset without a setting that keeps the error."""


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
    known = settings(published, engines)
    rows: list[Row] = []
    for target in targets:
        for engine in engines:
            mine = known[known["engine"] == engine]
            lines = list(_of_engine(published, mine, engine, target, block))
            times = [line["wall_s"] for line in lines if not line["message"]]
            for line in lines:
                line["cheapest"] = bool(times) and line["wall_s"] == min(times)
            rows += lines
    return pd.DataFrame(rows)


def _of_engine(
    published: Path, known: pd.DataFrame, engine: str, target: float, block: RigidBlock
) -> Iterator[Row]:
    for preset in ENGINES[engine].presets:
        mine = known[known["preset"] == preset.name]
        yield {
            "target": target,
            "engine": engine,
            "preset": preset.name,
            **_chosen(mine, preset, target, block),
            **elsewhere(published, _source(engine, preset), target),
            "message": _message(mine, preset, target),
        }


def _source(engine: str, preset: Preset) -> str:
    """Return the name under which the published tables know a preset."""
    return engine if preset is ENGINES[engine].best else f"{engine}:{preset.name}"


def _chosen(known: pd.DataFrame, preset: Preset, target: float, block: RigidBlock) -> Row:
    best = cheapest(known, preset, target)
    if best is None:
        nothing = ("value", "dt_s", "wall_s", "max_error")
        return {**dict.fromkeys(nothing, math.nan), "cases": 0}
    value = float(best["value"])
    own = math.nan if preset.dial else preset.step_s
    return {
        "value": value,
        "dt_s": own if preset.dial or math.isnan(value) else value / block.p,
        "wall_s": float(best["wall_s"]),
        "max_error": float(best["max_error"]),
        "cases": int(best["cases"]),
    }


def cheapest(known: pd.DataFrame, preset: Preset, target: float) -> "pd.Series[Any] | None":
    """Return the cheapest setting of a preset that keeps an error; None where there is none.

    A step is not trusted on few cases where the preset, as it is declared and finer, was asked
    many more and misses.
    """
    good = known[(known["max_error"] <= target) & ~_refuted(known, preset, target)]
    return None if good.empty else good.sort_values("wall_s").iloc[0]


def _refuted(known: pd.DataFrame, preset: Preset, target: float) -> "pd.Series[bool]":
    value = declared_value(preset)
    declared = known["value"].isna() if math.isnan(value) else known["value"] == value
    misses = bool((known.loc[declared, "max_error"] > target).any())
    return (known["value"] > declared_step(preset)) & misses


def _message(known: pd.DataFrame, preset: Preset, target: float) -> str:
    """Say that nothing keeps the error, and what comes nearest."""
    if known.empty:
        return f"{NOTHING}: not in the published tables"
    if cheapest(known, preset, target) is not None:
        return ""
    best = known.sort_values("max_error").iloc[0]
    if not math.isfinite(best["max_error"]):
        return f"{NOTHING}: outcomes are wrong at every step"
    at = in_words(preset, float(best["value"]))
    return f"{NOTHING}: {part(float(best['max_error']))} at best, at {at}"
