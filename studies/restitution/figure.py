"""What comes out of a coefficient of restitution against what is wanted."""

from __future__ import annotations

import math
from dataclasses import dataclass
from textwrap import wrap

import pandas as pd
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.drawing.styles import engine_style
from studies.restitution.strikes import BASE, CORNER, RATE, Measure

ACROSS = 4
"""Panels in a row."""
LETTERS = 30
"""In a line of a panel's title."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Shown:
    """What a figure shows.

    Attributes
    ----------
    measure : Measure
    label : str
        Of the ordinate.
    low, top : float
        Ends of the scale; what is above, or broken, stands at the top as a cross.
    """

    measure: Measure
    label: str
    low: float
    top: float


SHOWN = {
    "corners": Shown(
        measure=CORNER, label="speed of the corner after over before", low=-0.05, top=1.35
    ),
    "rates": Shown(measure=RATE, label="angular rate after over before", low=-0.75, top=1.15),
}
"""Name of a picture -> what it shows."""

USUAL = f"p dt {BASE.step:.0e}, {BASE.rate:g} α p, in the engine's colour"
VARIED = {"p_dt": ("p dt {:.0e}", "--"), "rate_over_alpha_p": ("{:.2g} α p", ":")}
"""What is varied, column -> what its value is written with, and the line it is drawn with."""


def draw_restitution(rows: pd.DataFrame, shown: Shown) -> Figure:
    """Draw what is found against what is wanted, a panel for each way to ask for it.

    Parameters
    ----------
    rows : DataFrame
        The columns of restitution.csv.
    shown : Shown
    """
    ways = list(rows.groupby(["engine", "way"], sort=False))
    down = math.ceil(len(ways) / ACROSS)
    drawing = Figure(figsize=(2.2 * ACROSS, 2.2 * down + 0.8), layout="constrained")
    grid = drawing.subplots(down, ACROSS, sharex=True, sharey=True, squeeze=False)
    for axes in grid.flat[len(ways) :]:
        axes.set_axis_off()
    for axes, ((engine, way), group) in zip(grid.flat, ways, strict=False):
        _panel(axes, group, shown, engine_style(str(engine), "").colour)
        axes.set_title("\n".join(wrap(f"{engine}: {way}", LETTERS)), fontsize=8)
        axes.tick_params(labelbottom=True, labelsize=8)
    handles, labels = grid.flat[0].get_legend_handles_labels()
    across = {"ncols": len(labels), "fontsize": 8, "frameon": False}
    drawing.legend(handles, labels, loc="outside upper center", **across)
    drawing.supylabel(shown.label, fontsize=9)
    drawing.supxlabel("coefficient of restitution that is wanted", fontsize=9)
    return drawing


def _panel(axes: Axes, group: pd.DataFrame, shown: Shown, colour: str) -> None:
    """Draw the band over where an impact falls in a step, and lines of what is varied."""
    usual = group[group["varied"] == ""].groupby("wanted")
    right, base = usual[shown.measure.right].first(), usual[shown.measure.found]
    axes.plot(right.index, right, color="#777777", linewidth=0.8, label="as it should be")
    low, middle, high = base.min(), base.median(), base.max()
    axes.fill_between(low.index, low, high, color=colour, alpha=0.35, linewidth=0.0)
    axes.plot(middle.index, middle, color=colour, linewidth=1.1, label=USUAL)
    shades = colormaps["Greys"]
    for column, (words, line) in VARIED.items():
        mine = group[(group["varied"] != "") & group["varied"].map(column.startswith)]
        for place, (value, rows) in enumerate(mine.groupby(column)):
            found = rows.groupby("wanted")[shown.measure.found].median()
            kept, lost = found.where(found < shown.top), found[~(found < shown.top)]
            shade, label = shades(0.55 + 0.35 * place), words.format(float(str(value)))
            axes.plot(kept.index, kept, line, color=shade, linewidth=1.1, label=label)
            axes.plot(lost.index, [shown.top - 0.05] * len(lost), "x", color=shade, markersize=5)
    axes.set(xlim=(-0.03, 1.03), ylim=(shown.low, shown.top))
    axes.grid(alpha=0.25)
