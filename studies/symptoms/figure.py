"""What is seen by default, with the one setting that helps most, and with all that is tuned."""

from __future__ import annotations

from textwrap import fill
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.drawing.facets import dot, error_scale, key, panels, rows, strip_beyond
from studies.drawing.styles import title_of
from studies.measures.presets import told
from studies.measures.words import capital

STAGES: dict[str, tuple[str, dict[str, Any]]] = {
    "before": ("the library's defaults", {"marker": "o", "color": told("naive").colour}),
    "after": (
        "with the one setting that helps most",
        {"marker": "D", "color": "#000000", "fillstyle": "none", "markersize": 9.0},
    ),
    "tuned": ("contact tuned, fixed step", {"marker": "s", "color": told("fixed").colour}),
    "landing": ("steps that land on impacts", {"marker": "^", "color": told("landing").colour}),
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
FLOOR = 1e-8
"""Sizes below are drawn here."""
EDGE, BROKEN, END = 5.0, 20.0, 80.0
"""Where settings with cases that fail are drawn, and the strip around that."""
LETTERS = 40
"""In a line of a title."""


def draw_symptoms(lines: pd.DataFrame) -> Figure:
    """Draw the size of each symptom: engines as rows, by default and with what mends it as dots."""
    groups = list(lines.groupby("symptom", sort=False))
    engines = list(lines["engine"].unique())
    drawing, grid = panels(
        len(groups), 3, (3.5, 0.95 + 0.22 * len(engines)), 1.0, sharex=True, sharey=True
    )
    grid[0].set(xscale="log", xlim=(0.3 * FLOOR, END))
    error_scale(grid[0].xaxis, FLOOR, 1.0)
    for axes, (symptom, group) in zip(grid, groups, strict=True):
        _panel(axes, group, engines)
        axes.set_title(fill(capital(str(symptom)), LETTERS), fontsize=10, fontweight="bold", pad=16)
        axes.set_xlabel(MEASURES.get(str(group.iloc[0]["measure"]), ""), fontsize=9)
        axes.tick_params(labelbottom=True)
        strip_beyond(axes, EDGE, "fails", along="x")
    drawing.suptitle(_title(lines), fontsize=12)
    key(drawing, [dot(name, **look) for name, look in STAGES.values()], 4)
    return drawing


def _title(lines: pd.DataFrame) -> str:
    mended = lines[lines["after"].notna()]
    factor = (mended["before"] / mended["after"]).abs().median()
    return (
        f"One setting helps in {len(mended)} of {len(lines)} pairs of engine and symptom, "
        f"in half of them by a factor of {max(factor, 1.0):.0f} or more"
    )


def _panel(axes: Axes, group: pd.DataFrame, engines: list[str]) -> None:
    rows(axes, [title_of(name) for name in engines])
    for row in group.to_dict("records"):
        sizes = np.abs([float(row[name]) for name in STAGES])
        places = np.where(np.isinf(sizes), BROKEN, np.maximum(sizes, FLOOR))
        y = engines.index(str(row["engine"]))
        shown = places[np.isfinite(places)]
        axes.plot([shown.min(), shown.max()], [y, y], color="#bbbbbb", linewidth=1.2)
        for place, (_, look) in zip(places, STAGES.values(), strict=True):
            axes.plot(place, y, **{"markersize": 5.5, **look})
    for engine in set(engines) - set(group["engine"]):
        axes.text(2.0 * FLOOR, engines.index(engine), "not asked", fontsize=7.5, color="#888888",
                  va="center")  # fmt: skip
