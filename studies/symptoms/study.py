"""From what users see to the setting that mends it: the command, and its page as text."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from textwrap import fill, indent
from typing import Any

import pandas as pd

from engines import ENGINES
from studies.drawing.kept import WIDTH, as_text, keep
from studies.old.arguments import (
    BadInputError,
    NotNegative,
    Place,
    Positive,
    as_bad_input,
)
from studies.old.naming import Engines
from studies.old.options import DEFAULT_RUNNING, check_written
from studies.old.plan import Plan, carry_out
from studies.measures.published import column_of, published_in, too_slippery
from studies.measures.words import listed, part
from studies.symptoms import STUDY
from studies.symptoms.lines import BLOCK, NUMBERS, TABLES, VARIANTS, lines_of, named


def command(
    *,
    engines: Engines | None = None,
    published: Place | None = None,
    dt: Positive | None = None,
    friction: NotNegative | None = None,
    out: Place | None = None,
) -> int:
    """Say what users see, what it measures by default, and which setting leaves how much of it.

    Parameters
    ----------
    engines
        Names of engines, without a preset, of those in the published tables. Of one alone what
        its settings change is written out.
    published
        Folder of the published tables; by default those that come with this project.
    dt
        Your step [s], for which settings are written out; by default the library's own.
    friction
        Coefficient of friction with which settings are written out; by default the library's own,
        with which they were measured.
    out
        Folder for a table and a figure; none by default.
    """
    check_written(dt)
    tables = published_in(published, TABLES)
    asked = tuple(ENGINES) if engines is None else engines
    with as_bad_input():
        lines = lines_of(tables, asked, dt, friction)
    if lines.empty:
        problem = f"it must name one in {VARIANTS}"
        raise BadInputError(f"--engines is {' '.join(asked)!r}; {problem}")
    parts = (page(lines), too_slippery(friction), f"From {listed(TABLES)}.")
    text = "\n\n".join(filter(None, parts))
    if out is None:
        print(text)
        return 0
    settings = {"engines": list(lines["engine"].unique()), "dt": dt}
    settings |= {} if friction is None else {"friction": friction}
    plan = Plan(settings=settings, tabulate=lambda _: {"symptoms": lines})
    return carry_out(STUDY, plan, out, DEFAULT_RUNNING, lambda folder: keep(STUDY, folder, text))


SHORT = 28
"""Letters up to which a sentence quotes what a setting is in the library's words."""

SHOWN = ("engine", "shown_by", "setting", *NUMBERS)
"""Columns of a symptom's table."""

HELPS = (
    "A setting helps if it halves what there is, at the p dt of all and at the library's own step; "
    "a peak, if the median error falls, too. It may make another symptom worse. inf: cases fail."
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
    return "\n\n".join([as_text(finding(lines), tables), fill(HELPS, WIDTH), *changes])


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


def finding(lines: pd.DataFrame) -> str:
    """Say of every engine which single setting helps most against a wrong peak."""
    first = lines[lines["symptom"] == lines.iloc[0]["symptom"]]
    rows = first.to_dict("records")
    words = [_helps(row) for row in rows if row["setting"]]
    others = [str(row["engine"]) for row in rows if not row["setting"]]
    if others:
        words.append(f"nothing halves it in {listed(others)}")
    what = "Largest error of a peak by default, and with the one setting that helps most"
    return f"{what}: {'; '.join(words)}."


def _helps(row: Mapping[Any, Any]) -> str:
    before, after = float(str(row["before"])), float(str(row["after"]))
    values = named(str(row["formula"]))
    setting = values if 0 < len(values) <= SHORT else row["setting"]
    return f"{row['engine']} {part(before)}, {part(after)} ({setting})"
