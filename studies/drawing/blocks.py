"""The blocks of a list, ranked by the factor on a record that overturns them first."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from studies.drawing.facets import key, sheet
from studies.drawing.letters import drawable, families
from studies.drawing.styles import look_at

MOST_DRAWN = 60
"""Blocks in the picture, those that overturn first."""


def draw_blocks(lines: pd.DataFrame, scales: Sequence[float], title: str) -> Figure:
    """Draw, for each block and record, the factors from lifting to overturning.

    The lines, with the columns of blocks.csv, are in the order in which blocks stand; the scales
    are the factors that were asked for.
    """
    records = [*dict.fromkeys(lines.sort_index()["record"])]
    names = [*dict.fromkeys(lines["name"])]
    kept = f"; these {MOST_DRAWN} first" if len(names) > MOST_DRAWN else ""
    names = names[:MOST_DRAWN]
    fonts = families([title, *names, *records])
    with rc_context({"font.family": fonts, "text.parse_math": False}):
        drawing, (axes,) = sheet((8.0, 1.9 + len(names) * max(0.21, 0.1 * len(records))))
        key_of = dict[int, Line2D]()
        for line in lines[lines["name"].isin(names)].to_dict("records"):
            place = records.index(line["record"])
            shift = 0.6 * ((place + 0.5) / len(records) - 0.5)
            found = _draw_line(axes, line, names.index(line["name"]) + shift, place)
            key_of.setdefault(place, found)
        for scale in scales:
            asked = axes.axvline(scale, label="scale asked for", zorder=0.5, color="#666666",
                                 linewidth=0.8, linestyle=(0, (5, 4)))  # fmt: skip
        axes.set(xscale="log", ylim=(len(names) - 0.4, -0.6), xlabel="factor on the record  [–]")
        axes.xaxis.set_major_formatter("{x:g}")
        axes.xaxis.set_minor_formatter("{x:g}")
        axes.tick_params(axis="x", which="both", labelsize=9)
        axes.set_yticks(range(len(names)), map(_short, names), fontsize=8)
        axes.grid(axis="y", alpha=0.2)
        axes.set_title(drawable(title) + kept, fontsize=10, wrap=True)
        handles = [key_of[place] for place in sorted(key_of)]
        key(drawing, [*handles, asked], min(len(handles) + 1, 4), 10.0)
    return drawing


def _draw_line(axes: Axes, line: dict[Any, Any], level: float, place: int) -> Line2D:
    """Draw the factors of a block under a record, and return what stands for that in the key."""
    colour, marker = look_at(place)
    look: dict[str, Any] = {"color": colour, "marker": marker, "markersize": 4.5}
    if words := line["no_margin"] or ("none found" if np.isinf(line["margin"]) else ""):
        axes.annotate(f"{words} ", (1.0, level), xycoords=("axes fraction", "data"), ha="right",
                      va="center", fontsize=7, color=colour)  # fmt: skip
    else:
        ends = [line["lifts"], line["margin"]]
        axes.plot(ends, [level] * 2, markevery=[1], linewidth=1.2, **look)
    label = f"{_short(line['record'])}: lifts to overturns"
    return Line2D([], [], linewidth=1.2, label=label, **look)


def _short(name: str) -> str:
    name = drawable(name)
    return name if len(name) <= 24 else f"{name[:23]}…"
