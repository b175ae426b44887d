"""The steady-state diagram: largest rotation against frequency or amplitude, up and down."""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from studies.drawing.styles import style_of

LABELS = {
    "frequency": "frequency of the shaking  ω/p  [–]",
    "amplitude": "amplitude of the shaking over the onset  $a_p$ / (g tan α)  [–]",
}
ARROWS = {"up": ("#0072B2", "▸ swept up"), "down": ("#D55E00", "◂ swept down")}


def draw_harmonic(table: pd.DataFrame, engines: pd.DataFrame, over: str) -> Figure:
    """Draw the larger and the smaller side of every steady state, and the engines on them."""
    drawing = Figure(figsize=(8.6, 4.8), layout="constrained")
    axes = drawing.subplots()
    for direction, (colour, label) in ARROWS.items():
        part = table[table["direction"] == direction].sort_values("x")
        settled = part.where(part["period"] > 0)
        wide = {"up": 4.0, "down": 1.6}[direction]
        axes.plot(part["x"], settled["larger_ratio"], color=colour, linewidth=wide, label=label)
        axes.plot(part["x"], settled["smaller_ratio"], color=colour, linewidth=0.9, linestyle=":")
        loose = part[(part["period"] == 0) & np.isfinite(part["larger_ratio"])]
        axes.scatter(loose["x"], loose["larger_ratio"], s=8, color=colour, alpha=0.6)
        fallen = part[part["outcome"] == "overturned"]
        height = {"up": 1.12, "down": 1.15}[direction]
        axes.scatter(fallen["x"], np.full(len(fallen), height), marker="|", s=30, color=colour)
    if (table["outcome"] == "overturned").any():
        axes.text(table["x"].min(), 1.17, "overturns", fontsize=8, va="bottom")
    for source, rows in engines.groupby("source", sort=False) if len(engines) else ():
        style = style_of(str(source))
        axes.scatter(
            rows["x"],
            rows["larger_ratio"],
            marker=style.marker or "o",
            s=34,
            facecolor="none",
            edgecolor=style.colour,
            label=f"{source}, from the exact orbit",
            zorder=4,
        )
    axes.set_ylim(0.0, 1.24)
    axes.set_xlabel(LABELS[over])
    axes.set_ylabel("largest steady rotation  |θ|/θcr  [–]")
    axes.plot(
        [], [], color="#777777", linewidth=0.9, linestyle=":", label="largest to the other side"
    )
    axes.set_title("Steady states under sustained harmonic shaking", fontsize=10)
    axes.legend(fontsize=8, frameon=False, ncols=2)
    return drawing
