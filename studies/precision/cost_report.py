"""What a scene costs, reported: three tables and a figure, from their CSVs alone."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pandas as pd

from studies.drawing.kept import Pictures, keep
from studies.kit.tables import read_table
from studies.measures.costs import LOOPS
from studies.measures.differences import scientific
from studies.measures.words import duration, listed
from studies.precision.starts import starts_text


def report(folder: Path) -> str:
    """Draw a folder's tables; write and return them as text."""
    starts = (folder / "starts.csv").is_file()
    text = "\n\n".join(
        [
            "Where the time of a step goes:\n" + shares_text(read(folder, "shares")),
            "What a scene leaves out, put back one at a time (time over the scene as it is):\n"
            + scenes_text(read(folder, "scenes")),
            "What the exact solution leaves out:\n" + reference_text(read(folder, "reference")),
            *(["What a user waits for:\n" + starts_text(read(folder, "starts"))] if starts else []),
        ]
    )
    return keep(folder, pictures(folder), text, "cost.txt")


def read(folder: Path, name: str) -> pd.DataFrame:
    """Read a table back with empty words as such."""
    return read_table(folder / f"{name}.csv")


def pictures(folder: Path) -> Pictures:
    """Draw a folder's scenes.csv: time and error of each thing put back."""
    from studies.precision.cost_figure import draw_scenes

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


def shares_text(shares: pd.DataFrame) -> str:
    """Return the parts of a step [µs], and the whole over the engine's own part."""
    parts = shares.filter(like="_s") * 1e6
    over = shares["step_s"] / shares["engine_s"]
    shown = parts.rename(columns=lambda name: name.removesuffix("_s") + " µs").map("{:.2f}".format)
    shown["over the engine's"] = over.map("{:.2f}".format)
    named = shares.filter(["engine", "driver"])
    return named.join(shown).replace("nan", "-").to_string(index=False)


def scenes_text(scenes: pd.DataFrame) -> str:
    """Return what each omission costs when it is put back; failures are named below."""
    base = scenes.groupby("engine")["wall_s"].transform("first")
    shown = pd.DataFrame(
        {
            "engine": scenes["engine"].mask(scenes["engine"].duplicated(), ""),
            "put back": scenes["scene"],
            "outcome": scenes["outcome"],
            "error": scenes["error"].map(scientific),
            "steps": scenes["steps"],
            "time": (scenes["wall_s"] / base).map("{:.2f} x".format),
            "step µs": (1e6 * scenes["step_s"]).map("{:.1f}".format),
            "loop": scenes["driver"],
            "runs": scenes["runs"],
            "set-up ms": (1e3 * scenes["setup_s"]).map("{:.2f}".format),
            "memory KiB": scenes["memory_kib"].map("{:.0f}".format),
        }
    )
    notes = [
        f"{engine}, {scene}: {message}"
        for engine, scene, message in scenes[["engine", "scene", "message"]].to_numpy()
        if message
    ]
    return "\n".join([shown.to_string(index=False), *notes])


def reference_text(reference: pd.DataFrame) -> str:
    """Return the times [µs] of the exact solution."""
    table = pd.DataFrame(
        {"exact solution": reference["scene"], "µs": (1e6 * reference["wall_s"]).round(1)}
    )
    return table.to_string(index=False)
