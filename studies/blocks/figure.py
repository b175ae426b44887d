"""The blocks of a list, ranked by the factor on a record that overturns them first."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pandas as pd
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from studies.blocks.report import first_words, ranked, read
from studies.drawing.kept import Pictures
from studies.drawing.letters import drawable, families
from studies.drawing.styles import ENGINE_COLOURS, ENGINE_MARKERS

MOST_DRAWN = 60
"""Blocks in the picture, those that overturn first."""
LONGEST_NAME = 24
"""Letters of a name."""


def draw_blocks(rows: pd.DataFrame, lines: pd.DataFrame, title: str) -> Figure:
    """Draw, for each block and record, the factors from lifting to overturning.

    Parameters
    ----------
    rows : DataFrame
        The columns of blocks.csv.
    lines : DataFrame
        One of them for each block and record, in the order in which blocks are drawn.
    title : str
    """
    records = list(dict.fromkeys(rows["record"]))
    with rc_context({"font.family": families([title, *lines["name"], *records])}):
        return _drawn(rows, lines, title, records)


def _drawn(rows: pd.DataFrame, lines: pd.DataFrame, title: str, records: list[str]) -> Figure:
    names = list(dict.fromkeys(lines["name"]))[:MOST_DRAWN]
    height = 1.9 + len(names) * max(0.21, 0.1 * len(records))
    drawing = Figure(figsize=(8.0, height), layout="constrained")
    axes = drawing.subplots()
    for place, record in enumerate(records):
        _one_record(axes, lines[lines["record"] == record], names, place, len(records))
    for scale in sorted(set(rows["scale"])):
        axes.axvline(scale, color="#666666", linewidth=0.8, linestyle=(0, (5, 4)))
    axes.set(xscale="log", ylim=(len(names) - 0.4, -0.6), xlabel="factor on the record  [–]")
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter("{x:g}")
    axes.set_yticks(range(len(names)))
    axes.set_yticklabels([_short(name) for name in names], fontsize=8, parse_math=False)
    axes.grid(axis="y", alpha=0.2)
    kept = f"; these {MOST_DRAWN} first" if lines["name"].nunique() > MOST_DRAWN else ""
    axes.set_title(drawable(title) + kept, fontsize=10, wrap=True, parse_math=False)
    handles = [_handle(record, place) for place, record in enumerate(records)]
    handles.append(Line2D([], [], color="#666666", linestyle=(0, (5, 4)), label="asked"))
    legend = drawing.legend(
        handles=handles, loc="outside lower center", ncols=min(len(handles), 4), frameon=False
    )
    for text in legend.get_texts():
        text.set_parse_math(False)
    return drawing


def _one_record(axes: Axes, lines: pd.DataFrame, names: list[str], place: int, of: int) -> None:
    offset = 0.6 * ((place + 0.5) / of - 0.5)
    colour = ENGINE_COLOURS[place % len(ENGINE_COLOURS)]
    for _, line in lines[lines["name"].isin(names)].iterrows():
        level, end = names.index(line["name"]) + offset, line["margin"]
        if words := line["no_margin"] or ("none found" if math.isinf(end) else ""):
            look: dict[str, Any] = {
                "color": colour,
                "fontsize": 7,
                "bbox": {"facecolor": "white", "edgecolor": "none", "pad": 0.5},
            }
            where = ("axes fraction", "data")
            axes.annotate(f"{words} ", (1.0, level), xycoords=where, ha="right", va="center",
                          **look)  # fmt: skip
        if not (math.isfinite(end) and end > 0.0):
            continue
        if line["lifts"] > 0.0:
            axes.plot([line["lifts"], end], [level, level], color=colour, lw=1.2, alpha=0.5)
        axes.plot([end], [level], **_look(place))


def _look(place: int) -> dict[str, Any]:
    return {
        "color": ENGINE_COLOURS[place % len(ENGINE_COLOURS)],
        "marker": ENGINE_MARKERS[place % len(ENGINE_MARKERS)],
        "markersize": 4.5,
        "linestyle": "none",
    }


def _handle(record: str, place: int) -> Line2D:
    look = {**_look(place), "linestyle": "-", "linewidth": 1.2}
    return Line2D([], [], label=f"{_short(record)}: lifts to overturns", **look)


def _short(name: str) -> str:
    name = drawable(name)
    return name if len(name) <= LONGEST_NAME else f"{name[: LONGEST_NAME - 1]}…"


def pictures(folder: Path) -> Pictures:
    """Draw the ranking of a folder's blocks from its blocks.csv alone."""
    rows = read(folder)
    lines = ranked(rows)
    return {"blocks": draw_blocks(rows, lines, first_words(lines))}
