"""What README.md and the scenes' page say of scenes beyond one block, from the published tables."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pandas as pd

from engines import ENGINES
from studies.drawing.styles import engine_title
from studies.measures.presets import engine_of, in_order, is_engine, preset_of
from studies.measures.words import capital, duration, listed, part
from studies.measures.wrongness import KINDS
from studies.page.facts import by_preset, presets
from studies.scenes.told import (
    SCENES,
    best_of,
    by_scene,
    cases_of,
    floor_sentence,
    found_in,
    ranked,
    sentence,
)


def scenes(published: Path) -> tuple[list[str], list[list[str]]]:
    """Return heads, and a row for each engine with a cell for each scene.

    A cell has the median error and how many outcomes are wrong, as documented and then of the last
    of the engine's presets that were asked; the block has the time of a case, too.
    """
    block = presets(published).rename(columns={"median": "median_error"})
    held: list[tuple[str, pd.DataFrame, Callable[[pd.Series[Any]], str]]] = [
        (_posed("a block", block), block, partial(_outcome, say=part)),
        ("run time of a case", block, lambda row: duration(1e-3 * row["ms"])),
    ]
    held += [
        (_posed(SCENES[name].title, lines), lines, partial(_outcome, say=SCENES[name].words))
        for name, lines in by_scene(published / "scenes").items()
    ]
    engines = dict.fromkeys(engine_of(source) for _, lines, _ in held for source in lines["source"])
    rows = [
        [f"**{ENGINES[name].title}**", *(_ends(lines, name, say) for _, lines, say in held)]
        for name in engines
    ]
    return ["", *(head for head, _, _ in held)], rows


def _posed(title: str, lines: pd.DataFrame) -> str:
    return f"{title}, {cases_of(lines)} cases"


def scenes_told(published: Path) -> list[dict[str, Any]]:
    """Return each scene in words: what was found, a table of engines and presets."""
    folder, sections = published / "scenes", []
    known = by_scene(folder)
    for name, lines in known.items():
        told, source = SCENES[name], lines["source"]
        posed = lines.assign(engine=source.map(engine_of), preset=source.map(preset_of))
        sections.append(
            {
                "name": name,
                "title": capital(told.title),
                "claim": sentence(name, lines),
                "asked": told.asked,
                "cases": cases_of(lines),
                "table": by_preset(posed, told.words),
            }
        )
    return sections


def extreme_frames(published: Path) -> dict[str, Any]:
    """Return what engines make of the extreme frames, as `scenes` does; empty without any."""
    lines = found_in(published / "scenes" / "frame-extremes.csv")
    if lines.empty:
        return {}
    frames = list(lines.groupby(["columns", "load"], sort=False))
    say = partial(_outcome, say=part)
    heads = ["", *(f"{columns} columns, γ = {load:g}" for (columns, load), _ in frames)]
    rows = [
        [f"**{ENGINES[name].title}**", *(_ends(mine, name, say) for _, mine in frames)]
        for name in dict.fromkeys(map(engine_of, lines["source"]))
        if name in ENGINES
    ]
    heaviest = lines[(lines["load"] == lines["load"].max()) & lines["source"].map(is_engine)]
    best = best_of(heaviest)
    low, high = ranked(best.assign(source=best["source"].map(engine_of)), part)
    mute = best.loc[best["median_error"].isna(), "source"].map(engine_title)
    beside = f"; no peak at all from {listed(list(mute))}" if len(mute) else ""
    claim = (
        f"With a beam {lines['load'].max():g} times as heavy as its columns the peak is off, in "
        f"the median and with each engine's best preset, by {low} to {high}{beside}."
    )
    return {"claim": claim, "table": (heads, rows)}


def floors(published: Path) -> dict[str, Any]:
    """Return what is found of moving floors, and the lines of them; empty without any."""
    lines = found_in(published / "scenes" / "floor-summary.csv")
    if lines.empty:
        return {}
    return {"claim": floor_sentence(lines), "lines": lines.to_dict("records")}


def _ends(lines: pd.DataFrame, engine: str, say: Callable[[pd.Series[Any]], str]) -> str:
    """Return what is said of an engine's first and last preset; a dash of one without any."""
    mine = lines[lines["source"].map(engine_of) == engine]
    if mine.empty:
        return "–"
    by_preset = {preset_of(row["source"]): row for _, row in mine.iterrows()}
    names = in_order(by_preset)
    said = [say(by_preset[name]) for name in dict.fromkeys((names[0], names[-1]))]
    return "<br>→ ".join(said).replace(" ", "\N{NO-BREAK SPACE}")


def _outcome(row: pd.Series[Any], say: Callable[[float], str]) -> str:
    wrong = int(sum(row[kind] for kind in KINDS))
    if not math.isfinite(row["median_error"]):
        return f"{wrong} wrong" if wrong else ""
    return say(row["median_error"]) + (f" ({wrong} wrong)" if wrong else "")
