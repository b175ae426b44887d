"""The price of an error, and the size of what users see, for each engine."""

from __future__ import annotations

from textwrap import fill
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from studies.drawing import facets
from studies.drawing.facets import dot, error_scale, key, panels, rows
from studies.drawing.styles import title_of
from studies.kit.say import capital
from studies.measures.presets import look_of
from studies.measures.published import meaning_of

FLOOR, EDGE, BROKEN, END = 1e-8, 5.0, 20.0, 80.0
"""Sizes below are drawn here; from where to where cases fail, and the middle of that."""
STAGES: dict[str, tuple[str, dict[str, Any]]] = {
    "before": ("the library's defaults", {"marker": "o", "color": look_of("naive").colour}),
    "after": (
        "the one that helps most",
        {"marker": "D", "color": "#000000", "fillstyle": "none", "ms": 9.0},
    ),
    "tuned": ("contact tuned, fixed step", {"marker": "s", "color": look_of("fixed").colour}),
    "landing": ("steps that land on impacts", {"marker": "^", "color": look_of("landing").colour}),
}
"""Column -> what it is called, and how it is drawn."""


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


def draw_symptoms(lines: pd.DataFrame, title: str) -> Figure:
    """Draw the size of each symptom: by default and with what helps, engines as rows."""
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
                axes.plot(place, y, **{"ms": 5.5, **look})
        axes.set_title(fill(capital(str(symptom)), 40), fontsize=10, fontweight="bold", pad=16)
        axes.set_xlabel(meaning_of(str(group.iloc[0]["measure"])), fontsize=9)
        axes.tick_params(labelbottom=True)
        facets.strip_beyond(axes, EDGE, "fails", along="x")
    drawing.suptitle(title, fontsize=12)
    key(drawing, [dot(name, **look) for name, look in STAGES.values()], 4)
    return drawing
