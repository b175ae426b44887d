"""Errors of a scene's engines against their run times, and what a moving floor carries."""

from __future__ import annotations

import pandas as pd
from matplotlib.figure import Figure

from studies.drawing.facets import key, preset_dots, sheet
from studies.drawing.labels import Name, around
from studies.drawing.styles import title_of
from studies.measures.presets import look_of, preset_of

LOWEST = 1e-7
"""Smaller errors are drawn here."""


def draw_floors(lines: pd.DataFrame) -> Figure:
    """Draw how far a floor carries a block: a row for each line of floor-summary.csv."""
    figure, (axes,) = sheet((8.0, 1.2 + 0.26 * len(lines)))
    for column, label, marker, colour, fill in (
        ("carried", "moved at once", "o", "#0072B2", "full"),
        ("carried_after_rest", "after 1 s of rest", "s", "#D55E00", "none"),
    ):
        axes.plot(100.0 * lines[column], range(len(lines)), marker, color=colour, label=label,
                  markersize=8, fillstyle=fill)  # fmt: skip
    pairs = zip(lines["source"].astype(str), lines["floor"], strict=True)
    names = [f"{title_of(source)}: {floor}" for source, floor in pairs]
    axes.set_yticks(range(len(lines)), names)
    axes.set(ylim=(len(lines) - 0.5, -0.5), xlim=(-8.0, 108.0))
    axes.set_xlabel("way over which the floor carries the block, of its own  [%]")
    axes.grid(axis="x", alpha=0.25)
    axes.legend(loc="center", frameon=False)
    axes.set_title("What a floor carries, by how it is moved", fontsize=12)
    return figure


def draw_times(lines: pd.DataFrame) -> Figure:
    """Draw for each engine and preset a line from the median to the largest error at its time.

    Wrong outcomes are counted beside a name.
    """
    figure, (axes,) = sheet((8.0, 4.6))
    axes.set(xscale="log", yscale="log", xlabel="run time of a case  [ms]")
    axes.set_ylabel("error of the largest rotation, relative  [–]")
    names = []
    for row in lines.dropna(subset="median_error").to_dict("records"):
        low, high = (max(row[name], LOWEST) for name in ("median_error", "max_error"))
        colour = look_of(preset_of(row["source"])).colour
        axes.plot([row["ms_a_frame"]] * 2, [low, high], color=colour, linewidth=1.5, alpha=0.5)
        axes.plot(row["ms_a_frame"], low, "o", color=colour, markersize=6)
        wrong = f", {row['wrong']:.0f} wrong" if row["wrong"] else ""
        names.append(Name(title_of(row["source"]) + wrong, row["ms_a_frame"], low, colour))
    axes.grid(alpha=0.25)
    key(figure, preset_dots(map(preset_of, lines["source"])), 4, fontsize=10)
    axes.set_title("Rocking frames: from the median error (dot) to the largest", fontsize=11)
    around(axes, names)
    return figure
