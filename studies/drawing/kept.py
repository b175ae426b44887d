"""What a study leaves beside its tables: its figures, and a text."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, TypeAlias

from studies.old.provenance import write_text
from studies.old.study import Study
from studies.old.tables import in_columns

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

Pictures: TypeAlias = "dict[str, Figure]"
"""Figures by the names of their files, without .png."""

WIDTH = 99
"""Letters of a line of text."""


def tell(study: Study, folder: Path, tables: Mapping[str, pd.DataFrame], finding: str = "") -> str:
    """Write a study's figures and its text into its folder: what it found, and short tables.

    Parameters
    ----------
    study : Study
    folder : Path
    tables : mapping
        Title -> table; those without rows are left out.
    finding : str, optional
        A sentence or a paragraph, by default the study's finding.

    Returns
    -------
    str
        The text.
    """
    return keep(study, folder, as_text(finding or study.finding(folder), tables))


def as_text(finding: str, tables: Mapping[str, pd.DataFrame]) -> str:
    """Return a finding and, under their titles, the tables that have rows.

    Parameters
    ----------
    finding : str
        One paragraph; broken into lines of WIDTH letters.
    tables : mapping
        Title -> table.
    """
    shown = [f"{title}:\n{in_columns(table)}" for title, table in tables.items() if len(table)]
    return "\n\n".join([fill(finding, WIDTH), *shown])


def keep(study: Study, folder: Path, text: str) -> str:
    """Write a study's figures and its text, the first that it writes besides, into its folder.

    Parameters
    ----------
    study : Study
    folder : Path
        With the tables that the figures are drawn from.
    text : str

    Returns
    -------
    str
        The text.
    """
    if drawn := study.pictures(folder):
        from studies.drawing.figures import save_all

        save_all(drawn, folder)
    write_text(folder / study.others[0], text + "\n")
    return text
