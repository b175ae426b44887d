"""The price of an error, and the size of what users see, for each engine."""

from __future__ import annotations

from textwrap import fill
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from engines.declaration import RECOMMENDED
from studies.drawing import facets
from studies.drawing.facets import dot, error_scale, key, panels, rows
from studies.drawing.styles import title_of
from studies.kit.say import capital
from studies.measures.presets import look_of

FLOOR, EDGE, BROKEN, END = 1e-8, 5.0, 20.0, 80.0
"""Sizes below are drawn here; from where to where cases fail, and the middle of that."""
STAGES: dict[str, tuple[str, dict[str, Any]]] = {
    "before": ("the library's defaults", {"marker": "o", "color": look_of("naive").colour}),
    "after": (
        "with the one setting that helps most",
        {"marker": "D", "color": "#000000", "fillstyle": "none", "markersize": 9.0},
    ),
    "tuned": ("contact tuned, fixed step", {"marker": "s", "color": look_of("fixed").colour}),
    "landing": ("steps that land on impacts", {"marker": "^", "color": look_of("landing").colour}),
}
"""Column -> what it is called, and how it is drawn."""
MEASURES = {
    "max_error": "largest error of a peak",
    "newton_e": "|e| of an impact",
    "slip_widths": "slide of the pivot over B",
    "sink_widths": "depth of a corner over B",
    "energy_growth": "rise of energy",
    "off_over_all": "largest deviation from e",
}
"""Column -> what it is called at an axis."""


def draw_advice(lines: pd.DataFrame, title: str) -> Figure:
    """Draw the time of a case with each preset that keeps an error: engines as rows.

    A panel for each error; at a point the step, p dt, or the accuracy of an engine's own.
    """
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
            below = line["preset"] == RECOMMENDED
            axes.annotate(step, place, (0, -11 if below else 5), ha="center", fontsize=7,
                          textcoords="offset points", path_effects=facets.HALO)  # fmt: skip
        for engine in set(engines) - set(mine["engine"]):
            _in_row(axes, 0.01, engines.index(engine), "no setting keeps it")
    if len(kept):
        grid[0].set_xlim(0.5e3 * kept["wall_s"].min(), 2e3 * kept["wall_s"].max())
    note = "at the points: p dt, or the accuracy of an engine's own steps"
    drawing.suptitle(f"{fill(title, 88)}\n({note})", fontsize=11)
    key(drawing, facets.preset_dots(kept["preset"].unique()), 5)
    return drawing


def draw_symptoms(lines: pd.DataFrame, title: str) -> Figure:
    """Draw the size of each symptom: engines as rows, by default and with what mends it as dots."""
    groups, engines = list(lines.groupby("symptom", sort=False)), list(lines["engine"].unique())
    each = (3.5, 0.95 + 0.22 * len(engines))
    drawing, grid = panels(len(groups), 3, each, 1.0, sharex=True, sharey=True)
    grid[0].set(xscale="log", xlim=(0.3 * FLOOR, END))
    error_scale(grid[0].xaxis, FLOOR, 1.0)
    for axes, (symptom, group) in zip(grid, groups, strict=True):
        rows(axes, [title_of(name) for name in engines])
        for line in group.to_dict("records"):
            sizes, y = np.abs([float(line[name]) for name in STAGES]), engines.index(line["engine"])
            places = np.where(np.isinf(sizes), BROKEN, np.maximum(sizes, FLOOR))
            axes.plot([np.nanmin(places), np.nanmax(places)], [y, y], color="#bbbbbb", lw=1.2)
            for place, (_, look) in zip(places, STAGES.values(), strict=True):
                axes.plot(place, y, **{"markersize": 5.5, **look})
        for engine in set(engines) - set(group["engine"]):
            _in_row(axes, 0.03, engines.index(engine), "not asked")
        axes.set_title(fill(capital(str(symptom)), 40), fontsize=10, fontweight="bold", pad=16)
        axes.set_xlabel(MEASURES.get(str(group.iloc[0]["measure"]), ""), fontsize=9)
        axes.tick_params(labelbottom=True)
        facets.strip_beyond(axes, EDGE, "fails", along="x")
    drawing.suptitle(title, fontsize=12)
    key(drawing, [dot(name, **look) for name, look in STAGES.values()], 4)
    return drawing


def _in_row(axes: Any, x: float, row: int, words: str) -> None:
    axes.text(x, row, words, fontsize=7.5, color="#888888", va="center", path_effects=facets.HALO,
              transform=axes.get_yaxis_transform())  # fmt: skip
