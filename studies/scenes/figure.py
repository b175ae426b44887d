"""Errors of frames and slides, and what a floor carries: engines as rows, bars and dots."""

from __future__ import annotations

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.drawing.styles import title_of
from studies.measures.presets import engine_of, in_order, preset_of, told

LOWEST = 1e-7
"""Smaller errors are drawn here."""


FLOORS = (
    ("carried", "moved at once", "o", "#0072B2"),
    ("carried_after_rest", "after 1 s of rest", "s", "#D55E00"),
)
"""Column -> how it is drawn."""

ROOM = 30.0
"""By how much the axis is longer where words stand beside a bar."""


def draw_frames(lines: pd.DataFrame) -> Figure:
    """Draw for each engine and preset a bar from the median to the largest error of the peak.

    Parameters
    ----------
    lines : DataFrame
        The columns of frame-summary.csv.
    """
    title = "A rocking frame: how far off its peak is, median to largest"
    figure, axes, heights = _rows(lines, title)
    for row in lines.to_dict("records"):
        median, most = (max(row[name], LOWEST) for name in ("median_error", "largest_error"))
        colour, y = told(preset_of(row["source"])).colour, heights[row["source"]]
        axes.plot([median, most], [y, y], color=colour, linewidth=5, solid_capstyle="round")
        axes.plot(median, y, "o", color=colour, markersize=7)
        if row["wrong"]:
            words = f"   {row['wrong']} of {row['frames']} fall wrongly"
            axes.text(most, y, words, va="center", fontsize=8, color=colour, clip_on=False)
    if lines["wrong"].any():
        axes.set_xlim(right=ROOM * axes.get_xlim()[1])
    axes.set_xlabel("error of the largest rotation of a column, relative  [–]")
    return figure


def draw_slides(lines: pd.DataFrame) -> Figure:
    """Draw for each engine and preset the largest error of a slip.

    Parameters
    ----------
    lines : DataFrame
        The columns of slide-summary.csv.
    """
    figure, axes, heights = _rows(lines, "A sliding block: the largest error of a slip")
    for row in lines.to_dict("records"):
        if not pd.isna(row["largest_slip_error_m"]):
            colour = told(preset_of(row["source"])).colour
            value = max(1e3 * row["largest_slip_error_m"], LOWEST)
            axes.plot(value, heights[row["source"]], "o", color=colour, markersize=8)
    axes.set_xlabel("largest error of a slip  [mm]")
    return figure


def draw_floors(lines: pd.DataFrame) -> Figure:
    """Draw how far a floor carries a block: a row for each engine and way of moving the floor.

    Parameters
    ----------
    lines : DataFrame
        The columns of floor-summary.csv.
    """
    figure = Figure(figsize=(8.0, 1.2 + 0.26 * len(lines)), layout="constrained")
    axes = figure.subplots()
    for column, label, marker, colour in FLOORS:
        axes.plot(100.0 * lines[column], range(len(lines)), marker, color=colour, label=label,
                  markersize=8, markerfacecolor=colour if marker == "o" else "none")  # fmt: skip
    pairs = zip(lines["engine"].astype(str), lines["floor"], strict=True)
    names = [f"{title_of(engine)}: {floor}" for engine, floor in pairs]
    axes.set_yticks(range(len(lines)), names)
    axes.set(ylim=(len(lines) - 0.5, -0.5), xlim=(-8.0, 108.0))
    axes.set_xlabel("way over which the floor carries the block, of its own  [%]")
    axes.grid(axis="x", alpha=0.25)
    axes.legend(loc="center", frameon=False)
    axes.set_title("A floor that is moved by position alone carries nothing", fontsize=12)
    return figure


def _rows(lines: pd.DataFrame, title: str) -> tuple[Figure, Axes, dict[str, float]]:
    """Return a figure with a row for each engine, and the height of each source's bar in it."""
    engines = list(dict.fromkeys(map(engine_of, lines["source"])))
    presets = in_order(map(preset_of, lines["source"]))
    each = 0.25 + 0.12 * len(presets)
    figure = Figure(figsize=(8.0, 1.3 + each * len(engines)), layout="constrained")
    axes = figure.subplots()
    apart = 0.6 / max(len(presets), 1)
    heights = {
        source: engines.index(engine_of(source))
        + apart * (presets.index(preset_of(source)) - 0.5 * (len(presets) - 1))
        for source in lines["source"]
    }
    axes.set_yticks(range(len(engines)), [title_of(name) for name in engines])
    axes.set(xscale="log", ylim=(len(engines) - 0.5, -0.5))
    axes.grid(axis="x", alpha=0.25)
    for preset in presets:
        axes.plot([], [], "o", color=told(preset).colour, label=told(preset).short)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=4, frameon=False)
    axes.set_title(title, fontsize=12)
    return figure, axes, heights
