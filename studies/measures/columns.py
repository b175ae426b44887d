"""What every column of every table means, from columns.csv beside this file.

A line there is for the columns of that name in all tables, or in the one that it names.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pandas as pd

TOLD = ("type", "unit", "meaning")
"""What is told of a column: text, boolean, integer (what counts) or number; its unit; its meaning.

The unit of a number without one is "-".
"""


@cache
def columns() -> dict[tuple[str, str], tuple[str, ...]]:
    """Return what is told of a column, by table (empty: any) and name."""
    lines = pd.read_csv(Path(__file__).with_suffix(".csv"), keep_default_na=False)
    return {
        (str(table), str(name)): tuple(map(str, told))
        for table, name, *told in lines.itertuples(index=False, name=None)
    }


def column_of(table: str, name: str) -> tuple[str, ...]:
    """Return type, unit and meaning of a column of a table, called as its study and file."""
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
