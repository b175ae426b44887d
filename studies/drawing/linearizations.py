"""The errors of every variant of a linearization over the slenderness of a block."""

from collections.abc import Mapping

import pandas as pd
from matplotlib.figure import Figure

from studies.drawing.facets import error_scale, key, sheet

ONSETS = {"0": ("#D55E00", "lifts at g α"), "1": ("#0072B2", "lifts at g tan α")}
"""What a variant takes as the onset -> its colour, and what that is."""


def draw_errors(lines: pd.DataFrame, titles: Mapping[str, str]) -> Figure:
    """Draw a panel for each grid: colour is the onset of a line, dash its frequency."""
    grids = list(lines["grid"].unique())
    drawing, panels = sheet((9.4, 5.2), 1, len(grids), sharey=True)
    for axes, grid in zip(panels, grids, strict=True):
        mine = lines[lines["grid"] == grid]
        for changed, rows in mine.groupby("changed", sort=False):
            words, _, name = titles[str(changed)].partition(", ")[2].rstrip(")").partition(" (")
            colour, dash = ONSETS[str(changed)[0]][0], (0, (4, 2)) if changed[1] == "1" else "-"
            axes.plot(rows["aspect"], rows["median_error"], color=colour, linestyle=dash,
                      marker="o", markersize=3.0, linewidth=1.8 if name else 0.9,
                      label=f"{name}: {words}" if name else words)  # fmt: skip
        axes.set(xscale="log", yscale="log", title=f"{grid} grid", xlabel="slenderness  H/B  [–]")
        ticks = [at for at in (2, 3, 4, 6, 10) if at <= mine["aspect"].max()]
        axes.set_xticks(ticks, list(map(str, ticks)))
        axes.set_xticks([], minor=True)
        axes.grid(alpha=0.25)
    for onset, (colour, words) in ONSETS.items():
        panels[0].text(0.03, 0.1 - 0.05 * int(onset), words, color=colour,
                       transform=panels[0].transAxes)  # fmt: skip
    error_scale(panels[0].yaxis, 1e-4, 10.0, 1)
    key(drawing, panels[-1].get_lines(), 4, 8.0)
    panels[0].set_ylabel("median relative error of the peak  [–]")
    return drawing
