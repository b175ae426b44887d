"""What engines as documented get right of the plane of pulses, and what they make of similarity."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from analytic import RigidBlock, SinePulse, simulate
from engines import ENGINES
from studies.cases.paper import PULSES
from studies.drawing.styles import engine_title
from studies.measures.words import listed, part
from studies.measures.wrongness import FALL, KINDS, NO_ANSWER, REST, kinds_of

if TYPE_CHECKING:
    from pandas.core.groupby import DataFrameGroupBy

CLOSE = 0.1
"""A peak within this part of the exact one is close."""
CASE = ["pulse", "aspect", "width_m", "onsets", "omega_over_p", "rest_s"]
ALIKE = ["pulse", "aspect", "onsets", "omega_over_p", "source"]
"""Columns that similarity lets answers depend on."""

RIGHT = ("both rock", "both overturn")
OFF, FALSE, MISSED = "peak off", "false overturning", "missed overturning"
KIND = {FALSE: FALL, MISSED: FALL, REST: REST, NO_ANSWER: NO_ANSWER}
"""Verdict on a wrong outcome -> its kind; a fall that is wrong has two sides."""
INVALID = "invalid"
"""Where the block should slide or lift off, which the reference does not."""


def with_verdicts(rows: pd.DataFrame) -> pd.DataFrame:
    """Return rows with the exact peak of each case, the relative error and a verdict."""
    exact = rows[rows["source"] == "exact"].set_index(CASE)[["outcome", "peak_ratio"]]
    needed = exact.index.to_frame(index=False).apply(friction_needed, axis=1).to_numpy()
    right = exact.assign(needed=needed).reindex(pd.MultiIndex.from_frame(rows[CASE]))
    found, over = rows["outcome"].to_numpy(), right["outcome"].to_numpy() == "overturned"
    with np.errstate(invalid="ignore"):
        error = rows["peak_ratio"].to_numpy() / right["peak_ratio"].to_numpy() - 1.0
    wrong = kinds_of(found, right["outcome"].to_numpy())
    verdict = np.select(
        [
            right["needed"].to_numpy() > rows["source"].map(friction_of).to_numpy(),
            wrong == NO_ANSWER,
            wrong == REST,
            (wrong == FALL) & over,
            wrong == FALL,
            over,
            np.abs(error) > CLOSE,
        ],
        [INVALID, NO_ANSWER, REST, MISSED, FALSE, RIGHT[1], OFF],
        RIGHT[0],
    )
    both_rocked = (wrong == "") & ~over
    return rows.assign(error=np.where(both_rocked, error, np.nan), verdict=verdict)


def posed(
    pulse: str, aspect: float, width_m: float, onsets: float, omega_over_p: float
) -> tuple[RigidBlock, SinePulse]:
    """Return the block and the pulse of a case, whose amplitude is so many times g tan α."""
    block = RigidBlock(width=width_m, height=aspect * width_m)
    return block, SinePulse(
        amplitude=onsets * math.tan(block.alpha) * block.gravity,
        omega=omega_over_p * block.p,
        half_cycles=PULSES[pulse],
    )


def friction_needed(case: pd.Series[Any]) -> float:
    """Return the friction without which the block would slide; inf if it would lift off."""
    found = simulate(*posed(*case[CASE[:-1]]))
    return found.friction_needed if found.min_normal > 0.0 else math.inf


def friction_of(source: str) -> float:
    """Return the friction of an engine's preset; that of a model is without bound."""
    engine, _, preset = source.partition(":")
    if engine not in ENGINES:
        return math.inf
    return float(ENGINES[engine].preset(preset or None).settings.friction)


def shares(rows: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each engine and width: how many pulses by verdict, and errors.

    Of pulses under which the block neither slides nor lifts off.
    """
    return (
        _judged(rows, "width_m")
        .agg(
            cases=("close", "size"),
            **_sums("close", "far", "false_overturnings", "missed_overturnings"),
            median_error=("size", "median"),
            p90_error=("size", lambda size: size.quantile(0.9)),
            **_sums("wall_s", *KINDS),
        )
        .reset_index()
    )


def rests(rows: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each engine and rest before the pulse: how many pulses by verdict."""
    counts = _judged(rows, "rest_s").agg(cases=("close", "size"), **_sums("close", *KINDS))
    return counts.reset_index()


def _judged(rows: pd.DataFrame, by: str) -> DataFrameGroupBy[Any, Any]:
    """Return the engines' rows that are judged, their verdicts as columns, by source and `by`."""
    rows = rows[(rows["source"] != "exact") & (rows["verdict"] != INVALID)]
    verdict = rows["verdict"]
    judged = rows.assign(
        close=verdict.isin(RIGHT),
        far=verdict == OFF,
        false_overturnings=verdict == FALSE,
        missed_overturnings=verdict == MISSED,
        size=rows["error"].abs(),
        **{kind: verdict.map(KIND) == kind for kind in KINDS},
    )
    return judged.groupby(["source", by], sort=False)


def _sums(*names: str) -> dict[str, tuple[str, str]]:
    return {name: (name, "sum") for name in names}


def rest_claim(table: pd.DataFrame) -> str:
    """Say which engines lose answers when all is at rest before a pulse; empty if none does."""
    said = []
    for source, found in table.groupby("source", sort=False):
        close = (found["close"] / found["cases"]).groupby(found["rest_s"] > 0.0).mean()
        if len(close) == 2 and close[False] - close[True] > CLOSE:
            ends = f"from {_whole(close[False])} to {_whole(close[True])}"
            said.append(f"{engine_title(str(source))} falls {ends}")
    return f"After 1 s of rest {listed(said)}." if said else ""


def first_claim(table: pd.DataFrame) -> str:
    """Say between which parts of all pulses the engines get right."""
    sums = table.groupby("source", sort=False)[["close", "cases"]].sum()
    parts = (sums["close"] / sums["cases"]).sort_values()
    ends = dict.fromkeys(
        f"{_whole(parts[name])} ({engine_title(str(name))})" for name in parts.index[[0, -1]]
    )
    return (
        f"As documented, outcome and peak (within {part(CLOSE)}) are right in "
        f"{' to '.join(ends)} of {int(sums['cases'].iloc[0])} pulses that neither slide a block "
        "nor lift it off."
    )


def _whole(value: float) -> str:
    """Return a part in whole per cent, and all of it only where it is all."""
    return "all" if value == 1.0 else f"{min(value, 0.99):.0%}".replace("%", " %")


def similarity(rows: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each source: the part of pulses in which two blocks answer differently.

    The smallest and the largest, which by similarity answer alike; outcomes differ, or peaks by
    more than CLOSE.
    """
    rows = rows[rows["verdict"] != INVALID]
    widths = rows["width_m"]
    pair = [
        rows[widths == width].set_index(ALIKE)["peak_ratio"]
        for width in (widths.min(), widths.max())
    ]
    small, large = pair[0].align(pair[1], join="inner")
    both = np.isfinite(small) & np.isfinite(large)
    differ = (small != large) & ~(both & ((small - large).abs() <= CLOSE * small.abs()))
    differ &= ~(small.isna() & large.isna())
    parts = differ.groupby(level="source", sort=False).mean()
    return pd.DataFrame({"source": parts.index, "differ": parts.to_numpy()})
