"""What becomes of a coefficient of restitution, by the way in which it is asked for."""

from __future__ import annotations

import math
from textwrap import fill

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.drawing.facets import cells, panels, sheet
from studies.drawing.styles import style_of, title_of

LEAST = 1e-3
"""Deviation at the lower end of the colours, which end at 1."""
COLUMNS = {
    "off": "usual",
    "off_p_dt": "step",
    "off_rate_over_alpha_p": "rate",
    "off_height_m": "height",
    "off_aspect": "H/B",
}
"""Column of deviations -> what was varied."""
TOP = 1.25
"""End of the scale of a ratio of speeds."""


def draw_deviations(corners: pd.DataFrame, rates: pd.DataFrame) -> Figure:
    """Draw the largest deviation of each way to ask, of the corner's speed and of the rate."""
    drawing, grid = sheet((9.4, 1.5 + 0.24 * len(corners)), 1, 2, sharey=True)
    titles = ("speed of the corner", "angular rate of the block")
    for axes, table, title in zip(grid, (corners, rates), titles, strict=True):
        values = table[[*COLUMNS]].to_numpy(float)
        image = cells(axes, np.where(np.isinf(values), 1.0, values), LEAST)
        axes.set_xticks(range(len(COLUMNS)), [*COLUMNS.values()])
        axes.xaxis.tick_top()
        axes.tick_params(length=0)
        axes.set_title(title, fontsize=10.5)
        for (row, column), value in np.ndenumerate(values):
            words = "∞" if math.isinf(value) else "0" if value < LEAST else f"{value:.2g}"
            axes.text(column, row, words, ha="center", va="center", fontsize=8,
                      color="white" if value > 0.06 else "black")  # fmt: skip
    ways = corners["way"].str.replace("^and ", "… and ", regex=True)
    grid[0].set_yticks(range(len(corners)), corners["engine"].map(title_of) + ": " + ways,
                       fontsize=8.5)  # fmt: skip
    drawing.colorbar(image, ax=grid, label="largest deviation (∞: a strike broke)", aspect=40,
                     pad=0.01)  # fmt: skip
    drawing.suptitle("Speeds after over before a strike: how far from what was asked for")
    return drawing


def draw_strikes(rows: pd.DataFrame, corners: pd.DataFrame, best: pd.DataFrame) -> Figure:
    """Draw the speed of the corner over the coefficient, in each engine's plainest and best way."""
    plain = corners.drop_duplicates("engine")
    drawing, grid = panels(len(best), 4, (2.35, 2.5), 0.9, sharex=True, sharey=True)
    for axes, first, last in zip(grid, plain.itertuples(), best.itertuples(), strict=True):
        mine, look = rows[rows["engine"] == last.engine], style_of(str(last.engine))
        axes.plot([0.0, 1.0], [0.0, 1.0], color="#999999", linewidth=0.8, label="as asked for")
        _way(axes, mine[mine["way"] == last.way], look.colour, "-", "best way, named above")
        usual = mine[(mine["way"] == first.way) & (mine["varied"] == "")]
        _way(axes, usual, "#000000", "--", "plainest way")
        axes.set_title(f"{title_of(str(last.engine))}\n{fill(str(last.way), 27)}", fontsize=8.5)
        axes.set(xlim=(-0.03, 1.03), ylim=(-0.05, TOP))
        axes.grid(alpha=0.25)
    drawing.legend(*grid[0].get_legend_handles_labels(), loc="outside upper center", ncols=3,
                   frameon=False, fontsize=9)  # fmt: skip
    drawing.supylabel("speed of the corner, after over before", fontsize=10)
    drawing.supxlabel("coefficient of restitution that was asked for", fontsize=10)
    return drawing


def _way(axes: Axes, rows: pd.DataFrame, colour: str, line: str, label: str) -> None:
    """Draw the usual strikes as a line, and as a band whatever was varied."""
    ratio = rows.assign(ratio=rows["corner_ratio"].clip(upper=TOP)).groupby("wanted")["ratio"]
    usual = rows[rows["varied"] == ""].groupby("wanted")["corner_ratio"].median()
    axes.fill_between(ratio.min().index, ratio.min(), ratio.max(), color=colour, alpha=0.3, lw=0.0)
    axes.plot(usual.index, usual, line, color=colour, linewidth=1.4, label=label)
