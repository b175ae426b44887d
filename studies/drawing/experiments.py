"""What rocks did on a shake table, and what engines lose with tossed cubes."""

from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from studies.drawing.facets import rows, sheet
from studies.drawing.styles import style_of, title_of

LABELS = {"pga_g": "PGA", "pgv_m_s": "PGV"}


def draw_rocks(
    tables: Mapping[str, pd.DataFrame], scores: Mapping[str, float], lost: pd.DataFrame
) -> Figure:
    """Draw for each rock what fell over PGA and PGV, and below the ROC curve of each score."""
    drawing, grid = sheet((8.0, 7.0), 2, 2)
    for rock, above, below in zip((1, 2), grid[:2], grid[2:], strict=True):
        table, fell = tables[f"rock-{rock}"], tables[f"rock-{rock}"]["fell"] == 1
        kinds = {"stood": table[~fell], "fell": table[fell], "all miss": lost[lost["rock"] == rock]}
        for (name, tests), marker in zip(kinds.items(), ("o", "^", "kx"), strict=True):
            above.plot(tests["pga_g"], tests["pgv_m_s"], marker, ms=4.0, alpha=0.6, label=name)
        above.set(xscale="log", yscale="log", xlabel="PGA  [g]", ylabel="PGV  [m/s]")
        above.set_title(f"rock {rock}")
        for name, sign in scores.items() if 0 < fell.sum() < len(fell) else ():
            score = sign * table[name].to_numpy()
            taken = score[:, None] >= np.unique(score)[::-1]
            ends = ([0.0, *taken[kind].mean(axis=0)] for kind in (~fell, fell))
            below.plot(*ends, label=LABELS.get(name, name))
        below.set(xlabel="false alarms, of those that stood", ylabel="found, of those that fell")
        for axes in (above, below):
            axes.legend(fontsize=8, frameon=False)
            axes.grid(alpha=0.25)
    return drawing


def draw_cubes(lines: pd.DataFrame) -> Figure:
    """Draw the mean loss of each engine and settings, and the part of right faces."""
    drawing, grid = sheet((8.6, 0.9 + 0.36 * len(lines)), 1, 2, sharey=True)
    names = [f"{title_of(line['engine'])}, {line['settings']}" for _, line in lines.iterrows()]
    rows(grid[0], names)
    rows(grid[1], names)
    for axes, name in zip(grid, ("loss", "face"), strict=True):
        for place, line in enumerate(lines.to_dict("records")):
            colour = style_of(line["engine"]).colour
            axes.plot([line[f"{name}_low"], line[f"{name}_high"]], 2 * [place], color=colour)
            axes.plot(line[name], place, "o", color=colour)
    grid[0].set(xlabel="mean loss", xlim=(0.0, None))
    grid[1].set(xlabel="part that ends on the right face", xlim=(0.0, 1.0))
    return drawing
