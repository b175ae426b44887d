"""What free rocking shows: the largest errors of period, decay and drift, in tables and words."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from studies.drawing.kept import Pictures, tell
from studies.free.errors import IMPACTS
from studies.measures.differences import scientific


def report(folder: Path) -> str:
    """Reduce and draw a folder's free.csv; write and return the text."""
    rows = read(folder)
    tables = {
        f"Largest relative error of the time between impacts and of the next rotation, and drift "
        f"over up to {IMPACTS} impacts [1/p]": errors(rows, ["source", "tilt"]).reset_index()
    }
    return tell(folder, pictures(folder), headline(folder), tables)


def read(folder: Path) -> pd.DataFrame:
    """Read a free.csv back."""
    return pd.read_csv(folder / "free.csv", dtype={"message": str}).fillna({"message": ""})


def errors(rows: pd.DataFrame, by: list[str]) -> pd.DataFrame:
    """Return the largest errors of each group of rows."""
    sizes = rows.assign(drift_p=rows["drift_p"].abs())
    return sizes.groupby(by, sort=False)[["period_error", "decay_error", "drift_p"]].max()


def headline(folder: Path) -> str:
    """Say to what each source follows the closed forms of its model, at worst."""
    worst = errors(read(folder), ["source"])[["period_error", "decay_error"]].max(axis=1)
    words = [f"{name} {scientific(value)}" for name, value in worst.items()]
    return f"Free rocking follows the closed forms, at worst to: {', '.join(words)}."


def pictures(folder: Path) -> Pictures:
    """Draw the errors of a folder from its free.csv alone."""
    from studies.free.figure import draw_free

    return {"free": draw_free(read(folder))}
