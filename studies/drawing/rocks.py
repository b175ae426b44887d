"""What rocks did on a shake table."""

from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.drawing.facets import sheet

LOOKS = {0: ("#0072B2", "o", "stood"), 1: ("#D55E00", "^", "fell")}
NAMES = {"margin": "factor that overturns the block", "pga_g": "PGA", "pgv_m_s": "PGV"}


def draw_rocks(
    rocks: Mapping[int, pd.DataFrame], scores: Mapping[str, float], lost: pd.DataFrame
) -> Figure:
    """Draw for each rock what fell over PGA and PGV, and below the ROC curve of each score."""
    drawing, grid = sheet((8.0, 7.0), 2, 2)
    for place, (rock, table) in enumerate(rocks.items()):
        axes = grid[place]
        for fell, (colour, marker, name) in LOOKS.items():
            mine = table[table["fell"] == fell]
            axes.plot(mine["pga_g"], mine["pgv_m_s"], marker, color=colour, markersize=3.0,
                      alpha=0.6, label=name)  # fmt: skip
        wrong = lost[lost["rock"] == rock]
        axes.plot(wrong["pga_g"], wrong["pgv_m_s"], "o", color="black", markersize=8.0,
                  fillstyle="none", label="all three are wrong")  # fmt: skip
        axes.set(xscale="log", yscale="log", xlabel="PGA  [g]", ylabel="PGV  [m/s]")
        axes.set_title(f"rock {rock}", fontsize=10.5)
        for score, sign in scores.items() if table["fell"].nunique() > 1 else ():
            _draw_curve(grid[2 + place], sign * table[score], table["fell"], NAMES[score])
        for axes in grid[place::2]:
            axes.legend(fontsize=8, frameon=False)
    return drawing


def _draw_curve(axes: Axes, score: pd.Series, fell: pd.Series, name: str) -> None:
    """Draw the part of the falls that is found over that of the others taken for one."""
    levels = np.unique(score)[::-1]
    taken = score.to_numpy()[:, None] >= levels
    ends = [[0.0, *taken[(fell == value).to_numpy()].mean(axis=0)] for value in (0, 1)]
    axes.plot(*ends, linewidth=1.3, label=name)
    axes.set(xlabel="false alarms, of those that stood", ylabel="found, of those that fell")
    axes.set_aspect("equal")
    axes.grid(alpha=0.25)
