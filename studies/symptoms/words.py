"""The page as text, and what a reader of all studies is told of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from textwrap import fill, indent
from typing import Any

import pandas as pd

from studies.drawing.kept import WIDTH, as_text
from studies.measures.columns import column_of
from studies.measures.words import listed, part
from studies.symptoms.lines import NUMBERS
from studies.symptoms.patch import BLOCK, named

SHORT = 28
"""Letters up to which a sentence quotes what a setting is in the library's words."""

SHOWN = ("engine", "shown_by", "setting", *NUMBERS)
"""Columns of a symptom's table."""

HELPS = (
    "A setting helps if it halves what there is, at the p dt of all and at the library's own step; "
    "inf: cases fail."
)
"""How the tables are read."""

ASK = "What the settings change in a script, line by line: rocking symptoms --engines"
"""Where what is written out for one engine is asked, before its name."""

CHANGES = (
    "A setting is what changes in the script that `rocking export` writes of the defaults: below "
    "the name of a file, lines that go (-) and lines that come (+), after those that stay. They "
    f"are those of a block of {BLOCK.width:g} by {BLOCK.height:g} m. DT is the step in seconds; "
    "what follows it is given as a formula, then at a step."
)
"""How what is written out for one engine is read."""


def page(lines: pd.DataFrame) -> str:
    """Return the page: a table for each symptom; of one engine also what its settings change."""
    tables = {
        _title(symptom, group.iloc[0]): group[list(SHOWN)].dropna(axis=1, how="all")
        for symptom, group in lines.groupby("symptom", sort=False)
    }
    engines = lines["engine"].unique()
    alone = len(engines) == 1
    changes = [fill(CHANGES, WIDTH), *_changes(lines)] if alone else [f"{ASK} {engines[0]}"]
    return "\n\n".join([as_text(first_claim(lines), tables), fill(HELPS, WIDTH), *changes])


def _title(symptom: object, line: pd.Series[Any]) -> str:
    meaning = column_of("", line["measure"])[-1].partition(";")[0].replace("|", "∣")
    return fill(f"{symptom} ({meaning}; asked in {line['asked_in']})", WIDTH)


def _changes(lines: pd.DataFrame) -> Iterator[str]:
    for _, row in lines[lines["formula"] != ""].drop_duplicates("formula").iterrows():
        alike = ", ".join(lines.loc[lines["formula"] == row["formula"], "symptom"])
        parts = [f"{row['setting']} ({alike}):", indent(row["formula"], "  ")]
        if row["literal"] != row["formula"]:
            parts += [f"at DT = {row['dt_s']:.6g} s:", indent(row["literal"], "  ")]
        yield "\n".join(parts)


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
