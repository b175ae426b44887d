"""What a study leaves beside its tables: its figures, and a text."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, TypeAlias

from studies.kit.provenance import write_text
from studies.kit.tables import in_columns

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

Pictures: TypeAlias = "dict[str, Figure]"
"""Figures by the names of their files, without .png."""

FINDINGS = "findings.txt"
WIDTH = 99
"""Letters of a line of text."""


def tell(
    folder: Path,
    drawn: Pictures,
    finding: str,
    tables: Mapping[str, pd.DataFrame],
    name: str = FINDINGS,
) -> str:
    """Write a study's figures and its text into its folder: what it found, and short tables.

    Parameters
    ----------
    folder : Path
    drawn : dict
    finding : str
        A sentence or a paragraph.
    tables : mapping
        Title -> table; those without rows are left out.
    name : str, optional
        Of the text's file.

    Returns
    -------
    str
        The text.
    """
    return keep(folder, drawn, as_text(finding, tables), name)


def as_text(finding: str, tables: Mapping[str, pd.DataFrame]) -> str:
    """Return a finding and, under their titles, the tables that have rows."""
    shown = [f"{title}:\n{in_columns(table)}" for title, table in tables.items() if len(table)]
    return "\n\n".join([fill(finding, WIDTH), *shown])


def keep(folder: Path, drawn: Pictures, text: str, name: str = FINDINGS) -> str:
    """Write a study's figures and its text into its folder; return the text."""
    from studies.drawing.figures import save_all

    save_all(drawn, folder)
    write_text(folder / name, text + "\n")
    return text
