"""What engines as documented get right of the plane of pulses, and what they make of similarity."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd

from analytic import RigidBlock, SinePulse, simulate
from engines import ENGINES
from studies.cases.paper import PULSES
from studies.measures.presets import engine_of
from studies.measures.words import alike, listed, part
from studies.measures.wrongness import FALL, NO_ANSWER, REST, counted, kinds_of

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


def friction_needed(case: pd.Series[float]) -> float:
    """Return the friction without which the block would slide; inf if it would lift off."""
    block = RigidBlock(width=case["width_m"], height=case["aspect"] * case["width_m"])
    pulse = SinePulse(
        amplitude=case["onsets"] * math.tan(block.alpha) * block.gravity,
        omega=case["omega_over_p"] * block.p,
        half_cycles=PULSES[str(case["pulse"])],
    )
    found = simulate(block, pulse)
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
    asked = rows[(rows["source"] != "exact") & (rows["verdict"] != INVALID)]
    groups = asked.groupby(["source", "width_m"], sort=False)
    kinds = pd.DataFrame(counted(found.map(KIND)) for _, found in groups["verdict"])
    table = groups.agg(
        cases=("verdict", "size"),
        close=("verdict", lambda found: int(found.isin(RIGHT).sum())),
        far=("verdict", lambda found: int((found == OFF).sum())),
        false_overturnings=("verdict", lambda found: int((found == FALSE).sum())),
        missed_overturnings=("verdict", lambda found: int((found == MISSED).sum())),
        median_error=("error", lambda error: error.abs().median()),
        p90_error=("error", lambda error: error.abs().quantile(0.9)),
        wall_s=("wall_s", "sum"),
    )
    return pd.concat([table.reset_index(), kinds], axis=1)


def rests(rows: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each engine and rest before the pulse: how many pulses by verdict."""
    asked = rows[(rows["source"] != "exact") & (rows["verdict"] != INVALID)]
    lines = []
    for (source, rest_s), found in asked.groupby(["source", "rest_s"], sort=False):
        close = int(found["verdict"].isin(RIGHT).sum())
        lines.append(
            {"source": source, "rest_s": rest_s, "cases": len(found), "close": close}
            | counted(found["verdict"].map(KIND))
        )
    return pd.DataFrame(lines)


def rest_claim(table: pd.DataFrame) -> str:
    """Say which engines lose answers when all is at rest before a pulse; empty if none does."""
    said = []
    for source, found in table.groupby("source", sort=False):
        close = (found["close"] / found["cases"]).groupby(found["rest_s"] > 0.0).mean()
        if len(close) == 2 and close[False] - close[True] > CLOSE:
            ends = f"from {_whole(close[False])} to {_whole(close[True])}"
            said.append(f"{engine_of(str(source))} falls {ends}")
    return f"After 1 s of rest {listed(said)}." if said else ""


def first_claim(table: pd.DataFrame) -> str:
    """Say between which parts of all pulses the engines get right."""
    sums = table.groupby("source", sort=False)[["close", "cases"]].sum()
    parts = (sums["close"] / sums["cases"]).sort_values()
    ends = dict.fromkeys(
        f"{_whole(parts[name])} ({engine_of(str(name))})" for name in parts.index[[0, -1]]
    )
    return (
        f"As documented, outcome and peak (within {part(CLOSE)}) are right in "
        f"{' to '.join(ends)} of {int(sums['cases'].iloc[0])} pulses that neither slide a block "
        "nor lift it off."
    )


def _whole(value: float) -> str:
    """Return a part in whole per cent, and all of it only where it is all."""
    return "all" if value == 1.0 else f"{min(value, 0.99):.0%}".replace("%", " %")


def similarity(rows: pd.DataFrame) -> str:
    """Say in what part of the pulses the smallest and the largest block answer differently."""
    rows = rows[rows["verdict"] != INVALID]
    widths = sorted(rows["width_m"].unique())
    pair = [
        rows[rows["width_m"] == width].set_index(ALIKE)["peak_ratio"]
        for width in (widths[0], widths[-1])
    ]
    small, large = pair[0].align(pair[1], join="inner")
    both = np.isfinite(small) & np.isfinite(large)
    differ = (small != large) & ~(both & ((small - large).abs() <= CLOSE * small.abs()))
    differ &= ~(small.isna() & large.isna())
    of = differ.groupby(level="source", sort=False).mean()
    engines = of[of.index != "exact"]
    words = alike([f"{engine_of(name)} {value:.0%}" for name, value in engines.items()])
    return (
        f"By similarity a block of {widths[-1]:g} m answers as one of {widths[0]:g} m: the exact "
        f"solution does; as documented an outcome differs, or a peak by more than "
        f"{part(CLOSE)}, in {words} of the pulses.".replace("%", " %").replace("  %", " %")
    )


def findings(table: pd.DataFrame, rows: pd.DataFrame) -> str:
    """Return the claims and the table as text."""
    shown = table.assign(
        median_error=table["median_error"].map(part), p90_error=table["p90_error"].map(part)
    )
    claims = filter(None, (first_claim(table), rest_claim(rests(rows)), similarity(rows)))
    return f"{' '.join(claims)}\n\n{shown.to_string(index=False)}"
