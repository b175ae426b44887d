"""From what users of an engine see to the setting that mends it, with the effect measured."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from difflib import SequenceMatcher
from functools import partial
from pathlib import Path
from textwrap import fill, indent
from typing import Any, NamedTuple

import pandas as pd

from analytic.block import RigidBlock
from analytic.motion import SinePulse
from engines import ENGINES, Scene
from engines.declaration import BEST, DEFAULT, MOVING_BASE, OWN_STEPS
from engines.world import Script
from studies.cases.refusal import BadInputError
from studies.cases.variants import variants
from studies.kit.jobs import Row
from studies.kit.say import WIDTH, out_of
from studies.kit.tables import read_table
from studies.measures.formulas import at_step, by_step
from studies.measures.published import LADDER, column_of

VARIANTS, OWN, BOUNCES = "contact/variants.csv", "contact/own-steps.csv", "restitution/corners.csv"
TABLES = (VARIANTS, OWN, LADDER, BOUNCES)


class Symptom(NamedTuple):
    """What a user sees, where it is asked, and the study's column whose size says how much."""

    name: str
    threads: str
    column: str = "max_error"
    study: str = "contact"


MEASURED = (
    Symptom("it tips too early or too late", "bullet3 #1485"),
    Symptom(
        "it bounces, or loses nothing, at an impact without restitution",
        "mujoco #2080, mujoco #1124, bullet3 #3094, newton #1137",
        "newton_e",
    ),
    Symptom("it creeps", "bullet3 #3049, mujoco #2638", "slip_widths"),
    Symptom("it sinks into the base", "bullet3 #4428", "sink_widths"),
    Symptom("it gains energy in free rocking", "bullet3 #1530, rapier #934", "energy_growth"),
)
"""What is measured of every way to set an engine."""
UNMOVED = Symptom("a moved base carries nothing", "bullet3 #1204")
HULL = Symptom("a hull behaves unlike a box", "bullet3 #4341")
STEP = Symptom("the step changes the answer", "mujoco #1240, mujoco #954", study="precision")
BOUNCE = Symptom(
    "a coefficient of restitution does nothing, or too much",
    "bullet3 #3094, bullet3 #1530, mujoco #2080, mujoco #1124",
    "off_over_all",
    "restitution",
)
SYMPTOMS = (*MEASURED, UNMOVED, HULL, STEP, BOUNCE)
"""All of them; the last four compare two settings."""

DEFAULTS = "the library's defaults"
HELPS = 0.5
"""A setting helps if it leaves no more than this part of what there is by default, both at the
p dt of all and at the library's own step; of peaks, if it lowers the median error, too."""
NUMBERS = ("before", "after", "tuned", "landing", "before_own", "after_own")
"""Columns of sizes: by default, with one setting, and with all; the last two at the own step."""
MENDING = ("setting", "formula", "dt_s", "literal", "after", "after_own")
"""Columns of the setting that helps."""
TEXTS = ("shown_by", "setting", "formula", "literal", "asked_in", "command")


def find(
    published: Path,
    engines: Sequence[str],
    block: RigidBlock,
    dt_s: float | None = None,
    friction: float | None = None,
) -> pd.DataFrame:
    """Return the columns of symptoms.csv: a line for each symptom and engine of published tables.

    Settings are written out for a block, a step [s] and a friction, both by default the library's.
    """
    table, own = (
        read_table(published / name, "factor", "level", "trap") for name in (VARIANTS, OWN)
    )
    ladder, bounces = (pd.read_csv(published / name) for name in (LADDER, BOUNCES))
    rows: list[Row] = []
    for engine in [name for name in engines if name in set(table["engine"])]:
        mine, at_own, ways = (each[each["engine"] == engine] for each in (table, own, bounces))
        dt = dt_s or ENGINES[engine].use(_scene(block, {})).dt_s
        changes = partial(patch, block, engine, friction=friction)
        found = {each: _measured(mine, at_own, each.column, dt, changes) for each in MEASURED}
        found |= {UNMOVED: _unmoved(mine, engine), HULL: _hull(mine, engine)}
        found |= {STEP: _stepped(ladder, engine), BOUNCE: _bouncing(ways, dt)}
        rows += [_row(symptom, engine, values) for symptom, values in found.items() if values]
    if not rows:
        asked = f"--engines is {' '.join(engines)!r}"
        raise BadInputError(f"{asked}; it must name one in {VARIANTS}")
    names = [symptom.name for symptom in SYMPTOMS]
    columns = ["symptom", "engine", "measure", "shown_by", "before", "setting", "formula", "dt_s"]
    columns += ["literal", *NUMBERS[1:], "asked_in", "command"]
    return pd.DataFrame(rows, columns=columns).sort_values(
        "symptom", key=lambda column: column.map(names.index), ignore_index=True, kind="stable"
    )


