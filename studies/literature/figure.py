"""How far each answer is from the print, in units of what the print allows."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from studies.drawing.facets import key
from studies.drawing.styles import name_of, style_of
from studies.measures.words import part

WIDEST = 12.0
"""Answers further than this from the print, in units of its half interval, stand at the edge."""

NAMES = {"housner": "Housner"}


def draw_literature(table: pd.DataFrame) -> Figure:
    """Draw every answer of agreement.csv, a line for each printed number."""
    half = 0.5 * (table["high"] - table["low"])
    prints = table.groupby(["problem", "side"], sort=False)
    table = table.assign(
        off=((table["value"] - table["low"] - half) / half).clip(-WIDEST, WIDEST),
        height=-prints.ngroup(),
    )
    drawing = Figure(figsize=(9.0, 0.29 * len(prints) + 1.5), layout="constrained")
    axes = drawing.subplots()
    axes.axvspan(-1.0, 1.0, color="#DDEEDD", zorder=0)
    sources, handles = table.groupby("source", sort=False), []
    for number, (source, rows) in enumerate(sources):
        style = style_of(str(source))
        look = {**style.points(6.0), "marker": style.marker or "D"}
        nudge = 0.6 * ((number + 0.5) / len(sources) - 0.5)
        for printed, here in rows.groupby(rows["model"] == source):
            look["fillstyle"] = "full" if printed else "none"
            axes.plot(here["off"], here["height"] - nudge, **look, zorder=3)
        name = NAMES.get(str(source), name_of(str(source)))
        handles.append(Line2D([], [], label=name, **{**look, "fillstyle": "full"}))
    # by what part of the print the furthest of those at either edge misses it
    far = table[table["off"].abs() == WIDEST].groupby(["height", "off"], as_index=False)["miss"]
    for height, off, miss in far.max().to_numpy(dtype=np.float64).tolist():
        side = "right" if off > 0.0 else "left"
        axes.text(0.965 * off, height, part(miss), ha=side, va="center", fontsize=7.5,
                  color="#444444")  # fmt: skip
    labels = prints.first().reset_index()
    axes.set_yticks(
        -np.arange(len(labels)), labels["problem"] + ": " + labels["printed"], fontsize=8
    )
    axes.set(xlim=(-1.06 * WIDEST, 1.06 * WIDEST), ylim=(-len(labels) + 0.4, 0.6))
    axes.set_xlabel(
        "answer less print, in units of half of what the print's digits allow;\n"
        "at the edges: further away, by this part of the print at most"
    )
    axes.set_title("Inside the band: agrees to every printed digit", fontsize=10)
    axes.grid(axis="y", color="#EEEEEE")
    key(drawing, handles, 5, title="filled: the model of the print; open: others")
    return drawing
