"""How far each answer is from the print, in units of what the print allows."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from studies.drawing.styles import name_of, style_of
from studies.measures.differences import scientific

WIDEST = 12.0
"""Answers further than this from the print, in units of its half interval, stand at the edge."""

NAMES = {"exact": "exact", "housner": "Housner"}


def draw_literature(table: pd.DataFrame) -> Figure:
    """Draw every answer of agreement.csv, a line for each printed number."""
    places = list(dict.fromkeys(zip(table["problem"], table["side"], strict=True)))
    drawing = Figure(figsize=(9.0, 0.29 * len(places) + 1.5), layout="constrained")
    axes = drawing.subplots()
    axes.axvspan(-1.0, 1.0, color="#DDEEDD", zorder=0)
    middle, half = 0.5 * (table["low"] + table["high"]), 0.5 * (table["high"] - table["low"])
    table = table.assign(
        off=((table["value"] - middle) / half).clip(-WIDEST, WIDEST),
        height=[-places.index(pair) for pair in zip(table["problem"], table["side"], strict=True)],
    )
    sources = list(table["source"].unique())
    for number, source in enumerate(sources):
        rows, style = table[table["source"] == source], style_of(source)
        printed = rows["model"] == source
        nudge = 0.6 * ((number + 0.5) / len(sources) - 0.5)
        for filled, part in (("full", rows[printed]), ("none", rows[~printed])):
            axes.plot(
                part["off"],
                part["height"] - nudge,
                **{**style.points(6.0), "marker": style.marker or "D", "fillstyle": filled},
                zorder=3,
            )
    _say_how_far(axes, table)
    labels = table.drop_duplicates(["problem", "side"])
    axes.set_yticks(
        -np.arange(len(places)),
        [f"{row.problem}: {row.printed}" for row in labels.itertuples()],
        fontsize=8,
    )
    axes.set_xlim(-1.06 * WIDEST, 1.06 * WIDEST)
    axes.set_ylim(-len(places) + 0.4, 0.6)
    axes.set_xlabel(
        "answer less print, in units of half of what the print's digits allow;\n"
        "at the edges: further away, by this part of the print at most"
    )
    axes.set_title("Inside the band: agrees to every printed digit", fontsize=10)
    axes.grid(axis="y", color="#EEEEEE")
    looks = ({**style_of(name).points(6.0), "fillstyle": "full"} for name in sources)
    handles = [
        Line2D([], [], **{**look, "marker": style_of(name).marker or "D"},
               label=NAMES.get(name, name_of(name)))
        for name, look in zip(sources, looks, strict=True)
    ]  # fmt: skip
    drawing.legend(handles=handles, loc="outside lower center", fontsize=9, ncols=5,
                   title="filled: the model of the print; open: others", frameon=False)  # fmt: skip
    return drawing


def _say_how_far(axes: Axes, table: pd.DataFrame) -> None:
    """Write beside the points at either edge by what part of the print the furthest misses it."""
    far = table[table["off"].abs() == WIDEST]
    worst = far.groupby(["height", "off"], as_index=False)["miss"].max()
    for height, off, miss in worst.to_numpy(dtype=np.float64).tolist():
        side = "right" if off > 0.0 else "left"
        place = (0.965 * off, height)
        axes.text(*place, scientific(miss), ha=side, va="center", fontsize=7.5, color="#444444")