def _row(symptom: Symptom, engine: str, values: Row) -> Row:
    """Return the line of a symptom, without a setting that does not help it."""
    before, after = (abs(values.get(name, math.nan)) for name in ("before", "after"))
    if not (math.isfinite(after) and after <= HELPS * before):
        values = {name: it for name, it in values.items() if name not in MENDING}
    return {
        **{"symptom": symptom.name, "engine": engine, "measure": symptom.column},
        **{"shown_by": DEFAULTS, "setting": "", "formula": "", "literal": ""},
        **values,
        "asked_in": symptom.threads,
        "command": f"rocking {symptom.study} --engines {engine} --out DIR",
    }


def _measured(
    mine: pd.DataFrame, own: pd.DataFrame, column: str, dt_s: float, changes: Callable[..., str]
) -> Row:
    """Return what a symptom measures by default, and the one setting that helps most."""
    values = {"before": _preset(mine, DEFAULT, column), **_tuned(mine, column)}
    values["before_own"] = _preset(own, DEFAULT, column)
    mends = _helping(mine, column).merge(
        _helping(own, column), on=["factor", "level"], suffixes=("", "_own")
    )
    if mends.empty:
        return values
    best = mends.iloc[int(mends[column].abs().argmin())]
    at = partial(changes, str(best["factor"]), str(best["level"]))
    mending = {"setting": f"{best['factor']}: {best['level']}", "formula": by_step(at)}
    sizes = {"after": float(best[column]), "after_own": float(best[f"{column}_own"])}
    return {**values, **mending, "dt_s": dt_s, "literal": at(dt_s), **sizes}


def _helping(mine: pd.DataFrame, column: str) -> pd.DataFrame:
    """Return the single settings that halve, from the defaults, what there is, and break nothing.

    Whatever defaults that fail leave is halved by a setting that does not fail.
    """
    mine = mine[(mine["preset"] == DEFAULT) & (mine["factor"] != OWN_STEPS)]
    usual = mine[mine["factor"] == ""].iloc[0]
    most, median = (math.inf if usual["failed"] else abs(float(usual[name]))
                    for name in (column, "median_error"))  # fmt: skip
    tried = mine[(mine["factor"] != "") & (mine["failed"] == 0) & ~mine["worse"]]
    if column == MEASURED[0].column:
        tried = tried[tried["median_error"] < median]
    helps = (tried[column].abs() <= HELPS * most) & (most > 0.0)
    return tried.loc[helps, ["factor", "level", column]]


def _preset(mine: pd.DataFrame, name: str, column: str = "max_error") -> float:
    """Return a measure of a preset as it is; inf where cases fail, nan where there is none."""
    found = mine[(mine["preset"] == name) & (mine["factor"] == "")]
    return math.nan if found.empty else _size(found.iloc[0], column)


def _size(line: pd.Series[Any], column: str = "max_error") -> float:
    return math.inf if line["failed"] else float(line[column])


def _tuned(mine: pd.DataFrame, column: str = "max_error") -> Row:
    return {"tuned": _preset(mine, BEST, column), "landing": _preset(mine, "landing", column)}


def _pair(seen: str, before: float, setting: str, after: float, **more: Any) -> Row:
    return {"shown_by": seen, "before": before, "setting": setting, "after": after, **more}


def _unmoved(mine: pd.DataFrame, engine: str) -> Row:
    """Return what a base that moves by position alone does, and one with its velocity."""
    lines = mine[mine["factor"] == MOVING_BASE].iterrows()
    found = {str(line["level"]): _size(line) for _, line in lines}
    levels = [factor.levels for factor in ENGINES[engine].factors if factor.name == MOVING_BASE]
    if not levels or not {levels[0][0].name, levels[0][-1].name} <= found.keys():
        return {}
    right, wrong = levels[0][0].name, levels[0][-1].name
    names = (f"{MOVING_BASE}: {wrong}", found[wrong], f"{MOVING_BASE}: {right}", found[right])
    return _pair(*names, **_tuned(mine))


def _hull(mine: pd.DataFrame, engine: str) -> Row:
    """Return the largest error of a hull, and of the box of the defaults."""
    levels = [level for factor in ENGINES[engine].factors for level in factor.levels]
    hulls = [level.name for level in levels if level.settings.get("geometry") == "hull"]
    found = mine[(mine["preset"] == DEFAULT) & mine["level"].isin(hulls)]
    if found.empty:
        return {}
    worst, box = found.iloc[int(found["max_error"].argmax())], _preset(mine, DEFAULT)
    seen = f"{DEFAULTS}, {worst['level']}"
    return _pair(seen, _size(worst), "a box instead", box, **_tuned(mine))


def _stepped(ladder: pd.DataFrame, engine: str) -> Row:
    """Return the largest error that is left at the finest step of each preset."""
    finest = ladder[ladder["set"] == "typical"].sort_values("value").drop_duplicates("method")
    left = finest.set_index("method")["max_error"]
    names = [f"{engine} {preset}" for preset in (DEFAULT, BEST, "landing")]
    before, after, landing = (float(left.get(name, math.nan)) for name in names)
    if math.isnan(before) or math.isnan(after):
        return {}
    names = [f"{DEFAULTS} at the finest step", "a tuned contact at the same step"]
    return _pair(names[0], before, names[1], after, tuned=after, landing=landing)


