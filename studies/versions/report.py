"""What the releases of the engines say: text, pictures, and the table of what changed."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from studies.drawing.kept import Pictures, tell
from studies.kit.tables import read_table, write_table
from studies.measures.words import listed, out_of
from studies.versions.tables import CHANGED, answered, changes_table, is_changed

SHOWN = [
    *("engine", "release", "source", "set", "cases", "failed", "right"),
    *("median_error", "p90_error", "max_error", "moved", "turned", "message"),
]


def report(folder: Path) -> str:
    """Write what changed beside a folder's releases.csv, draw both; return them as text."""
    lines = read(folder, "releases")
    write_table(folder / "changes.csv", changes_table(lines))
    other = lines["moved"].isna() | is_changed(lines)
    tables = {
        f"Answers that moved by more than {CHANGED:g}, or turned into another outcome": (
            read(folder, "changes")
        ),
        "Errors of the peak, relative, over cases that both survive, of the first release and of "
        "those that do not answer as the one before": lines.loc[other, SHOWN],
    }
    return tell(folder, pictures(folder), headline(folder), tables)


def read(folder: Path, name: str) -> pd.DataFrame:
    """Read a table back, with empty words as such."""
    words = ("release", "before", "source", "set", "note", "link")
    return read_table(folder / f"{name}.csv", *words)


def headline(folder: Path) -> str:
    """Say between how many releases of each engine the answers changed."""
    return first_claim(read(folder, "releases"), read(folder, "changes"))


def first_claim(lines: pd.DataFrame, changes: pd.DataFrame) -> str:
    """Say between which releases of which engines an answer moved, and between which none did."""
    moved, still = [], []
    for engine, mine in answered(lines).groupby("engine", sort=False):
        releases = mine["release"].unique()
        times = len(changes[changes["engine"] == engine])
        name = f"{engine} ({releases[0]} to {releases[-1]}"
        if times:
            moved.append(f"{name}, at {out_of(times, len(releases) - 1)} steps)")
        elif len(releases) > 1:
            still.append(f"{name})")
    if not (moved or still):
        return "Of each engine one release was asked."
    bound, words = f"by more than {CHANGED:g}", []
    if still:
        words.append(f"no answer moves {bound} in {listed(still)}")
    if moved:
        words.append(f"{'some do' if still else f'answers move {bound}'} in {listed(moved)}")
    return f"From one release to the next {'; '.join(words)}."


def pictures(folder: Path) -> Pictures:
    """Draw errors by release from a folder's releases.csv and changes.csv alone."""
    from studies.versions.figure import draw_versions

    return {"versions": draw_versions(read(folder, "releases"), read(folder, "changes"))}
