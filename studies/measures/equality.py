"""Whether two folders of results hold the same tables: `python -m studies.measures.equality A B`.

For a change that should change no result: run a study, or a whole report, before and after it.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import numpy as np
import pandas as pd
from cyclopts import Parameter

from studies.old import app
from studies.old.arguments import BadInputError, Place, Positive
from studies.old.study import Study
from studies.old.tables import read_table

MEASURED = frozenset(("wall_s", "setup_s", "step_s", "engine_s", "memory_kib", "real_time_factor"))
"""Columns that no two runs have alike: times, and the memory of a process."""

SAME = Study(
    name="same",
    module=__name__,
    help="Whether two folders of results hold the same tables, but for run times.",
)


def command(
    before: Annotated[Place, Parameter(name="BEFORE")],
    after: Annotated[Place, Parameter(name="AFTER")],
    *,
    within: Positive | None = None,
) -> int:
    """Compare every CSV in two folders, and in the folders inside.

    Parameters
    ----------
    before
        A folder of results, or of several as of a report.
    after
        Another one of the same studies.
    within
        Relative difference of two numbers that counts as none; by default only equal ones do.
    """
    for name, folder in (("BEFORE", before), ("AFTER", after)):
        if not folder.is_dir():
            raise BadInputError(f"{name} is {str(folder)!r}; it must be a folder of results")
    different = 0
    for name in sorted({*tables_of(before), *tables_of(after)}):
        found = [*differences(before / name, after / name, within or 0.0)]
        different += bool(found)
        print(f"{name}: {'; '.join(found) or 'equal'}")
    return 1 if different else 0


def tables_of(folder: Path) -> list[str]:
    """Return the tables in a folder and those inside, as paths relative to it."""
    return [str(path.relative_to(folder)) for path in folder.rglob("*.csv")]


def differences(before: Path, after: Path, within: float = 0.0) -> Iterator[str]:
    """Yield in words what two tables do not have in common, nothing where they are equal."""
    for path, words in ((before, "it is new"), (after, "it is missing")):
        if not path.is_file():
            yield words
            return
    old, new = (read_table(path) for path in (before, after))
    if list(old.columns) != list(new.columns):
        apart = sorted(set(old.columns) ^ set(new.columns))
        yield f"other columns: {', '.join(apart) or 'another order'}"
    elif len(old) != len(new):
        yield f"{len(old)} rows before, {len(new)} after"
    else:
        for name in (column for column in old.columns if column not in MEASURED):
            yield from _apart(name, old[name], new[name], within)


def _apart(name: str, old: pd.Series[float], new: pd.Series[float], within: float) -> Iterator[str]:
    numbers = pd.api.types.is_numeric_dtype(old) and pd.api.types.is_numeric_dtype(new)
    if not numbers:
        other = int((old.astype(object).fillna("") != new.astype(object).fillna("")).sum())
        if other:
            yield f"{name} differs in {other} of {len(old)} rows"
        return
    a, b = old.to_numpy(np.float64), new.to_numpy(np.float64)
    same = np.isclose(a, b, rtol=within, atol=0.0, equal_nan=True)
    if not same.all():
        with np.errstate(invalid="ignore", divide="ignore"):
            most = np.max(np.abs(b / a - 1.0)[~same])
        yield f"{name} differs in {int((~same).sum())} of {len(a)} rows, by {most:.1e} at most"


if __name__ == "__main__":
    sys.exit(app.run((SAME,), ["same", *sys.argv[1:]]))
