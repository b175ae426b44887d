"""The page from what users see to the setting that mends it, from the published tables."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import pandas as pd

from engines import ENGINES
from studies.drawing.kept import Pictures, keep
from studies.kit.arguments import (
    BadInputError,
    NotNegative,
    Place,
    Positive,
    as_bad_input,
    check_engines,
    several_or_none,
)
from studies.kit.options import DEFAULT_RUNNING, check_written
from studies.kit.plan import Plan, carry_out
from studies.kit.tables import read_table
from studies.measures.published import published_in
from studies.measures.slippery import too_slippery
from studies.measures.words import listed
from studies.symptoms import STUDY
from studies.symptoms.lines import TABLES, VARIANTS, lines_of
from studies.symptoms.words import first_claim, page


def command(
    *,
    engines: Annotated[tuple[str, ...] | None, several_or_none] = None,
    published: Place | None = None,
    dt: Positive | None = None,
    friction: NotNegative | None = None,
    out: Place | None = None,
) -> int:
    """Say what users see, what it measures by default, and which setting leaves how much of it.

    Of the settings changed one at a time from a library's defaults the one that helps most, if it
    halves what there is and gets no more outcomes wrong, at the p dt of all and at the library's
    own step; and what is left where all are tuned, with equal steps and with steps that land on
    impacts.

    Parameters
    ----------
    engines
        Names of engines, without a preset; by default all in the published tables. Of one alone
        what its settings change is written out.
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
    check_engines(asked)
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

    return carry_out(
        STUDY, plan, out, DEFAULT_RUNNING, lambda folder: keep(folder, pictures(folder), text)
    )


def _read(folder: Path) -> pd.DataFrame:
    texts = ("shown_by", "setting", "formula", "literal", "asked_in", "command")
    return read_table(folder / "symptoms.csv", *texts)


def headline(folder: Path) -> str:
    """Say which setting helps most against a wrong peak."""
    return first_claim(_read(folder))


def pictures(folder: Path) -> Pictures:
    """Draw the size of each symptom from a folder's symptoms.csv alone."""
    from studies.symptoms.figure import draw_symptoms

    return {"symptoms": draw_symptoms(_read(folder))}
