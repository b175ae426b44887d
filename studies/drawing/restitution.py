"""What becomes of a coefficient of restitution, by the way in which it is asked for."""

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.drawing.facets import panels
from studies.drawing.styles import style_of, title_of

TOP = 1.25
"""End of the scale of a ratio of speeds."""


def draw_strikes(rows: pd.DataFrame, plain: pd.DataFrame, best: pd.DataFrame) -> Figure:
    """Draw the speed of the corner over the coefficient, in each engine's plainest and best way."""
    drawing, grid = panels(len(best), 4, (2.35, 2.5), 0.9, sharex=True, sharey=True)
    for axes, first, last in zip(grid, plain.itertuples(), best.itertuples(), strict=True):
        mine, look = rows[rows["engine"] == last.engine], style_of(str(last.engine))
        axes.plot([0.0, 1.0], [0.0, 1.0], color="#999999", linewidth=0.8, label="as asked for")
        _way(axes, mine[mine["way"] == last.way], look.colour, "-", "best way")
        usual = mine[(mine["way"] == first.way) & (mine["varied"] == "")]
        _way(axes, usual, "#000000", "--", "plainest way")
        axes.set_title(title_of(str(last.engine)), fontsize=10.5)
        axes.set(xlim=(-0.03, 1.03), ylim=(-0.05, TOP))
        axes.grid(alpha=0.25)
    drawing.supylabel("found: speed of the corner, after over before", fontsize=10)
    drawing.supxlabel("coefficient of restitution that was asked for", fontsize=10)
    grid[0].legend(loc="upper left", frameon=False, fontsize=8.5)
    return drawing


def _way(axes: Axes, rows: pd.DataFrame, colour: str, line: str, label: str) -> None:
    """Draw the usual strikes as a line, and as a band whatever was varied."""
    ratio = rows.assign(ratio=rows["corner_ratio"].clip(upper=TOP)).groupby("wanted")["ratio"]
    usual = rows[rows["varied"] == ""].groupby("wanted")["corner_ratio"].median()
    axes.fill_between(ratio.min().index, ratio.min(), ratio.max(), color=colour, alpha=0.3, lw=0.0)
    axes.plot(usual.index, usual, line, color=colour, linewidth=1.4, label=label)
