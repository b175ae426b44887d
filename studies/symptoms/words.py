"""What a setting changes, in the library's words; and the page as text."""

import re
from collections.abc import Mapping
from textwrap import fill
from typing import Any

import pandas as pd

from analytic.block import RigidBlock
from analytic.motion import SinePulse
from engines import ENGINES, Scene
from studies.cases.variants import variants
from studies.measures.columns import COLUMNS
from studies.measures.differences import scientific
from studies.measures.words import listed, part

SCENE_STEP = 1e-3
"""p dt at which settings are written out, that of the study of contacts."""

BLOCK = RigidBlock(width=0.5, height=1.5)
"""The block for which they are."""

LINES: dict[str, Any] = {
    **{"width": 99, "initial_indent": "  ", "subsequent_indent": "    "},
    **{"break_long_words": False, "break_on_hyphens": False},
}
"""How a line of the page is broken: no number in two."""

SHORT = 60
"""Letters up to which a sentence quotes what a setting is in the library's words."""

GIVEN = re.compile(r"\w+=(?:\"[^\"]*\"|\[[^\]]*\]|\([^)]*\)|[^,()\s]+)")
"""A named value in a call of Python, or in a model."""


def changed(engine: str, preset: str, factor: str, level: str) -> str:
    """Return what a variant of a preset sets otherwise, in the library's words.

    Empty for an engine that writes no scripts.
    """
    script = ENGINES[engine].script
    if script is None:
        return ""
    found = [
        v for v in variants(engine) if (v.preset, v.factor, v.level) == (preset, factor, level)
    ]
    given = []
    for settings in ({}, dict(found[0].settings)):
        scene = Scene(
            block=BLOCK,
            motion=SinePulse(amplitude=1.0, omega=1.0),
            preset=preset,
            step=SCENE_STEP,
            settings=settings,
        )
        chosen = scene.choose(ENGINES[engine].preset(preset).settings)
        lines = script(scene, chosen, SCENE_STEP / BLOCK.p).settings
        given.append(dict.fromkeys(GIVEN.findall(" ".join(" ".join(lines).split()))))
    return ", ".join(word for word in given[1] if word not in given[0])


def page(lines: pd.DataFrame) -> str:
    """Return the page: a paragraph for each symptom, a line for each engine."""
    parts = []
    for symptom, group in lines.groupby("symptom", sort=False):
        head = f"{symptom} ({_measure(str(group.iloc[0]['measure']))})"
        asked = f"  asked in {group.iloc[0]['asked_in']}"
        parts.append("\n".join([head, asked, *map(_line, group.to_dict("records"))]))
    return "\n\n".join(parts)


def _measure(column: str) -> str:
    return COLUMNS[column].meaning.partition(";")[0].replace("|", "∣")


def _line(row: Mapping[Any, Any]) -> str:
    number = {name: float(str(row[name])) for name in ("before", "after", "tuned", "landing")}
    words = f"{row['engine']}: {_number(number['before'])} with {row['shown_by']}"
    if row["setting"]:
        words += f"; {_number(number['after'])} with {row['setting']}"
        words += f" ({row['literal']})" if row["literal"] else ""
    elif number["before"]:
        words += "; no single setting halves it"
    rest = [
        f"{_number(number[name])} {how}"
        for name, how in (("tuned", "tuned"), ("landing", "landing"))
        if number[name] == number[name]
    ]
    lines = fill("; ".join([words, listed(rest)] if rest else [words]), **LINES)
    return f"{lines}\n    {row['command']}"


def _number(value: float) -> str:
    if value == float("inf"):
        return "no result"
    return scientific(value)


def first_claim(lines: pd.DataFrame) -> str:
    """Say of every engine which single setting helps most against a wrong peak."""
    first = lines[lines["symptom"] == lines.iloc[0]["symptom"]]
    rows = first.to_dict("records")
    words = [_helps(row) for row in rows if row["setting"]]
    others = [str(row["engine"]) for row in rows if not row["setting"]]
    if others:
        words.append(f"in {listed(others)} no single setting halves it")
    return f"Where a block tips too early or too late, {'; '.join(words)}."


def _helps(row: Mapping[Any, Any]) -> str:
    before, after = float(str(row["before"])), float(str(row["after"]))
    literal = str(row["literal"])
    setting = literal if 0 < len(literal) <= SHORT else row["setting"]
    return (
        f"in {row['engine']} {setting} alone takes the largest error from {part(before)} to "
        f"{part(after)}"
    )


def told(lines: pd.DataFrame) -> str:
    """Say of every symptom what there is by default, and what one setting and all leave of it."""
    sentences = []
    for symptom, group in lines.groupby("symptom", sort=False):
        words = [_short(row) for row in group.to_dict("records")]
        sentences.append(f"{str(symptom).capitalize()}: {'; '.join(words)}.")
    return " ".join(sentences)


def _short(row: Mapping[Any, Any]) -> str:
    number = {name: float(str(row[name])) for name in ("before", "after", "tuned")}
    words = f"{row['engine']} {_number(number['before'])}"
    if row["setting"]:
        words += f", {_number(number['after'])} with {row['setting']}"
    return words + (
        f", {_number(number['tuned'])} tuned" if number["tuned"] == number["tuned"] else ""
    )