def _bouncing(ways: pd.DataFrame, dt_s: float) -> Row:
    """Return how far off a coefficient is, asked in the first way and in the best."""
    if ways.empty:
        return {}
    first, best = ways.iloc[0], ways.iloc[int(ways["off_over_all"].argmin())]
    sizes = [float(way["off_over_all"]) for way in (first, best)]
    row = _pair(f'"{first["way"]}"', sizes[0], f'"{best["way"]}"', sizes[1], dt_s=dt_s)
    lines = {"formula": best["literal"], "literal": at_step(best["literal"], dt_s)}
    # the study quotes settings for a coefficient of 0.6
    return row | {name: f"for 0.6: {text}" for name, text in lines.items()}


def patch(
    block: RigidBlock,
    engine: str,
    factor: str,
    level: str,
    dt_s: float,
    friction: float | None = None,
) -> str:
    """Return what a variant of the defaults changes in the script that `rocking export` writes.

    Of each place the name of the file, lines that stay, those that go and those that come; empty
    for an engine that writes no scripts.
    """
    script = ENGINES[engine].script
    if script is None or not ENGINES[engine].installed:
        return ""
    known = {(each.preset, each.factor, each.level): each.settings for each in variants(engine)}
    changed = known[DEFAULT, factor, level]
    uses = [ENGINES[engine].use(_scene(block, given, friction)) for given in ({}, changed)]
    before, after = (_files(script(each.scene, each.settings, dt_s)) for each in uses)
    return "\n".join(line for name in after for line in _places(name, before[name], after[name]))


def _scene(block: RigidBlock, settings: Mapping[str, Any], friction: float | None = None) -> Scene:
    motion = SinePulse(amplitude=1.0, omega=1.0)
    return Scene(system=block, motion=motion, preset=DEFAULT, settings=settings, friction=friction)


def _files(script: Script) -> dict[str, list[str]]:
    inner = [f"    {line}" for line in (*script.step, *script.pose)]
    texts = {"block.py": "\n".join((*script.imports, *script.build, *inner)), **script.files}
    return {name: text.splitlines() for name, text in texts.items()}


def _places(name: str, before: Sequence[str], after: Sequence[str]) -> Iterator[str]:
    """Yield each place where lines differ, after as many that stay as tell it from all others."""
    for tag, i, j, k, m in SequenceMatcher(None, before, after, autojunk=False).get_opcodes():
        if tag != "equal":
            yield f"@@ {name}"
            yield from (f"  {line}" for line in before[_unique_from(before, i, j) : i])
            yield from (f"- {line}" for line in before[i:j])
            yield from (f"+ {line}" for line in after[k:m])


def _unique_from(lines: Sequence[str], i: int, j: int) -> int:
    """Return the largest k up to i from which lines up to j are there only once."""
    for k in range(i, 0, -1):
        text = lines[k:j]
        places = [n for n in range(len(lines)) if lines[n : n + j - k] == text]
        if "".join(text).strip() and len(places) == 1:
            return k
    return 0


def finding(lines: pd.DataFrame) -> str:
    """Say how many symptoms one setting mends, and how well."""
    factors = (lines["before"] / lines["after"]).abs().dropna()
    by = f", and divides every second of these by {factors.median():.0f} or more"
    much = by if math.isfinite(factors.median()) else ""
    return f"A single setting halves {out_of(len(factors), len(lines))} symptoms of engines{much}."


def shown(lines: pd.DataFrame) -> Mapping[str, pd.DataFrame]:
    """Return a table for each symptom."""
    tables = {}
    for symptom, group in lines.groupby("symptom", sort=False):
        line = group.iloc[0]
        measure = column_of("", line["measure"])[-1].partition(";")[0].replace("|", "∣")
        fails = "; inf: cases fail" if (group["before"] == math.inf).any() else ""
        title = fill(f"{symptom} ({measure}{fails}; asked in {line['asked_in']})", WIDTH)
        tables[title] = group[["engine", "shown_by", "setting", *NUMBERS]].dropna(axis=1, how="all")
    return tables


HALVES = (
    "A setting helps if it halves what there is, at the p dt of all and at the library's own step; "
    "a peak, if the median error falls, too. It may make another symptom worse."
)
CHANGES = """A setting is what changes in the script that `rocking export` writes of the defaults:
below the name of a file, lines that go (-) and lines that come (+), after those that stay. DT is
the step in seconds; what follows it is given as a formula, then at a step."""


def write(lines: pd.DataFrame) -> Iterator[str]:
    """Yield what each setting that helps changes, as a formula of the step and at a step."""
    yield CHANGES
    for _, row in lines[lines["formula"] != ""].drop_duplicates("formula").iterrows():
        alike = ", ".join(lines.loc[lines["formula"] == row["formula"], "symptom"])
        parts = [f"{row['setting']} ({alike}):", indent(row["formula"], "  ")]
        if row["literal"] != row["formula"]:
            parts += [f"at DT = {row['dt_s']:.6g} s:", indent(row["literal"], "  ")]
        yield "\n".join(parts)
