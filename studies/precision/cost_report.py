"""What a scene costs, reported: three tables and a figure, from their CSVs alone."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pandas as pd

from studies.drawing.kept import Pictures, tell
from studies.kit.tables import read_table
from studies.measures.costs import LOOPS
from studies.measures.words import duration, listed


def report(folder: Path) -> str:
    """Draw a folder's tables; write and return them as text."""
    shares, scenes, reference = (read(folder, name) for name in ("shares", "scenes", "reference"))
    as_it_is = scenes.groupby("engine")["wall_s"].transform("first")
    tables = {
        "Where the time of a step goes, and the step over the engine's own part": (
            shares.assign(over_engine=shares["step_s"] / shares["engine_s"])
        ),
        "What a scene leaves out, put back one at a time; cost: time over the scene as it is": (
            scenes.assign(cost=scenes["wall_s"] / as_it_is).drop(columns="message")
        ),
        "What an engine cannot put back": (
            scenes.loc[scenes["message"] != "", ["engine", "scene", "message"]]
        ),
        "What the exact solution leaves out": reference,
    }
    if (folder / "starts.csv").is_file():
        tables["How long a user waits, and over R, the time of `import numba, pandas`"] = read(
            folder, "starts"
        )
    return tell(folder, pictures(folder), headline(folder), tables, "cost.txt")


def read(folder: Path, name: str) -> pd.DataFrame:
    """Read a table back with empty words as such."""
    return read_table(folder / f"{name}.csv")


def pictures(folder: Path) -> Pictures:
    """Draw a folder's scenes.csv: time and error of each thing put back."""
    from studies.precision.figure import draw_scenes

    return {"cost": draw_scenes(read(folder, "scenes"))}


def headline(folder: Path) -> str:
    """Say how long a step takes with each loop, and how much of that is the engine's own."""
    shares = read(folder, "shares").dropna(subset=["step_s"])
    words = [
        f"{listed([_step(line) for _, line in lines.iterrows()])} with {engine}"
        for engine, lines in shares.groupby("engine", sort=False)
    ]
    return f"A step of the stepping loop takes {', '.join(words)}."


def _step(line: pd.Series[Any]) -> str:
    """Return how long a step takes, who takes it, and what of it is the engine's own."""
    own = line["engine_s"]
    part = "" if math.isnan(own) else f" (the engine's own {duration(own)})"
    return f"{duration(line['step_s'])} {LOOPS[line['driver'].lower()]}{part}"
