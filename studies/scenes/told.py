"""What a reader is told of each scene: a drawing, errors and times of its engines, the worst."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from analytic import CartBlock, RockingFrame, SlidingBlock
from analytic.response import Outcome
from engines.layouts import System
from studies.drawing.kept import Pictures
from studies.drawing.styles import name_of
from studies.kit import provenance
from studies.kit.tables import read_table
from studies.measures.again import commands, with_commands
from studies.measures.presets import is_engine
from studies.measures.words import part
from studies.measures.wrongness import FALL, NO_ANSWER, REST, counted, kinds_of
from studies.scenes.carts import carts
from studies.scenes.cases import jobs
from studies.scenes.rolling import CYLINDERS, cylinder_lines


def millimetres(size: float) -> str:
    """Return a length [m] in words."""
    return f"{float(f'{1e3 * size:.2g}'):g} mm"


class Told(NamedTuple):
    """How a scene is told: its table is NAME.csv, and the `error` one of its columns.

    It is drawn at a rotation [rad], or a place [m] where nothing rocks; `words` says an error.
    """

    title: str
    system: System
    at: float
    error: str
    words: Callable[[float], str]
    along: str


SCENES = {
    "frame": Told(
        title="a rocking frame",
        system=RockingFrame(width=0.5, height=1.5, columns=2, load=2.0),
        at=0.12,
        error="error",
        words=part,
        along="error of the largest rotation, relative  [–]",
    ),
    "slide": Told(
        title="a sliding block",
        system=SlidingBlock(width=1.0, height=0.5, friction=0.2),
        at=0.3,
        error="slip_error_m",
        words=millimetres,
        along="error of a slip  [m]",
    ),
    "cart": Told(
        title="a block on a cart",
        system=CartBlock(width=0.5, height=1.5, mass_ratio=0.5),
        at=0.12,
        error="error",
        words=part,
        along="error of the largest rotation, relative  [–]",
    ),
}
"""Scenes that have a section of their own, by name."""


def lines_of(path: Path, name: str) -> pd.DataFrame:
    """Return a line for each engine and preset that was asked about a scene.

    Parameters
    ----------
    path : Path
        The scene's table.
    name : str
        Of the scene.

    Returns
    -------
    DataFrame
        source, cases, how many are wrong by kind, median_error and largest_error, in the unit of
        the scene's error, and ms: the mean time of a case.
    """
    rows, error = asked(path, name), SCENES[name].error
    lines = [
        {
            "source": source,
            "cases": len(mine),
            **counted(kinds_in(mine, error)),
            "median_error": mine[error].abs().median(),
            "largest_error": mine[error].abs().max(),
            "ms": 1e3 * mine["wall_s"].mean(),
        }
        for source, mine in rows.groupby("source", sort=False)
    ]
    return pd.DataFrame(lines, columns=COLUMNS)


COLUMNS = (
    *("source", "cases", FALL, REST, NO_ANSWER),
    *("median_error", "largest_error", "ms"),
)
"""Of `lines_of`."""


def asked(path: Path, name: str) -> pd.DataFrame:
    """Return the rows of a scene's engines, without those that are not built for it."""
    rows = found_in(path)
    if rows.empty:
        return pd.DataFrame(columns=["source", SCENES[name].error, "wall_s"])
    kept = rows["source"].map(is_engine) & (rows["reason"] != "UNAVAILABLE")
    return rows[kept & (rows["refined"] == 1.0) if "refined" in rows else kept]


def found_in(path: Path) -> pd.DataFrame:
    """Read a table; one of a scene that nobody who was asked holds is blank, or not there."""
    filled = path.is_file() and path.read_bytes().strip()
    return read_table(path) if filled else pd.DataFrame(columns=["source"])


