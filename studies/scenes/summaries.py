"""The tables of the scenes: the rows of each, and a line for each source."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import pandas as pd

from analytic.response import Outcome
from engines.run.drive import LAG
from studies.old.journal import Row
from studies.old.plan import Tables
from studies.measures.presets import engine_of
from studies.measures.wrongness import counted, kinds_of, outcomes_of
from studies.scenes import KINDS, frames

FLOOR = ["engine", "floor", "carried", "carried_after_rest", LAG]
BLOCK = ["source", "blocks", "median_error", "median_own_error", LAG]
"""Columns of tables that have heads even where nobody was asked."""


def tabulate(rows: Sequence[Row]) -> Tables:
    """Return the rows of each scene, and a line for each source that is built for it."""
    parts = {name: pd.DataFrame([row for row in rows if row["scene"] == name]) for name in KINDS}
    held = {name: part if part.empty else built(part) for name, part in parts.items()}
    of_frame = held["frame"]
    return {
        **parts,
        "frame-summary": lines(of_frame, of_frames, where="refined == 1 and not extreme"),
        "frame-extremes": lines(of_frame, of_extremes, "columns", "load", where="extreme"),
        "frame-steps": lines(of_frame, of_frame_steps, "refined", where=are(frames.AGAIN)),
        "slide-summary": lines(held["slide"], of_slides),
        "floor-summary": lines(parts["floor"], of_floors, "floor", ascending=False).reindex(
            columns=FLOOR
        ),
        "block-summary": lines(parts["block"], of_blocks).reindex(columns=BLOCK),
    }


def built(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of what an engine is built for."""
    return rows[rows["reason"].fillna("") != "UNAVAILABLE"]


def are(labels: Mapping[str, float]) -> str:
    """Return the query for the rows with some labels."""
    return " and ".join(f"{name} == {value!r}" for name, value in labels.items())


def lines(
    rows: pd.DataFrame,
    line: Callable[[pd.DataFrame], dict[str, Any]],
    *labels: str,
    where: str = "",
    ascending: bool = True,
) -> pd.DataFrame:
    """Return a line for each source, or for each of its rows that have some labels alike.

    Parameters
    ----------
    rows : DataFrame
    line : callable
        What is told of some rows of a source.
    *labels : str
        Columns.
    where : str, optional
        A query for the rows of which something is told; by default all.
    ascending : bool, optional
        Whether the labels do; if not, they are in the order of the rows.
    """
    if rows.empty:
        return pd.DataFrame()
    kept = rows.query(where) if where else rows
    found = [
        {"source": source, **dict(zip(labels, key, strict=False)), **line(group)}
        for source, part in kept.groupby("source", sort=False)
        for key, group in (part.groupby([*labels], sort=ascending) if labels else [((), part)])
    ]
    return pd.DataFrame(found)


def errors_of(rows: pd.DataFrame) -> dict[str, Any]:
    """Return the median and the largest error of some peaks."""
    size = rows["error"].abs()
    return {"median_error": size.median(), "largest_error": size.max()}


def us_a_step(rows: pd.DataFrame) -> float:
    """Return the mean time of a step [µs]."""
    return float(1e6 * rows["wall_s"].sum() / max(int(rows["steps"].sum()), 1))


def _right(rows: pd.DataFrame, name: str) -> dict[str, Any]:
    return {"wrong": int((~rows[name].astype(bool)).sum()), **errors_of(rows)}


def of_frames(rows: pd.DataFrame) -> dict[str, Any]:
    """Return how many frames are wrong, and how far off the others."""
    return {
        **{"frames": len(rows), **_right(rows, "right")},
        "beyond_2_percent": int((rows["error"].abs() > 0.02).sum()),
        **{name: rows[name].max() for name in frames.SEEN},
        "ms_a_frame": 1e3 * rows["wall_s"].mean(),
    }


def of_frame_steps(rows: pd.DataFrame) -> dict[str, Any]:
    """Return the same of the frame that is asked in several steps, with the cost of one."""
    return {"frames": len(rows), **_right(rows, "right"), "us_a_step": us_a_step(rows)}


def of_extremes(rows: pd.DataFrame) -> dict[str, Any]:
    """Return how many extreme frames are wrong, by kind, and how far off the others."""
    kinds = pd.Series(kinds_of(rows["outcome"], outcomes_of(rows["exact"])))
    seen = {"parting": rows["parting"].max()}
    return {"frames": len(rows), **counted(kinds), **errors_of(rows), **seen}


def of_slides(rows: pd.DataFrame) -> dict[str, Any]:
    """Return the largest error of a slip, its creep and how high it lifted."""
    slides, held = rows["exact_slips"] > 0, rows["exact_slips"] == 0
    kept = held & (rows["outcome"] == Outcome.AT_REST.value)
    return {
        "slides": len(rows),
        "wrong": int((rows["slip_error_m"].isna() & ~kept).sum()),
        "largest_slip_error_m": rows.loc[slides, "slip_error_m"].max(),
        "creep_m": rows.loc[held, "slip_error_m"].max(),
        "lift_m": rows["lift_m"].max(),
        "ms_a_slide": 1e3 * rows["wall_s"].mean(),
    }


def of_floors(rows: pd.DataFrame) -> dict[str, Any]:
    """Return how far a floor carried a block, at once and after a rest, and how far it lagged."""
    rested = rows["rest_s"] > 0.0
    return {
        "engine": engine_of(str(rows["source"].iloc[0])),
        "carried": rows.loc[~rested, "carried"].max(),
        "carried_after_rest": rows.loc[rested, "carried"].max(),
        LAG: rows[LAG].max(),
    }


def of_blocks(rows: pd.DataFrame) -> dict[str, Any]:
    """Return how far off peaks are, and how far on the floor that was made."""
    return {
        "blocks": len(rows),
        "median_error": rows["error"].abs().median(),
        "median_own_error": rows["own_error"].abs().median(),
        LAG: rows[LAG].max(),
    }
