"""By how much a part of the cases errs at most, for every variant of a linearization."""

from __future__ import annotations

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.drawing.labels import Name, beside
from studies.linearizations.study import NAMED, VARIANTS

ONSETS = {"0": ("#D55E00", "lifts at g α"), "1": ("#0072B2", "lifts at g tan α")}
"""What a variant takes as the onset -> its colour, and what that is."""

NAMED_AT = 0.9
"""Part of the cases at which a line is named: at its end, the worst case, lines lie together."""


def draw_distributions(quantiles: pd.DataFrame) -> Figure:
    """Draw by how much a part of the cases errs at most, a panel for each grid.

    The colour of a line is its onset, its dash its frequency, its width its saddle.
    """
    grids = list(quantiles["grid"].unique())
    drawing = Figure(figsize=(9.4, 5.2), layout="constrained")
    panels = drawing.subplots(1, len(grids), sharex=True, sharey=True, squeeze=False)[0]
    for axes, name in zip(panels, grids, strict=True):
        part = quantiles[quantiles["grid"] == name]
        ends = [
            _one_variant(axes, str(changed), rows)
            for changed, rows in part.groupby("changed", sort=False)
        ]
        axes.set(yscale="log", xlim=(0.0, 1.0), ylim=(1e-4, 1e1), title=f"{name} grid")
        axes.set_xlabel("part of the surviving cases  [–]")
        axes.grid(alpha=0.25)
    for onset, (colour, words) in ONSETS.items():
        panels[0].text(0.97, 0.1 - 0.05 * int(onset), words, color=colour, ha="right",
                       transform=panels[0].transAxes)  # fmt: skip
    beside(panels[-1], ends)
    panels[0].set_ylabel("relative error of the peak, at most  [–]")
    return drawing


def _one_variant(axes: Axes, changed: str, rows: pd.DataFrame) -> Name:
    title, known = VARIANTS[changed].title, NAMED.get(changed)
    onset, frequency, saddle = tuple(changed)
    colour = ONSETS[onset][0]
    axes.plot(
        rows["quantile"],
        rows["error"],
        color=colour,
        linestyle=(0, (4, 2)) if frequency == "1" else "-",
        linewidth=1.8 if known else 0.9,
        alpha=1.0 if saddle == "0" or known else 0.6,
    )
    # the onset is the colour
    words = title.partition(", ")[2].partition(" (")[0]
    name = f"{known}: {words}" if known else words
    named = rows[rows["quantile"] <= NAMED_AT].sort_values("quantile").iloc[-1]
    return Name(name, float(named["quantile"]), float(named["error"]), colour)
