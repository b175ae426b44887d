"""Tables as files and as text."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

import pandas as pd

from studies.old.journal import PACKED
from studies.old.provenance import write_text

SMALL = 1e-2
"""Numbers below are shown as powers of ten."""

SHOWN = 60
"""Rows of a table that are shown as text; its CSV has all."""


FORMULA = re.compile(r"'*[=+\-@].+")
"""Words in one line that a spreadsheet takes for a formula, or that were quoted once."""


def quoted(word: object) -> object:
    """Return a word with an apostrophe before it if a spreadsheet would take it for a formula."""
    if not isinstance(word, str) or not FORMULA.fullmatch(word):
        return word
    with suppress(ValueError):
        float(word)
        return word
    return f"'{word}"


def unquoted(word: object) -> object:
    """Return a word as it was before it was `quoted`."""
    bare = word[1:] if isinstance(word, str) and word.startswith("'") else word
    return bare if quoted(bare) == word else word


def _words(table: pd.DataFrame) -> list[str]:
    return [str(name) for name in table if not pd.api.types.is_numeric_dtype(table[name])]


def write_table(path: Path, table: pd.DataFrame) -> None:
    """Write a table as CSV, numbers to the bit and missing ones as nan, in one piece.

    A word that a spreadsheet would take for a formula is `quoted`.

    Parameters
    ----------
    path : Path
    table : DataFrame
        Its index is not written.

    Raises
    ------
    OSError
        That names `path`.
    """
    safe = table.assign(**{name: table[name].map(quoted) for name in _words(table)})
    write_text(path, safe.to_csv(index=False, na_rep="nan"))


COLUMNS = Path(__file__).parents[1] / "published" / "columns.csv"
"""The columns of every published table."""


def with_head(table: pd.DataFrame, folders: Iterable[str], name: str) -> pd.DataFrame:
    """Return a table; one that has no columns with those of the published one.

    Parameters
    ----------
    table : DataFrame
    folders : iterable of str
        Where its study is published.
    name : str
        Of its file, without .csv.
    """
    if len(table.columns):
        return table
    known = pd.read_csv(COLUMNS, keep_default_na=False)
    mine = known["table"].isin(
        [f"{each}/{name}.csv{end}" for each in folders for end in ("", PACKED)]
    )
    return pd.DataFrame(columns=known.loc[mine, "column"].drop_duplicates())


def read_table(path: Path, *words: str) -> pd.DataFrame:
    """Read a table back as it was written: empty words are such, and numbers may be missing.

    A blank file is a table without columns.

    Parameters
    ----------
    path : Path
    words : str
        Columns of words that may look like numbers, besides message.
    """
    texts = dict.fromkeys(("message", *words), str)
    try:
        table = pd.read_csv(path, keep_default_na=False, na_values=["nan"], dtype=texts)
    except pd.errors.EmptyDataError:
        return pd.DataFrame()
    return table.assign(**{name: table[name].map(unquoted) for name in _words(table)})


def table_in(folder: Path, name: str, *words: str) -> pd.DataFrame:
    """Read a table of a folder, packed or not.

    Parameters
    ----------
    folder : Path
    name : str
        Of the file, without .csv; of both the one that is not packed is read, the newer.
    words : str
        As for `read_table`.

    Returns
    -------
    DataFrame
        Empty where there is no such file.
    """
    paths = (folder / f"{name}.csv", folder / f"{name}.csv{PACKED}")
    return next((read_table(path, *words) for path in paths if path.is_file()), pd.DataFrame())


def figure(value: object) -> str:
    """Return a value as a reader sees it: a number in three digits, a dash for none."""
    if not isinstance(value, float):
        return str(value)
    if math.isnan(value):
        return "-"
    return f"{value:.1e}" if 0.0 < abs(value) < SMALL else f"{value:.3g}"


def in_columns(table: pd.DataFrame) -> str:
    """Return a table as aligned text, words to the left and numbers to the right."""
    numeric = [pd.api.types.is_numeric_dtype(kind) for kind in table.dtypes]
    rows = [list(map(str, table.columns)), *table.head(SHOWN).map(figure).to_numpy().tolist()]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = [
        "  ".join(
            word.rjust(width) if right else word.ljust(width)
            for word, width, right in zip(row, widths, numeric, strict=True)
        ).rstrip()
        for row in rows
    ]
    more = len(table) - SHOWN
    return "\n".join([*lines, *([f"and {more} more rows"] if more > 0 else [])])
