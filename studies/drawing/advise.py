"""The price of an error for each engine."""

from __future__ import annotations

from textwrap import fill

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from studies.drawing import facets
from studies.drawing.facets import key, panels, rows
from studies.drawing.styles import title_of
from studies.measures.presets import look_of


def draw_advice(lines: pd.DataFrame, title: str) -> Figure:
    """Draw the time of a case with each preset that keeps an error, engines as rows."""
    engines, targets = list(lines["engine"].unique()), list(lines["target"].unique())
    each = (4.8, 0.9 + 0.3 * len(engines))
    drawing, grid = panels(len(targets), 2, each, 1.0, sharex=True, sharey=True)
    kept = lines[lines["message"] == ""]
    for axes, target in zip(grid, targets, strict=True):
        rows(axes, [title_of(name) for name in engines])
        axes.set_title(f"error of at most {100.0 * target:g} %", fontsize=10.5)
        axes.set(xscale="log", xlabel="time of a case  [ms]")
        mine = kept[kept["target"] == target]
        for line in mine.to_dict("records"):
            place = (1e3 * line["wall_s"], engines.index(line["engine"]))
            axes.plot(*place, "o", color=look_of(line["preset"]).colour)
            step = "own step" if np.isnan(line["value"]) else f"{line['value']:g}"
            above = -11 if line["preset"] == "recommended" else 5
            axes.annotate(step, place, (0, above), ha="center", fontsize=7,
                          textcoords="offset points", path_effects=facets.HALO)  # fmt: skip
        for engine in set(engines) - set(mine["engine"]):
            row = 0.01, engines.index(engine)
            axes.text(*row, "no setting keeps it", fontsize=7.5, color="#888888", va="center",
                      path_effects=facets.HALO, transform=axes.get_yaxis_transform())  # fmt: skip
    if len(kept):
        grid[0].set_xlim(0.5e3 * kept["wall_s"].min(), 2e3 * kept["wall_s"].max())
    note = "at the points: p dt, or the accuracy of an engine's own steps"
    drawing.suptitle(f"{fill(title, 88)}\n({note})", fontsize=11)
    key(drawing, facets.preset_dots(kept["preset"].unique()), 5)
    return drawing
