"""What users of an engine see: by default, with one setting, with all; and the patch between."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from difflib import SequenceMatcher
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

from analytic.block import RigidBlock
from analytic.motion import SinePulse
from engines import ENGINES, Scene
from engines.parts.factors import BEST, DEFAULT, MOVING_BASE, OWN_STEPS
from engines.parts.script import Script
from studies.cases.variants import variants
from studies.old.journal import Row
from studies.old.tables import read_table
from studies.measures.formulas import at_step, by_step

BLOCK = RigidBlock(width=0.5, height=1.5)
"""The block of the lines."""

SCRIPT = "block.py"
"""File of an exported scene that has the calls of a library."""

FILE, GOES, COMES, STAYS = "@@ ", "- ", "+ ", "  "
"""How a line begins: the name of a file, then its lines."""

GIVEN = re.compile(r"\w+=(?:\"[^\"]*\"|\[[^\]]*\]|\([^)]*\)|[^,()\s]+)")
"""A named value in a call of Python, or in a model."""


def own_step_s(engine: str) -> float:
    """Return the step [s] of an engine's defaults."""
    return ENGINES[engine].preset(DEFAULT).ordinary_step_s(_scene({}))


def patch(
    engine: str, factor: str, level: str, dt_s: float, *, friction: float | None = None
) -> str:
    """Return what a variant of the defaults changes in the script that `rocking export` writes.

    Parameters
    ----------
    engine, factor, level : str
    dt_s : float
        Step of the script [s].
    friction : float, optional
        By default the library's own.

    Returns
    -------
    str
        Of each place the name of the file, lines that go or stay, and lines that come after them;
        empty for an engine that writes no scripts.
    """
    script = ENGINES[engine].script
    if script is None:
        return ""
    settings = next(
        v.settings
        for v in variants(engine)
        if (v.preset, v.factor, v.level) == (DEFAULT, factor, level)
    )
    usual = ENGINES[engine].preset(DEFAULT)
    scenes = [usual.posed(_scene(said, friction)) for said in ({}, settings)]
    before, after = (_files(script(each, usual.chosen(each), dt_s)) for each in scenes)
    return "\n".join(line for name in after for line in _places(name, before[name], after[name]))


def named(changes: str) -> str:
    """Return the named values that come with a patch, and do not go with it."""
    lines = [(line[:2], GIVEN.findall(line)) for line in changes.splitlines()]
    gone = {word for mark, words in lines if mark != COMES for word in words}
    come = dict.fromkeys(word for mark, words in lines if mark == COMES for word in words)
    return ", ".join(word for word in come if word not in gone)


def _scene(settings: Mapping[str, Any], friction: float | None = None) -> Scene:
    motion = SinePulse(amplitude=1.0, omega=1.0)
    return Scene(system=BLOCK, motion=motion, preset=DEFAULT, settings=settings, friction=friction)


def _files(script: Script) -> dict[str, list[str]]:
    inner = [f"    {line}" for line in (*script.step, *script.pose)]
    texts = {SCRIPT: "\n".join((*script.imports, *script.build, *inner)), **script.files}
    return {name: text.splitlines() for name, text in texts.items()}


def _places(name: str, before: Sequence[str], after: Sequence[str]) -> Iterator[str]:
    """Yield each place where lines differ, after as many that stay as tell it from all others."""
    for tag, i, j, k, m in SequenceMatcher(None, before, after, autojunk=False).get_opcodes():
        if tag != "equal":
            yield f"{FILE}{name}"
            yield from (f"{STAYS}{line}" for line in before[_told_apart(before, i, j) : i])
            yield from (f"{GOES}{line}" for line in before[i:j])
            yield from (f"{COMES}{line}" for line in after[k:m])


def _told_apart(lines: Sequence[str], i: int, j: int) -> int:
    """Return the largest k up to i from which lines up to j are there only once."""
    for k in range(i, 0, -1):
        text = lines[k:j]
        places = [n for n in range(len(lines)) if lines[n : n + j - k] == text]
        if "".join(text).strip() and len(places) == 1:
            return k
    return 0


class Symptom(NamedTuple):
    """What a user sees, in a user's words, and the threads of trackers in which it is asked.

    It was measured by a study, as the size of a column: the smaller the better.
    """

    name: str
    threads: tuple[str, ...]
    column: str = "max_error"
    study: str = "contact"


