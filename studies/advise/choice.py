"""The cheapest published setting that keeps an error."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from analytic.block import RigidBlock
from engines import ENGINES
from engines.declaration import Preset
from studies.advise.evidence import declared_value, extremes, in_words, settings
from studies.advise.tried import COUNTS, counted, random_runs
from studies.kit.journal import Row
from studies.measures.differences import WELL_CONDITIONED
from studies.measures.finer import with_every_finer
from studies.measures.presets import uses_of
from studies.measures.words import out_of, part

TARGETS = (0.1, 1e-2, 1e-3, 1e-4)
"""Errors that somebody may ask for."""

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
    settled, runs = settings(published, engines), random_runs(published)
    rows: list[Row] = []
    for target in targets:
        known = counted(settled, runs, target)
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
    for preset in uses_of(engine):
        mine = known[known["preset"] == preset.name]
        best = cheapest(mine, target)
        yield {
            "target": target,
            "engine": engine,
            "preset": preset.name,
            **_chosen(best, preset, block),
            **_extreme(published, best, engine, preset, target),
            "message": _message(mine, preset, target),
        }


def _extreme(
    published: Path, best: pd.Series[Any] | None, engine: str, preset: Preset, target: float
) -> dict[str, int]:
    """Count extreme cases where they were run with the very setting that is advised."""
    if best is None or not np.array_equal(best["value"], declared_value(preset), equal_nan=True):
        return {"extreme_cases": 0, "extreme_off": 0}
    source = engine if preset is ENGINES[engine].best else f"{engine}:{preset.name}"
    return extremes(published, source, target)


def _chosen(best: pd.Series[Any] | None, preset: Preset, block: RigidBlock) -> Row:
    if best is None:
        nothing = ("value", "dt_s", "wall_s", "max_error")
        none = dict.fromkeys(("runs", "cases", *COUNTS), 0)
        return {**dict.fromkeys(nothing, math.nan), "driver": "", **none}
    value = float(best["value"])
    own = math.nan if preset.dial else preset.step_s
    return {
        "value": value,
        "dt_s": own if preset.dial or math.isnan(value) else value / block.p,
        "wall_s": float(best["wall_s"]),
        "max_error": float(best["max_error"]),
        "driver": str(best["driver"]),
        **{name: int(best[name]) for name in ("runs", "cases", *COUNTS)},
    }


def cheapest(known: pd.DataFrame, target: float) -> pd.Series[Any] | None:
    """Return the cheapest setting of a preset that keeps an error; None where there is none.

    Parameters
    ----------
    known : DataFrame
        The settings of a preset from coarse to fine, with the columns of `counted`. One counts if
        it keeps the error with every finer one: a coarse step may be lucky.
    target : float
    """
    good = known[with_every_finer(_alone(known, target))]
    return None if good.empty else good.sort_values("wall_s").iloc[0]


def _alone(known: pd.DataFrame, target: float) -> pd.Series[bool]:
    """Say which settings keep an error by themselves, whatever finer ones do."""
    return (known["max_error"] <= target) & (known["random_calm_off"] == 0)


def _message(known: pd.DataFrame, preset: Preset, target: float) -> str:
    """Say that nothing keeps the error, and why."""
    if known.empty:
        return f"{NOTHING}: not in the published tables"
    if cheapest(known, target) is not None:
        return ""
    alone = _alone(known, target)
    if alone.any():
        lucky = in_words(preset, float(known.loc[alone, "value"].iloc[-1]))
        return f"{NOTHING}: {lucky} would, but {_missed(known[~alone].iloc[-1], preset, target)}"
    best = known.sort_values("max_error").iloc[0]
    if not math.isfinite(best["max_error"]):
        return f"{NOTHING}: outcomes are wrong at every step"
    return f"{NOTHING}: at best {_missed(best, preset, target)}"


def _missed(line: pd.Series[Any], preset: Preset, target: float) -> str:
    """Say what a setting misses: on the published cases, or else on random ones."""
    at, error = in_words(preset, float(line["value"])), float(line["max_error"])
    if math.isinf(error):
        return f"an outcome is wrong at {at}"
    if error > target:
        return f"{part(error)} at {at}"
    return random_text(line, f"at {at}")


def random_text(line: pd.Series[Any], where: str = "at this step") -> str:
    """Return how many random cases are off, and of those with a small κ; empty where none ran."""
    if not line["random_cases"]:
        return ""
    off = f"{out_of(line['random_off'], line['random_cases'])} random cases are off {where}"
    calm = f" ({line['random_calm_off'] or 'none'} of them with κ < {WELL_CONDITIONED:g})"
    return off + calm if line["random_off"] else off
