"""The page as text, and what a reader of all studies is told of it."""

from __future__ import annotations

from collections.abc import Mapping
from textwrap import fill, indent
from typing import Any

import pandas as pd

from studies.measures.columns import column_of
from studies.measures.differences import scientific
from studies.measures.words import listed, part
from studies.symptoms.patch import BLOCK, named

LINES: dict[str, Any] = {
    **{"width": 99, "initial_indent": "  ", "subsequent_indent": "    "},
    **{"break_long_words": False, "break_on_hyphens": False},
}
"""How a line of the page is broken: no number in two."""

SHORT = 60
"""Letters up to which a sentence quotes what a setting is in the library's words."""

HOW = fill(
    "A setting is what changes in the script that `rocking export` writes of the defaults: below "
    "the name of a file, lines that go (-) and lines that come (+), after those that stay. They "
    f"are those of a block of {BLOCK.width:g} by {BLOCK.height:g} m. DT is the step in seconds; "
    "what follows it is given as a formula, then at a step. A setting helps if it halves what "
    "there is, at the p dt of all and at the library's own step.",
    width=99,
)
"""How the page is read."""


NUMBERS = ("before", "after", "tuned", "landing", "before_own", "after_own")
"""Columns that a line of the page says."""


def page(lines: pd.DataFrame) -> str:
    """Return the page: a paragraph for each symptom, a line for each engine."""
    parts = [HOW]
    for symptom, group in lines.groupby("symptom", sort=False):
        head = f"{symptom} ({_measure(str(group.iloc[0]['measure']))})"
        asked = f"  asked in {group.iloc[0]['asked_in']}"
        parts.append("\n".join([head, asked, *map(_line, group.to_dict("records"))]))
    return "\n\n".join(parts)


def _measure(column: str) -> str:
    return column_of("", column)[-1].partition(";")[0].replace("|", "∣")


def _line(row: Mapping[Any, Any]) -> str:
    number = {name: float(str(row[name])) for name in NUMBERS}
    known = {name for name in NUMBERS if number[name] == number[name]}
    words = f"{row['engine']}: {_number(number['before'])} with {row['shown_by']}"
    if row["setting"]:
        words += f"; {_number(number['after'])} with {row['setting']}"
    elif number["before"]:
        words += "; no single setting halves it"
    rest = [f"{_number(number[name])} {name}" for name in ("tuned", "landing") if name in known]
    parts = [words, listed(rest)] if rest else [words]
    if "before_own" in known:
        parts.append(f"at the library's own step {_number(number['before_own'])}")
        if "after_own" in known:
            parts[-1] += f" and {_number(number['after_own'])} with it"
    lines = [fill("; ".join(parts), **LINES)]
    for changes in dict.fromkeys((str(row["formula"]), str(row["literal"]))):
        if changes:
            at = "" if changes == row["formula"] else f"at DT = {float(str(row['dt_s'])):.6g} s\n"
            lines.append(indent(at + changes, "      "))
    return "\n".join([*lines, f"    {row['command']}"])


def _number(value: float) -> str:
    if value == float("inf"):
        return "cases that fail"
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
    values = named(str(row["formula"]))
    setting = values if 0 < len(values) <= SHORT else row["setting"]
    return (
        f"in {row['engine']} {setting} alone takes the largest error from {part(before)} to "
        f"{part(after)}"
    )
