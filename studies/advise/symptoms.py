"""From what users of an engine see to the one setting that helps most, with the effect measured."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from itertools import product
from textwrap import fill, indent
from typing import Any, NamedTuple

import pandas as pd

from analytic.block import RigidBlock
from analytic.motion import SinePulse
from engines import ENGINES
from engines.factors import BEST, DEFAULT, OWN_STEPS
from studies.cases.refusal import BadInputError
from studies.cases.variants import variants
from studies.kit.say import WIDTH, out_of
from studies.kit.tables import read_table
from studies.measures.published import PUBLISHED, columns
from studies.sources.registry import scene_of

VARIANTS, OWN = TABLES = "contact/variants.csv", "contact/own-steps.csv"


class Symptom(NamedTuple):
    """What a user sees, where it is asked, and the study's column whose size says how much."""

    name: str
    threads: str
    column: str


SYMPTOMS = (
    Symptom("it tips too early or too late", "bullet3 #1485", "max_error"),
    Symptom(
        "it bounces, or loses nothing, at an impact without restitution",
        "mujoco #2080, mujoco #1124, bullet3 #3094, newton #1137",
        "newton_e",
    ),
    Symptom("it creeps", "bullet3 #3049, mujoco #2638", "slip_widths"),
    Symptom("it sinks into the base", "bullet3 #4428", "sink_widths"),
    Symptom("it gains energy in free rocking", "bullet3 #1530, rapier #934", "energy_growth"),
)
HELPS = 0.5
"""A setting helps if it leaves no more than this part of what there is by default, both at the
p dt of all and at the library's own step; of peaks, if it lowers the median error, too."""
NUMBERS = ("before", "after", "tuned", "landing", "before_own", "after_own")
"""Columns of sizes: by default, with one setting, and with all; the last two at the own step."""
TEXTS = ("setting", "asked_in")


def find(engines: Iterable[str]) -> pd.DataFrame:
    """Return the columns of symptoms.csv: a line for each symptom and published engine."""
    table, own = (read_table(PUBLISHED / name, "factor", "level", "trap") for name in TABLES)
    rows = []
    asked = [name for name in engines if name in set(table["engine"])]
    for symptom, engine in product(SYMPTOMS, asked):
        column = symptom.column
        mine, at_own = (each[each["engine"] == engine] for each in (table, own))
        row = {
            **{"symptom": symptom.name, "engine": engine, "measure": column},
            **{"before": _preset(mine, DEFAULT, column), "setting": ""},
            **{"after": math.nan, "tuned": _preset(mine, BEST, column)},
            **{"landing": _preset(mine, "landing", column)},
            **{"before_own": _preset(at_own, DEFAULT, column), "after_own": math.nan},
            "asked_in": symptom.threads,
        }
        here, there = (_helping(each, column) for each in (mine, at_own))
        helping = here.merge(there, on=["factor", "level"], suffixes=("", "_own"))
        if len(helping):
            place = int(helping[column].abs().argmin())
            row["setting"] = ": ".join(helping.index[place])
            row["after"], row["after_own"] = helping.iloc[place]
        rows.append(row)
    if not rows:
        words = f"it must name one in {VARIANTS}"
        raise BadInputError(f"--engines is {' '.join(engines)!r}; {words}")
    return pd.DataFrame(rows)


def _helping(mine: pd.DataFrame, column: str) -> pd.DataFrame:
    """Return the single settings that halve what the defaults leave, and break nothing."""
    mine = mine[(mine["preset"] == DEFAULT) & (mine["factor"] != OWN_STEPS)]
    usual = mine[mine["factor"] == ""].iloc[0]
    most, median = (abs(_size(usual, name)) for name in (column, "median_error"))
    tried = mine[(mine["factor"] != "") & (mine["failed"] == 0) & ~mine["worse"]]
    if column == "max_error":
        tried = tried[tried["median_error"] < median]
    helps = (tried[column].abs() <= HELPS * most) & (most > 0.0)
    return tried[helps].set_index(["factor", "level"])[[column]]


def _preset(mine: pd.DataFrame, name: str, column: str) -> float:
    """Return a measure of a preset as it is; inf where cases fail, nan where there is none."""
    found = mine[(mine["preset"] == name) & (mine["factor"] == "")]
    return math.nan if found.empty else _size(found.iloc[0], column)


def _size(line: pd.Series[Any], column: str) -> float:
    return math.inf if line["failed"] else float(line[column])


def finding(lines: pd.DataFrame) -> str:
    """Say how many symptoms one setting halves, and how much less it leaves."""
    factors = (lines["before"] / lines["after"]).abs().dropna()
    much = f", and divides half of these by {factors.median():.0f} or more" if len(factors) else ""
    return f"A single setting halves {out_of(len(factors), len(lines))} symptoms of engines{much}."


def shown(lines: pd.DataFrame) -> Mapping[str, pd.DataFrame]:
    """Return a table for each symptom."""
    tables = {}
    for symptom, group in lines.groupby("symptom", sort=False):
        line = group.iloc[0]
        fails = "; inf: cases fail" if (group["before"] == math.inf).any() else ""
        meaning = columns()["", line["measure"]][-1].partition(";")[0].replace("|", "∣")
        title = f"{symptom} ({meaning}{fails}; asked in {line['asked_in']})"
        tables[fill(title, WIDTH)] = group[["engine", "setting", *NUMBERS]]
    return tables


HALVES = (
    "A setting helps if it halves what there is, at the p dt of all and at the library's own step; "
    "a peak, if the median error falls, too. It may make another symptom worse. Quoted are the "
    "lines that set it, as `rocking export` writes them beside the other defaults. How an engine "
    "takes a coefficient of restitution is a study of its own, `rocking restitution`."
)


def settings_in_words(
    engine: str, preset: str, block: RigidBlock, **options: Any
) -> tuple[str, ...]:
    """Return what a preset sets for a block, in the library's words."""
    declared = ENGINES[engine]
    if declared.script is None or not declared.installed:
        return (f"{declared.title} writes out its settings where it is installed",)
    scene = scene_of(block, SinePulse(amplitude=1.0, omega=1.0), preset, **options)
    use = declared.use(scene)
    return declared.script(use.scene, use.settings, use.dt_s).settings


def write(lines: pd.DataFrame, block: RigidBlock, friction: float | None) -> Iterator[str]:
    """Yield what each setting that helps sets and the defaults do not, in the library's words."""
    for (engine, setting), group in lines[lines["setting"] != ""].groupby(["engine", "setting"]):
        known = {f"{each.factor}: {each.level}": each.settings for each in variants(str(engine))
                 if each.preset == DEFAULT}  # fmt: skip
        usual, changed = (
            settings_in_words(str(engine), DEFAULT, block, friction=friction, settings=own)
            for own in ({}, known[str(setting)])
        )
        text = "\n".join(line for line in changed if line not in usual)
        yield f"{setting} ({', '.join(group['symptom'])}):\n{indent(text, '  ')}"
