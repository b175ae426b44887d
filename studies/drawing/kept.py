"""What a study leaves beside its tables: its figures, and a text."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from studies.kit.provenance import write_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FINDINGS = "findings.txt"


def keep(folder: Path, drawn: "Mapping[str, Figure]", text: str, name: str = FINDINGS) -> str:
    """Write a study's figures and its text into its folder; return the text."""
    from studies.drawing.figures import save_all

    save_all(drawn, folder)
    write_text(folder / name, text + "\n")
    return text
