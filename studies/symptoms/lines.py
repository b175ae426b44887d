"""Lines of the page: what is measured by default, with one setting, and with all of them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import pandas as pd

from engines import ENGINES
from engines.parts.factors import BEST, DEFAULT, MOVING_BASE, OWN_STEPS
from studies.kit.journal import Row
from studies.kit.tables import read_table
from studies.measures.formulas import at_step, by_step
from studies.symptoms.patch import own_step_s, patch
from studies.symptoms.seen import (
    BOUNCE,
    HULL,
    STEP,
    STUDIES,
    SYMPTOMS,
    THREADS,
    UNMOVED,
    Symptom,
)

VARIANTS, OWN = "contact/variants.csv", "contact/own-steps.csv"
LADDER, BOUNCES = "precision/work-precision.csv", "restitution/corners.csv"
TABLES = (VARIANTS, OWN, LADDER, BOUNCES)
"""The tables that are read."""

QUOTED_E = 0.6
"""The coefficient of restitution for which that table quotes settings."""

HELPS = 0.5
"""A setting helps if it leaves no more than this part of what there is by default, both at the
p dt of all and at the library's own step."""


def lines_of(
    published: Path,
    engines: Sequence[str],
    dt_s: float | None = None,
    friction: float | None = None,
) -> pd.DataFrame:
    """Return a line for each symptom and engine of the published tables.

    Parameters
    ----------
    published : Path
        The folder of the published tables.
    engines : sequence of str
    dt_s : float, optional
        Step [s] for which settings are written out; by default the library's own.
    friction : float, optional
        With which they are written out; by default the library's own.

    Returns
    -------
    DataFrame
        The columns of symptoms.csv.
    """
    table, own = (
        read_table(published / name, "factor", "level", "trap") for name in (VARIANTS, OWN)
    )
    ladder, bounces = (pd.read_csv(published / name) for name in (LADDER, BOUNCES))
    rows: list[Row] = []
    for engine in engines:
        mine = table[table["engine"] == engine]
        if len(mine):
            dt = dt_s or own_step_s(engine)
            at_own = own[own["engine"] == engine]
            rows += [_measured(mine, at_own, engine, symptom, dt, friction) for symptom in SYMPTOMS]
            rows += [*_unmoved(mine, engine), *_hull(mine, engine), *_stepped(ladder, engine)]
            rows += _bouncing(bounces, engine, dt)
    order = [*(symptom.name for symptom in SYMPTOMS), *THREADS]
    ordered = [row for name in order for row in rows if row["symptom"] == name]
    return pd.DataFrame(ordered)


def _row(symptom: str, engine: str, column: str, **values: Any) -> Row:
    threads = THREADS.get(symptom) or next(s.threads for s in SYMPTOMS if s.name == symptom)
    nothing = {"setting": "", "formula": "", "dt_s": math.nan, "literal": "", "after": math.nan}
    return {
        "symptom": symptom,
        "engine": engine,
        "measure": column,
        "shown_by": "the library's defaults",
        "before": math.nan,
        **nothing,
        "tuned": math.nan,
        "landing": math.nan,
        "before_own": math.nan,
        "after_own": math.nan,
        **values,
        "asked_in": ", ".join(threads),
        "command": f"rocking {STUDIES.get(symptom, 'contact')} --engines {engine} --out DIR",
    }


def _measured(
    mine: pd.DataFrame,
    own: pd.DataFrame,
    engine: str,
    symptom: Symptom,
    dt_s: float,
    friction: float | None,
) -> Row:
    """Return what a symptom measures by default, and the one setting that helps most."""
    column = symptom.column
    base = {name: _preset(mine, name, column) for name in (DEFAULT, BEST, "landing")}
    values = {"before": base[DEFAULT], "tuned": base[BEST], "landing": base["landing"]}
    values["before_own"] = _preset(own, DEFAULT, column)
    mends = _helping(mine, column).merge(
        _helping(own, column), on=["factor", "level"], suffixes=("", "_own")
    )
    if mends.empty:
        return _row(symptom.name, engine, column, **values)
    best = mends.iloc[int(mends[column].abs().argmin())]
    factor, level = str(best["factor"]), str(best["level"])
    changes = partial(patch, engine, factor, level, friction=friction)
    return _row(
        symptom.name,
        engine,
        column,
        **values,
        setting=f"{factor}: {level}",
        formula=by_step(changes),
        dt_s=dt_s,
        literal=changes(dt_s),
        after=float(best[column]),
        after_own=float(best[f"{column}_own"]),
    )


