"""What the releases of the engines say: text, pictures, and the table of what changed."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from studies.drawing.kept import Pictures, keep
from studies.kit.tables import read_table, write_table
from studies.versions.changes import changes_table
from studies.versions.words import changes_text, first_claim, releases_text


def report(folder: Path) -> str:
    """Write what changed beside a folder's releases.csv, draw both; return them as text."""
    lines = read(folder, "releases")
    write_table(folder / "changes.csv", changes_table(lines))
    changes = read(folder, "changes")
    return keep(
        folder, pictures(folder), "\n".join([releases_text(lines), "", changes_text(changes)])
    )


def read(folder: Path, name: str) -> pd.DataFrame:
    """Read a table back, with empty words as such."""
    words = ("release", "before", "source", "set", "note", "link")
    return read_table(folder / f"{name}.csv", *words)


def headline(folder: Path) -> str:
    """Say between how many releases of each engine the answers changed."""
    return first_claim(read(folder, "releases"), read(folder, "changes"))


def pictures(folder: Path) -> Pictures:
    """Draw errors by release from a folder's releases.csv and changes.csv alone."""
    from studies.versions.figure import draw_versions

    return {"versions": draw_versions(read(folder, "releases"), read(folder, "changes"))}
