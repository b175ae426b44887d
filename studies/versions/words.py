"""What was found of the releases, in words and as tables."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pandas as pd

from studies.kit.tables import in_columns
from studies.measures.differences import scientific
from studies.measures.words import listed, out_of, part
from studies.versions.tables import CHANGED


def releases_text(lines: pd.DataFrame) -> str:
    """Return the table of releases: errors of the peak, and moves from the release before."""
    answered = lines["source"] != ""
    shown = pd.DataFrame(
        {
            "release": lines["engine"] + " " + lines["release"],
            "preset": lines["source"].str.partition(":")[2],
            "set": lines["set"],
            "right": [_right(line) if line["source"] else "" for _, line in lines.iterrows()],
            "median": lines["median_error"].map(scientific),
            "p90": lines["p90_error"].map(scientific),
            "max": lines["max_error"].map(scientific),
            "moved": lines["moved"].map(scientific),
            "": lines["message"].where(~answered | (lines["failed"] > 0), ""),
        }
    )
    shown["release"] = shown["release"].mask(shown["release"].eq(shown["release"].shift()), "")
    head = (
        "Errors of the peak are relative to the exact one, over cases that both survive; moved is\n"
        "the largest relative difference of a peak from that in the release before:"
    )
    return f"{head}\n{in_columns(shown.astype(str))}"


def _right(line: pd.Series[float]) -> str:
    return f"{line['right']:.0f}/{line['cases']:.0f}"


def changes_text(changes: pd.DataFrame) -> str:
    """Return what changed between releases, with what their notes say."""
    if changes.empty:
        return f"No answer moved by more than {CHANGED:g} between two of these releases."
    lines = [f"Answers that moved by more than {CHANGED:g}, or turned into another outcome:"]
    for row in changes.to_dict("records"):
        lines.append(
            f"{row['engine']} {row['before']} -> {row['release']} ({row['presets']}): {_moved(row)}"
        )
        if row["note"]:
            lines.append(f"    {row['note']}\n    {row['link']}")
    return "\n".join(lines)


def _moved(row: Mapping[Any, Any]) -> str:
    counted = out_of(row["moved_cases"], row["cases"])
    words = [f"{counted} peaks by up to {part(float(row['moved']))}"]
    if row["turned"]:
        words.append(f"{row['turned']} outcomes turned")
    return listed(words)


def first_claim(lines: pd.DataFrame, changes: pd.DataFrame) -> str:
    """Say between which releases of which engines an answer moved, and between which none did."""
    moved, still = [], []
    for engine, mine in _answered(lines).groupby("engine", sort=False):
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


def _answered(lines: pd.DataFrame) -> pd.DataFrame:
    return lines[lines["failed"] < lines["cases"]]