def _helping(mine: pd.DataFrame, column: str) -> pd.DataFrame:
    """Return the single settings that halve, from the defaults, what there is, and break nothing.

    Whatever defaults that fail leave is halved by a setting that does not fail.
    """
    usual = mine[(mine["preset"] == DEFAULT) & (mine["factor"] == "")].iloc[0]
    most = math.inf if usual["failed"] else HELPS * abs(float(usual[column]))
    tried = mine[(mine["preset"] == DEFAULT) & (mine["factor"] != "")]
    tried = tried[(tried["factor"] != OWN_STEPS) & (tried["failed"] == 0) & ~tried["worse"]]
    return tried[(tried[column].abs() <= most) & (most > 0.0)][["factor", "level", column]]


def _preset(mine: pd.DataFrame, name: str, column: str) -> float:
    """Return a measure of a preset as it is; inf where cases fail, nan where there is none."""
    found = mine[(mine["preset"] == name) & (mine["factor"] == "")]
    return math.nan if found.empty else _value(found.iloc[0], column)


def _unmoved(mine: pd.DataFrame, engine: str) -> Iterator[Row]:
    """Yield what a base that moves by position alone does, and one with its velocity."""
    asked = mine[mine["factor"] == MOVING_BASE]
    levels = {str(line["level"]): line for _, line in asked.iterrows()}
    factors = [factor for factor in ENGINES[engine].factors if factor.name == MOVING_BASE]
    names = [level.name for factor in factors for level in (factor.levels[0], factor.levels[-1])]
    if names and set(names) <= set(levels):
        right, wrong = (levels[name] for name in names)
        yield _row(
            UNMOVED,
            engine,
            "max_error",
            shown_by=f"{MOVING_BASE}: {names[1]}",
            before=_value(wrong),
            setting=f"{MOVING_BASE}: {names[0]}",
            after=_value(right),
            tuned=_preset(mine, BEST, "max_error"),
            landing=_preset(mine, "landing", "max_error"),
        )


def _hull(mine: pd.DataFrame, engine: str) -> Iterator[Row]:
    """Yield the largest error of a hull, and of the box of the defaults."""
    hulls = {
        level.name
        for factor in ENGINES[engine].factors
        for level in factor.levels
        if level.settings.get("geometry") == "hull"
    }
    found = mine[(mine["preset"] == DEFAULT) & mine["level"].isin(hulls)]
    if len(found):
        worst = found.iloc[int(found["max_error"].argmax())]
        yield _row(
            HULL,
            engine,
            "max_error",
            shown_by=f"the library's defaults, {worst['level']}",
            before=_value(worst),
            setting="a box instead",
            after=_preset(mine, DEFAULT, "max_error"),
            tuned=_preset(mine, BEST, "max_error"),
            landing=_preset(mine, "landing", "max_error"),
        )


def _value(line: pd.Series[Any], column: str = "max_error") -> float:
    """Return a measure of a variant, inf where cases fail."""
    return math.inf if line["failed"] else float(line[column])


def _stepped(ladder: pd.DataFrame, engine: str) -> Iterator[Row]:
    """Yield the largest error that is left at the finest step of each preset."""
    left = {}
    for preset in ENGINES[engine].presets:
        mine = ladder[
            (ladder["method"] == f"{engine} {preset.name}") & (ladder["set"] == "typical")
        ]
        if len(mine):
            finest = mine.iloc[int(mine["value"].argmin())]
            left[preset.name] = float(finest["max_error"])
    if DEFAULT in left and BEST in left:
        yield _row(
            STEP,
            engine,
            "max_error",
            before=left[DEFAULT],
            shown_by="the library's defaults at the finest step",
            setting="a tuned contact at the same step",
            after=left[BEST],
            tuned=left[BEST],
            landing=left.get("landing", math.nan),
        )


def _bouncing(bounces: pd.DataFrame, engine: str, dt_s: float) -> Iterator[Row]:
    """Yield how far off a coefficient comes out, asked in the first way and in the best."""
    mine = bounces[bounces["engine"] == engine]
    if len(mine):
        first, best = mine.iloc[0], mine.iloc[int(mine["off_over_all"].argmin())]
        yield _row(
            BOUNCE,
            engine,
            "off_over_all",
            shown_by=f'"{first["way"]}"',
            before=float(first["off_over_all"]),
            setting=f'"{best["way"]}"',
            formula=f"for {QUOTED_E:g}: {best['literal']}",
            dt_s=dt_s,
            literal=f"for {QUOTED_E:g}: {at_step(best['literal'], dt_s)}",
            after=float(best["off_over_all"]),
        )
