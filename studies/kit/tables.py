"""Tables as text."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from studies.kit.provenance import write_text


def write_table(path: Path, table: pd.DataFrame) -> None:
    """Write a table as CSV, numbers to the bit and missing ones as nan, in one piece."""
    write_text(path, table.to_csv(index=False, na_rep="nan"))


def read_table(path: Path, *words: str) -> pd.DataFrame:
    """Read a table back as it was written: empty words are such, and numbers may be missing.

    Parameters
    ----------
    path : Path
    words : str
        Columns of words that may look like numbers, besides message.
    """
    texts = dict.fromkeys(("message", *words), str)
    return pd.read_csv(path, keep_default_na=False, na_values=["nan"], dtype=texts)


def left_aligned(table: pd.DataFrame) -> str:
    """Return a table of words."""
    width = {name: max(len(str(name)), int(table[name].str.len().max())) for name in table}
    lines = [{name: str(name) for name in table}, *table.to_dict("records")]
    return "\n".join(
        "  ".join(str(line[name]).ljust(width[name]) for name in table).rstrip() for line in lines
    )