def kinds_in(rows: pd.DataFrame, error: str) -> pd.Series[str]:
    """Return the kind of each wrong outcome: by the exact peak, or else by the error's absence."""
    if "exact" in rows:
        peak = rows["exact"].to_numpy(float)
        right = np.select(
            [np.isinf(peak), peak == 0.0],
            [Outcome.OVERTURNED.value, Outcome.AT_REST.value],
            Outcome.ROCKED.value,
        )
        return pd.Series(kinds_of(rows["outcome"], right), rows.index)
    found, lost = rows["outcome"], rows[error].isna()
    failed, fell = found == Outcome.FAILED.value, found == Outcome.OVERTURNED.value
    return pd.Series(np.select([failed, fell, lost], [NO_ANSWER, FALL, REST], ""), rows.index)


def shown(folder: Path) -> dict[str, pd.DataFrame]:
    """Return the lines of each scene's engines, by title."""
    return {
        f"Engines on {told.title}": lines_of(folder / f"{name}.csv", name)
        for name, told in SCENES.items()
    }


def again(folder: Path) -> pd.DataFrame:
    """Return each scene's cases in which an engine errs most, with the commands that ask them.

    Those whose outcome is wrong come first, then those with the largest error.
    """
    worst = {}
    for name, told in SCENES.items():
        rows = asked(folder / f"{name}.csv", name)
        wrong = kinds_in(rows, told.error) != "" if len(rows) else pd.Series(dtype=bool)
        size = rows[told.error].abs().where(~wrong, np.inf).groupby(rows["source"], sort=False)
        places = size.idxmax()
        for place in places.loc[size.max().sort_values(ascending=False, kind="stable").index]:
            worst[name, place] = {"scene": name, **rows.loc[place].dropna().to_dict()}
    quick = bool(provenance.record_of(folder)["settings"]["quick"])
    sources = list(dict.fromkeys(row["source"] for row in worst.values()))
    every = [*jobs(sources, quick), *carts(sources, quick)]
    known = {_called({**job.labels, "source": job.source}): job for job in every}
    found = []
    for row in worst.values():
        job = next(job for names, job in known.items() if names <= _called(row))
        found.append(commands(job.block, job.motion, job.source, job.options,
                              outcome=row["outcome"]))  # fmt: skip
    table = pd.DataFrame(worst.values(), columns=["scene", "source", "outcome", *ERRORS])
    return with_commands(table, found)


ERRORS = tuple(dict.fromkeys(told.error for told in SCENES.values()))
"""Columns of errors."""


def _called(row: dict[str, object]) -> frozenset[tuple[str, object]]:
    return frozenset(row.items())


def drawings(folder: Path) -> Pictures:
    """Draw each scene, and its engines' errors against their times."""
    from studies.drawing.block import draw_scene
    from studies.scenes.figure import draw_rolling, draw_times

    drawn = {f"{name}-scene": draw_scene(told.system, told.at) for name, told in SCENES.items()}
    for name, told in SCENES.items():
        if len(lines := lines_of(folder / f"{name}.csv", name)):
            found = _finding(told.title, told.words, lines)
            drawn[f"{name}-time"] = draw_times(lines, found, told.along)
    if len(lines := cylinder_lines(found_in(folder / "cylinder.csv"))):
        found = _finding("rolling", "{:.1g}".format, lines)
        along = "error of the tilt after five turns  [rad]"
        drawn["cylinder-scene"] = draw_rolling(CYLINDERS[0])
        drawn["cylinder-time"] = draw_times(lines, found, along)
    return drawn


def _finding(title: str, words: Callable[[float], str], lines: pd.DataFrame) -> str:
    """Say between which median errors the engines of a scene lie, and whose these are."""
    ranked = lines.dropna(subset="median_error").sort_values("median_error")
    low, high = (
        f"{words(ranked['median_error'].iloc[end])} ({name_of(ranked['source'].iloc[end])})"
        for end in (0, -1)
    )
    return f"{title.capitalize()}: median errors from {low} to {high}"
