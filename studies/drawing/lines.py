"""Pictures of lines: linearizations over the slenderness, strikes over their coefficient."""

from collections.abc import Mapping

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.drawing.facets import error_scale, key, panels, sheet
from studies.drawing.styles import style_of, title_of

ONSETS = {"0": ("#D55E00", "lifts at g α"), "1": ("#0072B2", "lifts at g tan α")}
"""What a variant takes as the onset -> its colour, and what that is."""
TOP = 1.25
"""End of the scale of a ratio of speeds."""


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
