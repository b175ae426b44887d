"""True errors against estimates: below the line an estimate is enough, far above it is blind."""

from textwrap import fill

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.drawing.labels import Name, beside
from studies.drawing.styles import style_of
from studies.measures.presets import in_order, in_words, preset_of

FLOOR = 1e-10
"""Errors and estimates below are drawn here."""
TITLE = 36
"""Letters in a line of a panel's title."""


def draw_estimates(lines: pd.DataFrame) -> Figure:
    """Draw the error of every case against its estimate, a panel for each preset.

    Parameters
    ----------
    lines : DataFrame
        The columns of estimates.csv.
    """
    lines = lines[lines["over"].notna() & np.isfinite(lines["estimate"])]
    presets = lines["source"].map(preset_of)
    names = in_order(presets)
    drawing = Figure(figsize=(2.9 * len(names) + 0.9, 4.2), layout="constrained")
    panels = drawing.subplots(1, len(names), sharex=True, sharey=True, squeeze=False)[0]
    ends = np.array([FLOOR, 10.0])
    for axes, preset in zip(panels, names, strict=True):
        axes.plot(ends, ends, color="#777777", linewidth=0.9)
        axes.plot(ends, 10.0 * ends, color="#777777", linewidth=0.9, linestyle=":")
        _points(axes, lines[presets == preset])
        axes.set(xscale="log", yscale="log", xlim=(FLOOR / 2, 10.0), ylim=(FLOOR / 2, 10.0))
        axes.set_title(fill(in_words(preset), TITLE), fontsize=9)
        axes.set_xlabel("difference to half the step  [–]")
        axes.grid(alpha=0.25)
    panels[0].set_ylabel("true error of the peak  [–]")
    ten = [
        Name("error = 10 ×", 1.0, 10.0, "#777777"),
        Name("error = 1 ×", 10.0, 5.0, "#777777"),
    ]
    beside(panels[-1], ten, 8.0)
    drawing.suptitle("Whether the change by half the step tells the error; "
                     "counted: above ten times the change", fontsize=11)  # fmt: skip
    return drawing


def _points(axes: Axes, lines: pd.DataFrame) -> None:
    """Draw the cases of each engine, and write its name and how many lie above ten estimates."""
    groups = list(lines.groupby("source", sort=False))
    for place, (source, rows) in enumerate(reversed(groups)):
        style = style_of(str(source))
        axes.plot(
            rows["estimate"].clip(lower=FLOOR),
            rows["error"].abs().clip(lower=FLOOR),
            **style.points(4.0),
        )
        above = int((rows["over"] > 10.0).sum())
        axes.text(
            0.97,
            0.03 + 0.05 * place,
            f"{str(source).partition(':')[0]}: {above} of {len(rows)}",
            color=style.colour,
            fontsize=7.5,
            transform=axes.transAxes,
            ha="right",
            va="bottom",
        )