MEASURED = (
    Symptom(name="it tips too early or too late", threads=("bullet3 #1485",)),
    Symptom(
        name="it bounces, or loses nothing, at an impact without restitution",
        column="newton_e",
        threads=("mujoco #2080", "mujoco #1124", "bullet3 #3094", "newton #1137"),
    ),
    Symptom(
        name="it creeps",
        column="slip_widths",
        threads=("bullet3 #3049", "mujoco #2638"),
    ),
    Symptom(name="it sinks into the base", column="sink_widths", threads=("bullet3 #4428",)),
    Symptom(
        name="it gains energy in free rocking",
        column="energy_growth",
        threads=("bullet3 #1530", "rapier #934"),
    ),
)
"""What is measured of every way to set an engine."""

UNMOVED = Symptom(name="a moved base carries nothing", threads=("bullet3 #1204",))
HULL = Symptom(name="a hull behaves unlike a box", threads=("bullet3 #4341",))
STEP = Symptom(
    name="the step changes the answer",
    threads=("mujoco #1240", "mujoco #954"),
    study="precision",
)
BOUNCE = Symptom(
    name="a coefficient of restitution does nothing, or too much",
    column="off_over_all",
    threads=("bullet3 #3094", "bullet3 #1530", "mujoco #2080", "mujoco #1124"),
    study="restitution",
)

SYMPTOMS = (*MEASURED, UNMOVED, HULL, STEP, BOUNCE)
"""All of them; the last four are measured by two settings that are held against each other."""


VARIANTS, OWN = "contact/variants.csv", "contact/own-steps.csv"
LADDER, BOUNCES = "precision/work-precision.csv", "restitution/corners.csv"
TABLES = (VARIANTS, OWN, LADDER, BOUNCES)
"""The tables that are read."""

QUOTED_E = 0.6
"""The coefficient of restitution for which that table quotes settings."""

HELPS = 0.5
"""A setting helps if it leaves no more than this part of what there is by default, both at the
p dt of all and at the library's own step; of peaks, if it lowers the median error, too."""

NUMBERS = ("before", "after", "tuned", "landing", "before_own", "after_own")
"""Columns of sizes: by default, with one setting, and with all; the first two at the own step."""

MENDING = ("setting", "formula", "dt_s", "literal", "after", "after_own")
"""Columns of the setting that helps."""

COLUMNS = (
    *("symptom", "engine", "measure", "shown_by", "before", "setting", "formula", "dt_s"),
    *("literal", *NUMBERS[1:], "asked_in", "command"),
)
"""Columns of symptoms.csv."""


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
        mine, at_own = (part[part["engine"] == engine] for part in (table, own))
        if mine.empty:
            continue
        dt = dt_s or own_step_s(engine)
        changes = partial(patch, engine, friction=friction)
        found = {each: _measured(mine, at_own, each.column, dt, changes) for each in MEASURED}
        found |= {
            UNMOVED: _unmoved(mine, engine),
            HULL: _hull(mine, engine),
            STEP: _stepped(ladder, engine),
            BOUNCE: _bouncing(bounces[bounces["engine"] == engine], dt),
        }
        rows += [_row(symptom, engine, values) for symptom, values in found.items() if values]
    names = [symptom.name for symptom in SYMPTOMS]
    lines = pd.DataFrame(rows, columns=COLUMNS)
    return lines.sort_values(
        "symptom", key=lambda said: said.map(names.index), ignore_index=True, kind="stable"
    )


def _row(symptom: Symptom, engine: str, values: Row) -> Row:
    """Return the line of a symptom; of a setting that does not help it says nothing."""
    before, after = (abs(values.get(name, math.nan)) for name in ("before", "after"))
    if not (math.isfinite(after) and after <= HELPS * before):
        values = {name: it for name, it in values.items() if name not in MENDING}
    return {
        "symptom": symptom.name,
        "engine": engine,
        "measure": symptom.column,
        "shown_by": "the library's defaults",
        **dict.fromkeys(("setting", "formula", "literal"), ""),
        **values,
        "asked_in": ", ".join(symptom.threads),
        "command": f"rocking {symptom.study} --engines {engine} --out DIR",
    }


def _measured(
    mine: pd.DataFrame, own: pd.DataFrame, column: str, dt_s: float, changes: Callable[..., str]
) -> Row:
    """Return what a symptom measures by default, and the one setting that helps most."""
    values: Row = {
        "before": _preset(mine, DEFAULT, column),
        **_tuned(mine, column),
        "before_own": _preset(own, DEFAULT, column),
    }
    mends = _helping(mine, column).merge(
        _helping(own, column), on=["factor", "level"], suffixes=("", "_own")
    )
    if mends.empty:
        return values
    best = mends.iloc[int(mends[column].abs().argmin())]
    factor, level = str(best["factor"]), str(best["level"])
    at = partial(changes, factor, level)
    return {
        **values,
        "setting": f"{factor}: {level}",
        "formula": by_step(at),
        "dt_s": dt_s,
        "literal": at(dt_s),
        "after": float(best[column]),
        "after_own": float(best[f"{column}_own"]),
    }


