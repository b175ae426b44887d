"""By how much a part of the cases errs at most, for every variant of a linearization."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd
from matplotlib.figure import Figure

from studies.drawing.facets import error_scale, sheet
from studies.drawing.labels import Name, beside

ONSETS = {"0": ("#D55E00", "lifts at g α"), "1": ("#0072B2", "lifts at g tan α")}
"""What a variant takes as the onset -> its colour, and what that is."""


def draw_distributions(
    quantiles: pd.DataFrame, titles: Mapping[str, str], known: Mapping[str, str]
) -> Figure:
    """Draw a panel for each grid: colour is the onset of a line, dash its frequency."""
    grids = list(quantiles["grid"].unique())
    drawing, panels = sheet((9.4, 5.2), 1, len(grids), sharex=True, sharey=True)
    for axes, grid in zip(panels, grids, strict=True):
        names = []
        for changed, rows in quantiles[quantiles["grid"] == grid].groupby("changed", sort=False):
            onset, frequency, saddle = tuple(str(changed))
            name, colour = known.get(str(changed), ""), ONSETS[onset][0]
            dash, pale = (0, (4, 2)) if frequency == "1" else "-", saddle == "1" and not name
            axes.plot(rows["quantile"], rows["error"], color=colour, linestyle=dash,
                      linewidth=1.8 if name else 0.9, alpha=0.6 if pale else 1.0)  # fmt: skip
            words = titles[str(changed)].partition(", ")[2].partition(" (")[0]
            # at its end, the worst case, lines lie together
            place = rows[rows["quantile"] <= 0.9].sort_values("quantile").iloc[-1]
            text = f"{name}: {words}" if name else words
            names.append(Name(text, float(place["quantile"]), float(place["error"]), colour))
        axes.set(yscale="log", xlim=(0.0, 1.0), ylim=(1e-4, 1e1), title=f"{grid} grid")
        axes.set_xlabel("part of the surviving cases  [–]")
        axes.grid(alpha=0.25)
    for onset, (colour, words) in ONSETS.items():
        panels[0].text(0.97, 0.1 - 0.05 * int(onset), words, color=colour, ha="right",
                       transform=panels[0].transAxes)  # fmt: skip
    beside(panels[-1], names, 7.5)
    error_scale(panels[0].yaxis, 1e-4, 1.0, 1)
    panels[0].set_ylabel("largest relative error of the peak  [–]")
    return drawing
