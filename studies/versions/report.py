"""What the releases of the engines say: text, pictures, and the table of what changed."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pandas as pd

from studies.kit import provenance
from studies.kit.tables import write_table
from studies.versions.changes import changes_table
from studies.versions.words import changes_text, first_claim, releases_text, told

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def report(folder: Path) -> str:
    """Write what changed beside a folder's releases.csv, draw both; return them as text."""
    from studies.drawing.figures import save_all

    lines = read(folder, "releases")
    write_table(folder / "changes.csv", changes_table(lines))
    save_all(pictures(folder), folder)
    changes = read(folder, "changes")
    text = "\n".join([releases_text(lines), "", changes_text(changes)])
    provenance.write_text(folder / "findings.txt", text + "\n")
    return text


def read(folder: Path, name: str) -> pd.DataFrame:
    """Read a table back, with empty words as such."""
    words = dict.fromkeys(("release", "before", "source", "set", "note", "link", "message"), str)
    path = folder / f"{name}.csv"
    return pd.read_csv(path, keep_default_na=False, na_values=["nan"], dtype=words)


def headline(folder: Path) -> str:
    """Say between how many releases of each engine the answers changed."""
    return first_claim(read(folder, "releases"), read(folder, "changes"))


def paragraph(folder: Path) -> str:
    """Say of every engine what changed, and what its notes say of it."""
    return told(read(folder, "releases"), read(folder, "changes"))


def pictures(folder: Path) -> dict[str, Figure]:
    """Draw errors by release from a folder's releases.csv and changes.csv alone."""
    from studies.versions.figure import draw_versions

    return {"versions": draw_versions(read(folder, "releases"), read(folder, "changes"))}
