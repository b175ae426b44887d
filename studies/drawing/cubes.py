"""Tossed cubes: what engines lose with each of their settings."""

import pandas as pd
from matplotlib.figure import Figure

from studies.drawing.facets import rows, sheet
from studies.drawing.styles import style_of, title_of


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
