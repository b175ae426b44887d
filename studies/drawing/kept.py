"""What a study leaves beside its tables: its figures, and a text."""

from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from studies.kit.provenance import write_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Pictures: TypeAlias = "dict[str, Figure]"
"""Figures by the names of their files, without .png."""

FINDINGS = "findings.txt"


def keep(folder: Path, drawn: Pictures, text: str, name: str = FINDINGS) -> str:
    """Write a study's figures and its text into its folder; return the text."""
    from studies.drawing.figures import save_all

    save_all(drawn, folder)
    write_text(folder / name, text + "\n")
    return text
