"""What comes out of a coefficient of restitution against what is wanted."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from textwrap import wrap

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

from studies.drawing.facets import cells, in_rows
from studies.drawing.styles import engine_style, title_of
from studies.restitution.strikes import BASE, CORNER, RATE, Measure, lines

ACROSS = 3
"""Panels in a row."""
LETTERS = 36
"""In a line of a panel's title."""
KEPT, IGNORED, MOST = 0.05, 0.99, 0.2
"""A coefficient that is off by less is kept, by more not heard; what the title counts."""
LEAST = 1e-3
"""Deviations below have the lightest colour."""
VARIATIONS = {
    "off": "as it is",
    "off_p_dt": "other steps",
    "off_rate_over_alpha_p": "other rates",
    "off_height_m": "other heights",
    "off_aspect": "other H/B",
}
"""Column of deviations -> what is varied."""


USUAL = f"p dt {BASE.step:.0e}, {BASE.rate:g} α p, in the engine's colour"
VARIED = {"p_dt": ("p dt {:.0e}", "--"), "rate_over_alpha_p": ("{:.2g} α p", ":")}
"""What is varied, column -> what its value is written with, and the line it is drawn with."""


def draw_restitution(rows: pd.DataFrame, shown: Measure) -> Figure:
    """Draw the largest deviation of each way to ask, and what comes out where it is partly kept.

    Parameters
    ----------
    rows : DataFrame
        The columns of restitution.csv.
    shown : Measure
    """
    corner, off = lines(rows, CORNER)["off"], lines(rows, shown)
    heard = (corner < IGNORED) | (corner == math.inf)
    partly = off[heard & ((corner > KEPT) | (off["off"] > KEPT))][["engine", "way"]]
    down = math.ceil(len(partly) / ACROSS)
    parts = (1.1 + 0.24 * len(off), *([2.2 * down + 0.5] if down else []))
    drawing = Figure(figsize=(9.4, sum(parts) + 0.4 * (down > 0)), layout="constrained")
    upper, *lower = drawing.subfigures(len(parts), 1, height_ratios=parts, squeeze=False)[:, 0]
    _matrix(upper, off)
    for part in lower:
        _partly(part, rows, [*partly.itertuples(index=False)], shown)
    kept = int((off["off_over_all"] <= MOST).sum())
    drawing.suptitle(
        f"{shown.label}: {kept} of {len(off)} ways keep it within {MOST:g} whatever is varied",
        fontsize=12,
    )
    return drawing


draw_corners, draw_rates = (partial(draw_restitution, shown=shown) for shown in (CORNER, RATE))


def _matrix(drawing: SubFigure, off: pd.DataFrame) -> None:
    axes, values = drawing.subplots(), off[list(VARIATIONS)].to_numpy(float)
    shown = cells(axes, np.where(np.isinf(values), 1.0, values), LEAST, 1.0, [*VARIATIONS.values()])
    names = (
        off["engine"].map(title_of) + ": " + off["way"].str.replace("^and ", "… and ", regex=True)
    )
    axes.set_yticks(range(len(off)), names, fontsize=9)
    for (row, column), value in np.ndenumerate(values):
        words = "breaks" if math.isinf(value) else "0" if value < LEAST else f"{value:.2g}"
        axes.text(column, row, words, ha="center", va="center", fontsize=8.5,
                  color="white" if value > 0.06 else "black")  # fmt: skip
    drawing.colorbar(shown, ax=axes, label="largest deviation", aspect=30, pad=0.02)


def _partly(
    drawing: SubFigure, rows: pd.DataFrame, ways: Sequence[tuple[str, str]], shown: Measure
) -> None:
    grid = in_rows(drawing, len(ways), min(ACROSS, len(ways)), sharex=True, sharey=True)
    for axes, (engine, way) in zip(grid, ways, strict=True):
        mine = rows[(rows["engine"] == engine) & (rows["way"] == way)]
        _panel(axes, mine, shown, engine_style(engine, "").colour)
        axes.set_title("\n".join(wrap(f"{title_of(engine)}: {way}", LETTERS)), fontsize=9.5)
    handles, labels = grid[0].get_legend_handles_labels()
    drawing.legend(handles, labels, loc="outside upper center", ncols=len(labels), fontsize=8.5,
                   frameon=False)  # fmt: skip
    drawing.supylabel(shown.label, fontsize=9)
    drawing.supxlabel("coefficient of restitution that is wanted", fontsize=9)


def _panel(axes: Axes, group: pd.DataFrame, shown: Measure, colour: str) -> None:
    usual = group[group["varied"] == ""].groupby("wanted")
    right, base = usual[shown.right].first(), usual[shown.found]
    axes.plot(right.index, right, color="#777777", linewidth=0.8, label="as it should be")
    low, middle, high = base.min(), base.median(), base.max()
    axes.fill_between(low.index, low, high, color=colour, alpha=0.35, linewidth=0.0)
    axes.plot(middle.index, middle, color=colour, linewidth=1.1, label=USUAL)
    shades = colormaps["Greys"]
    for column, (words, line) in VARIED.items():
        mine = group[(group["varied"] != "") & group["varied"].map(column.startswith)]
        for place, (value, rows) in enumerate(mine.groupby(column)):
            found = rows.groupby("wanted")[shown.found].median()
            kept, lost = found.where(found < shown.top), found[~(found < shown.top)]
            shade, label = shades(0.55 + 0.35 * place), words.format(float(str(value)))
            axes.plot(kept.index, kept, line, color=shade, linewidth=1.1, label=label)
            axes.plot(lost.index, [shown.top - 0.05] * len(lost), "x", color=shade, markersize=5)
    axes.set(xlim=(-0.03, 1.03), ylim=(shown.low, shown.top))
    axes.grid(alpha=0.25)
