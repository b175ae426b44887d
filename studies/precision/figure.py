"""Work-precision diagrams: error against run time, a line for each method."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from engines import ENGINES
from studies.drawing.labels import Name, around, beside, beyond
from studies.drawing.styles import LOWEST, Style, engine_style
from studies.measures.presets import told

STYLES = {
    "Taylor series": Style("#000000", "-", "o", 2.2),
    "SciPy RK45": Style("#999999", "-", "s"),
    "SciPy DOP853": Style("#777777", "--", "D"),
    "SciPy Radau": Style("#bbbbbb", "-.", "v"),
    "SciPy LSODA": Style("#555555", ":", "^"),
    "RK4": Style("#56B4E9", "-", "o"),
    "RK4, contact to 1e-6": Style("#56B4E9", "--", "x"),
    "average acceleration": Style("#E69F00", "-", "s"),
    "housner, closed form": Style("#D55E00", "", "*"),
    "modified, closed form": Style("#0072B2", "", "*"),
    "onset-matched, closed form": Style("#CC79A7", "", "*"),
}

AIMS = (1e-4, 1e-2)
"""Errors between which most applications are content: shaded."""
MANY = 12
"""More lines of engines than these are named by engine, and told apart by what follows."""
PRESETS_SAID = (
    "engines: full lines land on impacts or choose their own steps,\n"
    "dashed fixed steps, dotted defaults"
)
ROOM = 60.0
"""Factor of the time that the names of the closed forms take, and words that no marker is under."""
WRONG = 10.0
"""Where methods that fail or get outcomes wrong are drawn."""


def style_of(method: str) -> Style:
    """Return the style of a method; engines by their colours, others grey."""
    engine, _, varied = method.partition(" ")
    if method in STYLES or engine not in ENGINES:
        return STYLES.get(method, Style("#777777", "-", "."))
    preset, _, dial = varied.partition(", ")
    look = engine_style(engine, preset)
    if dial:
        return Style(look.colour, "-.", "+", 0.8)
    line = told(preset).line
    width = 2.0 if line == "-" else 1.4
    return Style(look.colour, line, look.marker, width, look.fill)


def draw_precision(table: pd.DataFrame) -> Figure:
    """Draw the median error of the peak against the run time of a case, a panel for each set.

    Parameters
    ----------
    table : DataFrame
        The columns of work-precision.csv.
    """
    drawing = Figure(figsize=(8.8, 12.0), layout="constrained")
    sets = list(table["set"].unique())
    panels = list(drawing.subplots(len(sets), 1, sharex=True, sharey=True, squeeze=False).flat)
    for axes, kind in zip(panels, sets, strict=True):
        _one_set(axes, table[table["set"] == kind])
        axes.set_title(f"{kind} cases")
        axes.set_ylabel("median relative error of the peak  [–]")
    panels[-1].set_xlabel("run time of a case, set-up apart  [s]")
    panels[-1].set_xlim(left=panels[-1].get_xlim()[0] / ROOM)
    drawing.draw_without_rendering()  # names stand where the panels come to lie
    _name_methods(panels, table)
    return drawing


def _name_methods(panels: Sequence[Axes], table: pd.DataFrame) -> None:
    """Write the engines at the right of the last panel, all other methods into the first."""
    is_engine = table["method"].str.partition(" ")[0].isin(list(ENGINES))
    finite = np.isfinite(table["median_error"])
    sets = table["set"].unique()
    others = table[finite & ~is_engine & (table["set"] == sets[0])]
    first = table[finite & (table["set"] == sets[0])]
    names = [_end(*group) for group in others.groupby("method", sort=False)]
    closed = [name for name in names if style_of(name.text).marker == "*"]
    beyond(panels[0], closed, -1)
    around(panels[0], [name for name in names if name not in closed])
    _name_the_front(panels[0], pareto(first))
    engines = table[finite & is_engine & (table["set"] == sets[-1])]
    ends = [_end(*group) for group in engines.groupby("method", sort=False)]
    if len(ends) > MANY:
        # the best preset of each stands for all of them, which share its colour and marker
        best = {end.text.partition(" ")[0]: end for end in ends if "," not in end.text}
        ends = [replace(end, text=engine) for engine, end in best.items()]
        panels[-1].text(0.32, 0.03, PRESETS_SAID, transform=panels[-1].transAxes, fontsize=8)
    beside(panels[-1], ends)


def _name_the_front(axes: Axes, front: pd.DataFrame) -> None:
    middle = front.iloc[len(front) // 2]
    spot = (middle["wall_s"], max(middle["median_error"], LOWEST))
    axes.annotate("nothing is faster\nand more accurate", spot, (0.3, 0.12), fontsize=7.5,
                  textcoords="axes fraction", color="#8a6d00",
                  arrowprops={"arrowstyle": "-", "color": "#c9a800", "linewidth": 0.8})  # fmt: skip


def _end(method: object, line: pd.DataFrame) -> Name:
    """Return the name of a method where its line ends, at its longest run."""
    last = line.sort_values("wall_s").iloc[-1]
    error = max(float(last["median_error"]), LOWEST)
    return Name(str(method), float(last["wall_s"]), error, style_of(str(method)).colour)


def _one_set(axes: Axes, table: pd.DataFrame) -> None:
    axes.set(xscale="log", yscale="log", ylim=(LOWEST / 3.0, 30.0))
    front = pareto(table)
    axes.plot(
        front["wall_s"],
        front["median_error"].clip(lower=LOWEST),
        color="#FFD54A",
        linewidth=7,
        alpha=0.6,
        solid_capstyle="round",
        zorder=0,
    )
    for name, line in table.groupby("method", sort=False):
        style = style_of(str(name))
        look = style.points(9.0 if style.marker == "*" else 4.5)
        whole = line[np.isfinite(line["median_error"])]
        axes.plot(
            whole["wall_s"],
            whole["median_error"].clip(lower=LOWEST),
            **{**look, "linestyle": style.line or "none", "linewidth": style.width},
        )
        # a case that was given up before it was timed has no place on the scale
        broken = line[~np.isfinite(line["median_error"]) & (line["wall_s"] > 0.0)]
        axes.plot(
            broken["wall_s"],
            np.full(len(broken), WRONG),
            **{**look, "marker": "X", "fillstyle": "full"},
        )
    axes.axhspan(*AIMS, color="#e8f1e4", zorder=-1)
    axes.axhspan(3.0, 30.0, color="#eeeeee", zorder=-1)
    for level, words in ((AIMS[0], "1e-4"), (AIMS[1], "1 %")):
        axes.text(0.985, level, words, transform=axes.get_yaxis_transform(), fontsize=7.5,
                  color="#5b7a4d", ha="right", va="center")  # fmt: skip
    axes.text(0.01, 0.985, "failed or wrong", ha="left", va="top", fontsize=8,
              color="#666666", transform=axes.transAxes)  # fmt: skip
    axes.grid(alpha=0.25)


def pareto(table: pd.DataFrame) -> pd.DataFrame:
    """Return the rows that no other row beats in both time and error, by rising time."""
    ordered = table[np.isfinite(table["median_error"])].sort_values("wall_s")
    best = ordered["median_error"].cummin().shift(fill_value=np.inf)
    front: pd.DataFrame = ordered[ordered["median_error"] < best]
    return front
