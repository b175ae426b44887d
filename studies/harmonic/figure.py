"""The steady-state diagram: every orbit that was found, and its share of the starts."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analytic.response import Outcome
from studies.drawing.kept import Pictures
from studies.drawing.styles import name_of, style_of
from studies.harmonic.study import settings_of
from studies.kit.tables import table_in

LABELS = {
    "frequency": "frequency of the shaking  ω/p  [–]",
    "amplitude": "amplitude of the shaking over the onset  $a_p$ / (g tan α)  [–]",
}
COLOURS = {1: "#0072B2", 2: "#E69F00", 3: "#D55E00", 0: "#555555"}
"""Of the orbits of a period; 0: those that do not repeat."""
LONGER, RESTING, FALLEN = "#CC79A7", "#9bd3c4", "#e4e4e4"
"""Colours of all other periods, of a block at rest, and of overturning."""
NAMES = {
    **{COLOURS[period]: f"period {period}" for period in (1, 2, 3)},
    **{LONGER: "another period", COLOURS[0]: "does not repeat"},
}


def draw_harmonic(table: pd.DataFrame, engines: pd.DataFrame, over: str) -> Figure:
    """Draw both sides of every steady state, the engines on them, and the shares of the starts."""
    drawing = Figure(figsize=(8.6, 6.4), layout="constrained")
    upper, lower = drawing.subplots(2, sharex=True, height_ratios=(3, 1.3))
    _orbits(upper, table[table["outcome"] == Outcome.ROCKED.value])
    _engines(upper, engines)
    _shares(lower, table)
    lower.set(xlabel=LABELS[over], ylabel="share of the starts  [–]", ylim=(0.0, 1.0))
    lower.set_xlim(table["x"].min(), table["x"].max())
    drawing.suptitle("Steady states under sustained harmonic shaking", fontsize=10)
    drawing.legend(loc="outside right upper", fontsize=8, frameon=False)
    return drawing


def _orbits(axes: Axes, rocked: pd.DataFrame) -> None:
    drawn = rocked["period"].map(lambda period: COLOURS.get(period, LONGER))
    for colour, name in NAMES.items():
        rows = rocked[drawn == colour]
        if rows.empty:
            continue
        axes.plot(rows["x"], rows["larger_ratio"], "o", color=colour, markersize=3.2, label=name)
        axes.plot(rows["x"], rows["smaller_ratio"], "_", color=colour, markersize=4.0)
    axes.plot([], [], "_", color="#555555", markersize=6.0, label="largest to the\nother side")
    axes.set(ylabel="largest steady rotation  |θ|/θcr  [–]", ylim=(0.0, None))
    axes.grid(alpha=0.25)


def _engines(axes: Axes, engines: pd.DataFrame) -> None:
    for source, rows in engines.groupby("source", sort=False) if len(engines) else ():
        style = style_of(str(source)).points(7.0)
        label = f"{name_of(str(source))}, from\nthe exact orbit"
        axes.plot(rows["x"], rows["larger_ratio"], **style, label=label, zorder=4)


def _shares(axes: Axes, table: pd.DataFrame) -> None:
    rocked = table["outcome"] == Outcome.ROCKED.value
    kinds = table["period"].map(str).where(rocked, table["outcome"])
    shares = table["start_share"].groupby([table["x"], kinds]).sum().unstack(fill_value=0)
    periods = sorted(set(table.loc[rocked, "period"].tolist()))
    looks = {str(period): (COLOURS.get(period, LONGER), "") for period in periods}
    looks[Outcome.AT_REST.value] = RESTING, "at rest"
    looks[Outcome.OVERTURNED.value] = FALLEN, "overturns"
    drawn = {kind: look for kind, look in looks.items() if kind in shares}
    colours, names = zip(*drawn.values(), strict=True)
    axes.stackplot(shares.index, shares[[*drawn]].T, colors=colours, labels=names)


def pictures(folder: Path) -> Pictures:
    """Draw the diagram of a folder from its tables alone."""
    swept, over = table_in(folder, "harmonic"), settings_of(folder)["over"]
    return {"harmonic": draw_harmonic(swept, table_in(folder, "engines"), over)}
