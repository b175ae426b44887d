"""Lines of the page: what is measured by default, with one setting, and with all of them."""

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from engines import ENGINES
from engines.factors import BEST, DEFAULT, MOVING_BASE
from studies.kit.journal import Row
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
from studies.symptoms.words import changed

VARIANTS, LADDER = "contact/variants.csv", "precision/work-precision.csv"
BOUNCES = "restitution/kept.csv"
TABLES = (VARIANTS, LADDER, BOUNCES)
"""The tables that are read."""

HELPS = 0.5
"""A setting helps if it leaves no more than this part of what there is by default."""


def lines_of(published: Path, engines: Sequence[str]) -> pd.DataFrame:
    """Return a line for each symptom and engine of the published tables.

    Parameters
    ----------
    published : Path
        The folder of the published tables.
    engines : sequence of str

    Returns
    -------
    DataFrame
        The columns of symptoms.csv.
    """
    words = dict.fromkeys(("factor", "level", "trap", "message"), str)
    table = pd.read_csv(published / VARIANTS, keep_default_na=False, na_values=["nan"], dtype=words)
    ladder, bounces = (pd.read_csv(published / name) for name in (LADDER, BOUNCES))
    rows: list[Row] = []
    for engine in engines:
        mine = table[table["engine"] == engine]
        if len(mine):
            rows += [_measured(mine, engine, symptom) for symptom in SYMPTOMS]
            rows += [*_unmoved(mine, engine), *_hull(mine, engine), *_stepped(ladder, engine)]
            rows += _bouncing(bounces, engine)
    order = [*(symptom.name for symptom in SYMPTOMS), *THREADS]
    ordered = [row for name in order for row in rows if row["symptom"] == name]
    return pd.DataFrame(ordered)


def _row(symptom: str, engine: str, column: str, **values: Any) -> Row:
    threads = THREADS.get(symptom) or next(s.threads for s in SYMPTOMS if s.name == symptom)
    nothing = {"setting": "", "literal": "", "after": math.nan}
    return {
        "symptom": symptom,
        "engine": engine,
        "measure": column,
        "shown_by": "the library's defaults",
        "before": math.nan,
        **nothing,
        "tuned": math.nan,
        "landing": math.nan,
        **values,
        "asked_in": ", ".join(threads),
        "command": f"rocking {STUDIES.get(symptom, 'contact')} --engines {engine} --out DIR",
    }


def _measured(mine: pd.DataFrame, engine: str, symptom: Symptom) -> Row:
    """Return what a symptom measures by default, and the one setting that helps most."""
    base = {name: _preset(mine, name, symptom.column) for name in (DEFAULT, BEST, "landing")}
    values = {"before": base[DEFAULT], "tuned": base[BEST], "landing": base["landing"]}
    best = _best_single(mine, symptom)
    most = HELPS * _size(base[DEFAULT])
    if best is None or not most or not _size(best[symptom.column]) <= most:
        return _row(symptom.name, engine, symptom.column, **values)
    return _row(
        symptom.name,
        engine,
        symptom.column,
        **values,
        setting=_name(best),
        literal=changed(engine, DEFAULT, str(best["factor"]), str(best["level"])),
        after=float(best[symptom.column]),
    )


def _best_single(mine: pd.DataFrame, symptom: Symptom) -> "pd.Series[Any] | None":
    """Return the one setting changed from the defaults that leaves least, and breaks nothing."""
    tried = mine[(mine["preset"] == DEFAULT) & (mine["factor"] != "") & (mine["factor"] != "step")]
    tried = tried[(tried["failed"] == 0) & ~tried["worse"]]
    if tried.empty:
        return None
    return tried.iloc[int(tried[symptom.column].abs().argmin())]


def _preset(mine: pd.DataFrame, name: str, column: str) -> float:
    found = mine[(mine["preset"] == name) & (mine["factor"] == "")]
    return math.nan if found.empty else float(found.iloc[0][column])


def _size(value: float) -> float:
    return abs(float(value))


def _name(line: "pd.Series[Any]") -> str:
    return f"{line['factor']}: {line['level']}"


def _unmoved(mine: pd.DataFrame, engine: str) -> Iterator[Row]:
    """Yield what a base that moves by position alone does, and one with its velocity."""
    asked = mine[mine["factor"] == MOVING_BASE.name]
    levels = {str(line["level"]): line for _, line in asked.iterrows()}
    names = [level.name for level in MOVING_BASE.levels]
    if set(names) <= set(levels):
        right, wrong = (levels[name] for name in names)
        yield _row(
            UNMOVED,
            engine,
            "max_error",
            shown_by=f"{MOVING_BASE.name}: {names[1]}",
            before=_error(wrong),
            setting=f"{MOVING_BASE.name}: {names[0]}",
            after=_error(right),
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
            before=_error(worst),
            setting="a box instead",
            after=_preset(mine, DEFAULT, "max_error"),
            tuned=_preset(mine, BEST, "max_error"),
            landing=_preset(mine, "landing", "max_error"),
        )


def _error(line: "pd.Series[Any]") -> float:
    """Return the largest error of a variant, inf where cases fail."""
    return math.inf if line["failed"] else float(line["max_error"])


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


def _bouncing(bounces: pd.DataFrame, engine: str) -> Iterator[Row]:
    """Yield how far off a dropped sphere is, asked in the first way and in the best."""
    mine = bounces[bounces["engine"] == engine]
    if len(mine):
        first, best = mine.iloc[0], mine.iloc[int(mine["off"].argmin())]
        yield _row(
            BOUNCE,
            engine,
            "off",
            shown_by=f'"{first["way"]}"',
            before=float(first["off"]),
            setting=f'"{best["way"]}"',
            literal=f"for 0.6: {best['literal']}",
            after=float(best["off"]),
        )
