"""Work-precision diagrams: error against run time, a line for each method."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from engines import ENGINES
from studies.drawing.styles import LOWEST, Style, engine_style

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

LINES = {"naive": (":", 1.4), "fixed": ("--", 1.4), "iterations": ("-.", 0.8)}
"""What is varied of an engine -> its line and how thick that is; the best preset's is full."""


def style_of(method: str) -> Style:
    """Return the style of a method; engines by their colours, others grey."""
    engine, _, varied = method.partition(" ")
    if method in STYLES or engine not in ENGINES:
        return STYLES.get(method, Style("#777777", "-", "."))
    preset, _, dial = varied.partition(", ")
    line, width = LINES.get(dial or preset, ("-", 2.0))
    look = engine_style(engine, preset)
    return Style(look.colour, line, "+" if dial else look.marker, width)


def draw_precision(table: pd.DataFrame) -> Figure:
    """Draw the median error of the peak against the run time of a case, a panel for each set.

    Parameters
    ----------
    table : DataFrame
        The columns of work-precision.csv.
    """
    drawing = Figure(figsize=(11.0, 7.6), layout="constrained")
    sets = list(table["set"].unique())
    panels = drawing.subplots(1, len(sets), sharey=True, squeeze=False)[0]
    for axes, kind in zip(panels, sets, strict=True):
        _one_set(axes, table[table["set"] == kind])
        axes.set_title(f"{kind} cases")
        axes.set_xlabel("run time of a case, set-up apart  [s]")
    panels[0].set_ylabel("median relative error of the peak  [–]")
    handles = [_handle(str(name)) for name in table["method"].unique()]
    handles.append(Line2D([], [], color="#FFD54A", linewidth=5, alpha=0.6, label="Pareto front"))
    drawing.legend(handles=handles, loc="outside lower center", ncols=4, frameon=False, fontsize=9)
    return drawing


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
        whole = line[np.isfinite(line["median_error"])]
        axes.plot(
            whole["wall_s"],
            whole["median_error"].clip(lower=LOWEST),
            color=style.colour,
            linestyle=style.line or "none",
            marker=style.marker,
            linewidth=style.width,
            markersize=9 if style.marker == "*" else 4.5,
        )
        broken = line[~np.isfinite(line["median_error"])]
        axes.plot(
            broken["wall_s"],
            np.full(len(broken), 10.0),
            color=style.colour,
            linestyle="none",
            marker="X",
            markersize=8,
        )
    axes.axhspan(3.0, 30.0, color="#eeeeee", zorder=-1)
    axes.text(0.98, 0.985, "failed, or wrong outcomes", ha="right", va="top", fontsize=8,
              color="#666666", transform=axes.transAxes)  # fmt: skip
    axes.grid(alpha=0.25)


def pareto(table: pd.DataFrame) -> pd.DataFrame:
    """Return the rows that no other row beats in both time and error, by rising time."""
    ordered = table[np.isfinite(table["median_error"])].sort_values("wall_s")
    best = ordered["median_error"].cummin().shift(fill_value=np.inf)
    front: pd.DataFrame = ordered[ordered["median_error"] < best]
    return front


def _handle(name: str) -> Line2D:
    style = style_of(name)
    handle = Line2D([], [], color=style.colour, linewidth=style.width, label=name)
    handle.set(linestyle=style.line or "none", marker=style.marker, markersize=5)
    return handle