def _helping(mine: pd.DataFrame, column: str) -> pd.DataFrame:
    """Return the single settings that halve, from the defaults, what there is, and break nothing.

    Whatever defaults that fail leave is halved by a setting that does not fail.
    """
    usual = mine[(mine["preset"] == DEFAULT) & (mine["factor"] == "")].iloc[0]
    most = math.inf if usual["failed"] else HELPS * abs(float(usual[column]))
    tried = mine[(mine["preset"] == DEFAULT) & (mine["factor"] != "")]
    tried = tried[(tried["factor"] != OWN_STEPS) & (tried["failed"] == 0) & ~tried["worse"]]
    if column == MEASURED[0].column:
        median = math.inf if usual["failed"] else float(usual["median_error"])
        tried = tried[tried["median_error"] < median]
    return tried[(tried[column].abs() <= most) & (most > 0.0)][["factor", "level", column]]


def _preset(mine: pd.DataFrame, name: str, column: str) -> float:
    """Return a measure of a preset as it is; inf where cases fail, nan where there is none."""
    found = mine[(mine["preset"] == name) & (mine["factor"] == "")]
    return math.nan if found.empty else _value(found.iloc[0], column)


def _tuned(mine: pd.DataFrame, column: str = "max_error") -> Row:
    return {"tuned": _preset(mine, BEST, column), "landing": _preset(mine, "landing", column)}


def _unmoved(mine: pd.DataFrame, engine: str) -> Row:
    """Return what a base that moves by position alone does, and one with its velocity."""
    asked = mine[mine["factor"] == MOVING_BASE]
    found = {str(line["level"]): _value(line) for _, line in asked.iterrows()}
    levels = [f.levels for f in ENGINES[engine].factors if f.name == MOVING_BASE]
    names = [level.name for all_ in levels for level in (all_[0], all_[-1])]
    if not names or not set(names) <= set(found):
        return {}
    right, wrong = names
    return {
        "shown_by": f"{MOVING_BASE}: {wrong}",
        "before": found[wrong],
        "setting": f"{MOVING_BASE}: {right}",
        "after": found[right],
        **_tuned(mine),
    }


def _hull(mine: pd.DataFrame, engine: str) -> Row:
    """Return the largest error of a hull, and of the box of the defaults."""
    levels = [level for factor in ENGINES[engine].factors for level in factor.levels]
    hulls = [level.name for level in levels if level.settings.get("geometry") == "hull"]
    found = mine[(mine["preset"] == DEFAULT) & mine["level"].isin(hulls)]
    if found.empty:
        return {}
    worst = found.iloc[int(found["max_error"].argmax())]
    return {
        "shown_by": f"the library's defaults, {worst['level']}",
        "before": _value(worst),
        "setting": "a box instead",
        "after": _preset(mine, DEFAULT, "max_error"),
        **_tuned(mine),
    }


def _value(line: pd.Series[Any], column: str = "max_error") -> float:
    return math.inf if line["failed"] else float(line[column])


def _stepped(ladder: pd.DataFrame, engine: str) -> Row:
    """Return the largest error that is left at the finest step of each preset."""
    typical = ladder[ladder["set"] == "typical"].sort_values("value").drop_duplicates("method")
    left = typical.set_index("method")["max_error"]
    before, after, landing = (
        float(left.get(f"{engine} {preset}", math.nan)) for preset in (DEFAULT, BEST, "landing")
    )
    if math.isnan(before) or math.isnan(after):
        return {}
    return {
        "shown_by": "the library's defaults at the finest step",
        "before": before,
        "setting": "a tuned contact at the same step",
        **{"after": after, "tuned": after, "landing": landing},
    }


def _bouncing(ways: pd.DataFrame, dt_s: float) -> Row:
    """Return how far off a coefficient comes out, asked in the first way and in the best."""
    if ways.empty:
        return {}
    first, best = ways.iloc[0], ways.iloc[int(ways["off_over_all"].argmin())]
    return {
        "shown_by": f'"{first["way"]}"',
        "before": float(first["off_over_all"]),
        "setting": f'"{best["way"]}"',
        "formula": f"for {QUOTED_E:g}: {best['literal']}",
        "dt_s": dt_s,
        "literal": f"for {QUOTED_E:g}: {at_step(best['literal'], dt_s)}",
        "after": float(best["off_over_all"]),
    }
