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
        handles = [
            _draw_record(axes, lines[lines["record"] == record], names, place, len(records))
            for place, record in enumerate(records)
        ]
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
        key(drawing, [*handles, asked], min(len(handles) + 1, 4), 10.0)
    return drawing


def _draw_record(
    axes: Axes, lines: pd.DataFrame, names: Sequence[str], place: int, of: int
) -> Line2D:
    """Draw the factors of a record, and return what stands for it in the key."""
    colour, marker = look_at(place)
    look: dict[str, Any] = {"color": colour, "marker": marker, "markersize": 4.5}
    box = {"facecolor": "white", "edgecolor": "none", "pad": 0.5}
    for line in lines[lines["name"].isin(names)].to_dict("records"):
        level, end = names.index(line["name"]) + 0.6 * ((place + 0.5) / of - 0.5), line["margin"]
        if words := line["no_margin"] or ("none found" if np.isinf(end) else ""):
            axes.annotate(f"{words} ", (1.0, level), xycoords=("axes fraction", "data"), ha="right",
                          va="center", fontsize=7, color=colour, bbox=box)  # fmt: skip
        elif end > 0.0:
            axes.plot(end, level, linestyle="none", **look)
            if line["lifts"] > 0.0:
                axes.plot([line["lifts"], end], [level, level], color=colour, lw=1.2, alpha=0.5)
    label = f"{_short(lines['record'].iloc[0])}: lifts to overturns"
    return Line2D([], [], linewidth=1.2, label=label, **look)


def _short(name: str) -> str:
    name = drawable(name)
    return name if len(name) <= 24 else f"{name[:23]}…"
