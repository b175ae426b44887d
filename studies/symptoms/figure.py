"""What is seen by default, with the one setting that helps most, and with all that is tuned."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from studies.drawing.styles import engine_style
from studies.measures.words import listed
from studies.symptoms.seen import HULL

STAGES = {"before": "as seen", "after": "one setting", "tuned": "tuned", "landing": "landing"}
MEASURES = {
    "max_error": "largest error of a peak  [–]",
    "newton_e": "|e| of an impact  [–]",
    "slip_widths": "slide of the pivot over B  [–]",
    "sink_widths": "depth of a corner over B  [–]",
    "energy_growth": "rise of energy  [–]",
    "off_over_all": "off by  [–]",
}
"""Column -> what it is called at an axis."""
WHY = {HULL: "adapters with a hull"}
"""Symptom -> why only some engines are asked."""
FLOOR = 1e-12
"""Sizes below are drawn here."""
BROKEN = 10.0
"""Where settings with cases that fail are drawn."""


def draw_symptoms(lines: pd.DataFrame) -> Figure:
    """Draw the size of each symptom by default, with one setting and with all, by engine.

    Parameters
    ----------
    lines : DataFrame
        The columns of symptoms.csv.
    """
    groups = list(lines.groupby("symptom", sort=False))
    engines = list(lines["engine"].unique())
    columns = 3
    rows = -(-len(groups) // columns)
    drawing = Figure(figsize=(9.6, 2.6 * rows + 0.5), layout="constrained")
    panels = drawing.subplots(rows, columns, sharex=True, squeeze=False).ravel()
    for axes, (symptom, group) in zip(panels, groups, strict=False):
        _panel(axes, group)
        asked = list(group["engine"].unique())
        why = WHY.get(str(symptom), "asked")
        only = "" if len(asked) > len(engines) // 2 else f" ({why}: {listed(asked)})"
        axes.set_title(_broken(f"{symptom}{only}"), fontsize=10)
        axes.set_ylabel(MEASURES.get(str(group.iloc[0]["measure"]), ""), fontsize=8.5)
    handles = [
        Line2D([], [], **{**engine_style(name, "").points(6.0), "linestyle": "-"}, label=name)
        for name in engines
    ]
    drawing.legend(handles=handles, loc="outside lower center", ncols=8, frameon=False)
    for axes in panels[len(groups) :]:
        axes.set_axis_off()
    return drawing


def _broken(words: str, width: int = 36) -> str:
    """Return a title in lines that fit above a panel."""
    lines = [""]
    for word in words.split():
        lines[-1:] = (
            [f"{lines[-1]} {word}".strip()] if len(lines[-1]) < width - 8 else [lines[-1], word]
        )
    return "\n".join(lines)


def _panel(axes: Axes, group: pd.DataFrame) -> None:
    places = np.arange(len(STAGES))
    for row in group.to_dict("records"):
        style = engine_style(str(row["engine"]), "")
        sizes = np.abs([float(row[name]) for name in STAGES])
        sizes = np.where(np.isinf(sizes), BROKEN, np.maximum(sizes, FLOOR))
        shown = np.isfinite(sizes)
        axes.plot(
            places[shown],
            sizes[shown],
            color=style.colour,
            marker=style.marker,
            fillstyle=style.fill,
            linewidth=1.2,
        )
    axes.set(yscale="log", xlim=(-0.3, len(STAGES) - 0.7))
    axes.set_xticks(places, list(STAGES.values()), fontsize=9)
    if axes.get_ylim()[1] >= BROKEN:
        axes.set_ylim(top=10.0 * BROKEN)
        axes.axhline(BROKEN, color="#999999", linewidth=0.6)
        axes.annotate("cases fail", (1.0, BROKEN), fontsize=8, color="#555555", va="bottom")
    axes.grid(alpha=0.25)
