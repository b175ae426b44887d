"""One full run of every study, as this project keeps it: where, and what its columns mean.

A line of columns.csv is for the columns of that name in all tables, or in the one that it names.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analytic import simulate
from studies.cases.paper import SWEEPS, sweep_cases
from studies.kit.arguments import BadInputError
from studies.kit.provenance import check

PUBLISHED = Path(__file__).parents[1] / "published"
"""The folder of the published tables, one folder inside for each chapter."""


def published_in(folder: Path | None, names: Sequence[str]) -> Path:
    """Return the folder of published tables that --published gives.

    Parameters
    ----------
    folder : Path or None
        What was given; None for PUBLISHED.
    names : sequence of str
        Tables that it must hold, as chapter/file.csv.

    Raises
    ------
    BadInputError
        If it lacks one of these tables.
    FolderError
        If one was edited.
    """
    found = folder or PUBLISHED
    if missing := [name for name in names if not (found / name).is_file()]:
        raise BadInputError(f"--published is {str(found)!r}; it must hold {missing[0]}")
    check(found, names, "--published")
    return found


@functools.cache
def needed() -> NDArray[np.float64]:
    """Return the friction that the exact solution needs in each of the paper's cases."""
    return np.array([simulate(c.block, c.motion).friction_needed for c in sweep_cases(SWEEPS)])


def too_slippery(friction: float | None) -> str:
    """Say in how many of the paper's cases the exact solution needs more friction, or nothing."""
    if friction is None:
        return ""
    short = int((needed() > friction).sum())
    if not short:
        return ""
    return (
        f"With friction {friction:g} a block slides in {short} of the paper's {needed().size} "
        f"cases, which need up to {needed().max():.3g}; what was published was measured with the "
        "presets' own friction."
    )


TOLD = ("type", "unit", "meaning")
"""What is told of a column: text, boolean, integer (what counts) or number; its unit; its meaning.

The unit of a number without one is "-".
"""


@cache
def columns() -> dict[tuple[str, str], tuple[str, ...]]:
    """Return what is told of a column, by table (empty: any) and name."""
    lines = pd.read_csv(Path(__file__).with_name("columns.csv"), keep_default_na=False)
    return {
        (str(table), str(name)): tuple(map(str, told))
        for table, name, *told in lines.itertuples(index=False, name=None)
    }


def column_of(table: str, name: str) -> tuple[str, ...]:
    """Return what columns.csv tells of a column.

    Parameters
    ----------
    table : str
        Study and file, as "stability/steps"; empty for what holds in every table.
    name : str

    Returns
    -------
    tuple of str
        Type, unit and meaning, in the order of TOLD.

    Raises
    ------
    KeyError
        If nothing is told of it.
    """
    known = columns()
    return known.get((table, name)) or known["", name]


def dictionary(published: Path) -> pd.DataFrame:
    """Return a line for each column of every published table: its type, unit and meaning."""
    lines = [
        (f"{path.parent.name}/{path.name}", name, *column_of(table, str(name)))
        for path in sorted(published.glob("*/*.csv*"))
        for table in [f"{path.parent.name}/{path.name.partition('.')[0]}"]
        for name in pd.read_csv(path, nrows=0)
    ]
    return pd.DataFrame(lines, columns=["table", "column", *TOLD])
