"""What a reader is told of each scene: a drawing, errors and times of its engines, the worst."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from analytic import RockingFrame, SlidingBlock
from analytic.response import Outcome
from engines import ENGINES
from studies.drawing.styles import name_of
from studies.old.tables import read_table
from studies.measures.presets import engine_of, in_order, in_words, is_engine, preset_of
from studies.measures.words import listed, out_of, part
from studies.measures.wrongness import FALL, KINDS, NO_ANSWER, REST, counted, kinds_of, outcomes_of
from studies.scenes.frames import COLUMNS as COLUMNS_OF_FRAMES
from studies.scenes.frames import LOADS, PHASES
from studies.scenes.places import PULSES


def millimetres(size: float) -> str:
    """Return a length [m] in words."""
    return f"{float(f'{1e3 * size:.2g}'):g} mm"


class Told(NamedTuple):
    """How a scene is told: its table is NAME.csv, and the `error` one of its columns.

    Attributes
    ----------
    title, asked : str
        What it is, and which of its cases an engine was asked.
    system : System
        What is drawn, at the rotation `at` [rad], or the place [m] where nothing rocks.
    error, words, along : str, callable, str
        Column of the error, how one is said, and what stands along its axis.
    subject : str
        What is off, as a sentence begins.
    """

    title: str
    asked: str
    system: Any
    at: float
    error: str
    words: Callable[[float], str]
    along: str
    subject: str


SCENES = {
    "frame": Told(
        title="a rocking frame",
        asked=(
            f"{listed([f'{count}' for count in COLUMNS_OF_FRAMES])} columns under beams of "
            f"{listed([f'{load:g}' for load in LOADS])} times their mass, {len(PULSES)} pulses; "
            f"equal steps at {PHASES} places of the first impact in a step"
        ),
        system=RockingFrame(width=0.5, height=1.5, columns=2, load=2.0),
        at=0.12,
        error="error",
        words=part,
        along="error of the largest rotation, relative  [–]",
        subject="The peak of a rocking frame is",
    ),
    "slide": Told(
        title="a sliding block",
        asked="a pulse at three coefficients of friction, a launched cube, and a block that holds",
        system=SlidingBlock(width=1.0, height=0.5, friction=0.2),
        at=0.3,
        error="slip_error_m",
        words=millimetres,
        along="error of a slip  [m]",
        subject="The slips of a block are",
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
    for column, value in OWN.items():
        if column in rows:
            kept &= rows[column] == value
    return rows[kept]


OWN = {"refined": 1.0, "extreme": False}
"""Columns of rows that differ in steps or are extreme, and which are told."""


def found_in(path: Path) -> pd.DataFrame:
    """Read a table; one of a scene that nobody who was asked holds is blank, or not there."""
    filled = path.is_file() and path.read_bytes().strip()
    return read_table(path) if filled else pd.DataFrame(columns=["source"])


def kinds_in(rows: pd.DataFrame, error: str) -> pd.Series[str]:
    """Return the kind of each wrong outcome: by the exact peak, or else by the error's absence."""
    if "exact" in rows:
        return pd.Series(kinds_of(rows["outcome"], outcomes_of(rows["exact"])), rows.index)
    found, lost = rows["outcome"], rows[error].isna()
    failed, fell = found == Outcome.FAILED.value, found == Outcome.OVERTURNED.value
    return pd.Series(np.select([failed, fell, lost], [NO_ANSWER, FALL, REST], ""), rows.index)


def by_scene(folder: Path) -> dict[str, pd.DataFrame]:
    """Return the lines of each scene's engines, by the name of a scene that one of them holds."""
    lines = {name: lines_of(folder / f"{name}.csv", name) for name in SCENES}
    return {name: mine for name, mine in lines.items() if len(mine)}


def shown(folder: Path) -> dict[str, pd.DataFrame]:
    """Return the same by title."""
    return {f"Engines on {SCENES[name].title}": it for name, it in by_scene(folder).items()}


LATE_M = 1e-4
"""From which lag on a floor is late [m]."""

RIDES = 0.9
"""Part of a floor's way over which a block that rides on it is carried at least."""


def sentence(name: str, lines: pd.DataFrame) -> str:
    """Say for each preset how far off a scene's engines are, and how many outcomes are wrong.

    Parameters
    ----------
    name : str
        Of the scene.
    lines : DataFrame
        As of `lines_of`; without any nothing is said.
    """
    told, said = SCENES[name], []
    presets = lines["source"].map(preset_of)
    for preset in in_order(presets):
        mine = lines[presets == preset]
        wrong = int(mine[list(KINDS)].to_numpy().sum())
        beside = f" ({out_of(wrong, mine['cases'].sum())} wrong)" if wrong else ""
        said.append(f"{told.words(mine['largest_error'].max())}{beside} {in_words(preset)}")
    return f"{told.subject} off by up to {listed(said)}." if said else ""


def ranked(lines: pd.DataFrame, words: Callable[[float], str]) -> tuple[str, str]:
    """Return the least and the largest median error in words, and in brackets whose each is.

    Parameters
    ----------
    lines : DataFrame
        As of `lines_of`; lines without a median are passed over.
    words : callable
        Says an error in the scene's unit.
    """
    known = lines.dropna(subset="median_error").sort_values("median_error")
    low, high = (
        f"{words(known['median_error'].iloc[end])} ({name_of(known['source'].iloc[end])})"
        for end in (0, -1)
    )
    return low, high


def ends(name: str, lines: pd.DataFrame) -> str:
    """Say by how much a scene is off at most: with the first preset asked, and each engine's best.

    Parameters
    ----------
    name : str
        A key of SCENES.
    lines : DataFrame
        From `lines_of`, one at least.

    Returns
    -------
    str
        Largest errors in the scene's unit, "50 % → 10⁻⁵", over all engines; one number where one
        preset was asked.
    """
    presets = lines["source"].map(preset_of)
    known = in_order(presets)
    sizes = [it["largest_error"].max() for it in (lines[presets == known[0]], best_of(lines))]
    return " → ".join(map(SCENES[name].words, sizes[: len(known)]))


def best_of(lines: pd.DataFrame) -> pd.DataFrame:
    """Return the lines of the last, which is the best, of each engine's presets."""
    presets = lines["source"].map(preset_of)
    places = presets.map(in_order(presets).index)
    return lines.loc[places.groupby(lines["source"].map(engine_of), sort=False).idxmax()]


def cases_of(lines: pd.DataFrame) -> str:
    """Return how many cases presets were asked, in words: "72 or 18"."""
    return listed([f"{count}" for count in sorted(set(lines["cases"]), reverse=True)], "or")


def floor_sentence(lines: pd.DataFrame) -> str:
    """Say which ways of moving a floor carry a block, and which not; empty without any."""
    if lines.empty:
        return ""
    alone = lines["floor"] == "position"
    left = lines[~alone & (lines["carried"] > RIDES) & ~(lines["carried_after_rest"] > RIDES)]
    asleep = [ENGINES[str(name)].title for name in left["engine"].unique()]
    slept = f"; after a second of rest it sleeps on in {listed(asleep)}" if asleep else ""
    most, least = lines.loc[alone, "carried"].abs().max(), lines.loc[~alone, "carried"].min()
    return (
        f"A floor that is moved by position alone carries a block by no more than {part(most)} of "
        f"its way, one moved by the other ways by {part(least)} and more{slept}."
    )
