"""How far each answer is from the print, in units of what the print allows."""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from studies.drawing.styles import style_of

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
    for number, (source, rows) in enumerate(table.groupby("source", sort=False)):
        style = style_of(str(source))
        printed = rows["model"] == source
        nudge = 0.12 * (number % 3 - 1)
        for filled, part in ((True, rows[printed]), (False, rows[~printed])):
            axes.scatter(
                part["off"],
                part["height"] + nudge,
                marker=style.marker or "D",
                s=30,
                facecolor=style.colour if filled else "none",
                edgecolor=style.colour,
                label=NAMES.get(str(source), str(source)) if filled == printed.any() else None,
                zorder=3,
            )
    labels = table.drop_duplicates(["problem", "side"])
    axes.set_yticks(
        -np.arange(len(places)),
        [f"{row.problem}: {row.printed}" for row in labels.itertuples()],
        fontsize=8,
    )
    axes.set_xlim(-1.06 * WIDEST, 1.06 * WIDEST)
    axes.set_ylim(-len(places) + 0.4, 0.6)
    axes.set_xlabel("answer less print, in units of half of what the print's digits allow")
    axes.set_title("Inside the band: agrees to every printed digit", fontsize=10)
    axes.grid(axis="y", color="#EEEEEE")
    axes.legend(loc="upper right", fontsize=8, title="filled: the model of the print")
    return drawing
