"""The ensemble drawn: single responses, their distribution, and the fragility of each block."""

import math

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from studies.drawing.styles import style_of

LEAST, BEYOND = 1e-2, 3.0
"""Ends of the scale of the peaks: less is drawn at its foot, and overturned blocks at its top."""


def draw_ensemble(rows: pd.DataFrame, stripes: pd.DataFrame, curves: pd.DataFrame) -> Figure:
    """Draw a row of three panels for each block.

    Parameters
    ----------
    rows, stripes, curves : DataFrame
        ensemble.csv, stripes.csv and curves.csv.
    """
    sizes = list(rows[["width_m", "height_m"]].drop_duplicates().itertuples(index=False))
    sources = list(rows["source"].unique())
    drawing = Figure(figsize=(13.0, 3.9 * len(sizes) + 1.2), layout="constrained")
    grid = drawing.subplots(len(sizes), 3, squeeze=False)
    for line, size in zip(grid, sizes, strict=True):
        _singles(line[0], _of(rows, size))
        _distribution(line[1], _of(rows, size), _of(stripes, size))
        _fragility(line[2], _of(stripes, size), _of(curves, size))
        line[0].set_ylabel(f"B = {size.width_m:g} m, H = {size.height_m:g} m\n"
                           "peak by the source  |θ|/θcr  [–]")  # fmt: skip
    for axes, title in zip(
        grid[0],
        ("One response beside the exact one", "", "Probability of overturning"),
        strict=True,
    ):
        axes.set_title("\n".join(filter(None, (title, axes.get_title()))), fontsize=11)
    drawing.legend(
        handles=[_handle(source) for source in sources],
        loc="outside lower center",
        ncols=math.ceil(len(sources) / 2),
        frameon=False,
    )
    return drawing


def _of(table: pd.DataFrame, size: tuple[float, float]) -> pd.DataFrame:
    return table[(table["width_m"] == size[0]) & (table["height_m"] == size[1])]


def _shown(peaks: "pd.Series[float]") -> "pd.Series[float]":
    return peaks.replace(math.inf, BEYOND).clip(LEAST, BEYOND)


def _singles(axes: Axes, rows: pd.DataFrame) -> None:
    case = ["motion", "intensity"]
    exact = rows[rows["source"] == "exact"].set_index(case)["peak_ratio"]
    axes.plot([LEAST, BEYOND], [LEAST, BEYOND], color="#999999", linewidth=0.8, zorder=1)
    for source, group in rows[rows["source"] != "exact"].groupby("source", sort=False):
        style = style_of(str(source))
        found = group.set_index(case)["peak_ratio"]
        axes.plot(
            _shown(exact.reindex(found.index)),
            _shown(found),
            linestyle="none",
            marker=style.marker or ".",
            markersize=3.5 if style.marker else 3.0,
            markerfacecolor="none" if style.marker else style.colour,
            markeredgewidth=0.7,
            color=style.colour,
        )
    axes.set(xscale="log", yscale="log", xlabel="exact peak  |θ|/θcr  [–]")
    for scale in (axes.xaxis, axes.yaxis):
        scale.set_ticks([LEAST, 0.1, 1.0, BEYOND], ["≤ 0.01", "0.1", "1", "over-\nturned"])
        scale.set_ticks([], minor=True)
    axes.grid(alpha=0.25)


def _distribution(axes: Axes, rows: pd.DataFrame, stripes: pd.DataFrame) -> None:
    """Draw the shares of peaks below a peak at the intensity nearest to even odds."""
    exact = stripes[stripes["source"] == "exact"]
    level = float(exact["intensity"].iloc[int((exact["share"] - 0.5).abs().argmin())])
    for source, group in rows[rows["intensity"] == level].groupby("source", sort=False):
        style = style_of(str(source))
        peaks = np.sort(group["peak_ratio"].dropna())
        axes.step(
            [LEAST, *np.clip(peaks, LEAST, BEYOND), BEYOND],
            [0.0, *(np.arange(1, len(peaks) + 1) / max(len(peaks), 1)), 1.0],
            where="post",
            color=style.colour,
            linestyle=_line(str(source)),
            linewidth=style.width,
        )
    axes.set(xscale="log", xlabel="peak  |θ|/θcr  [–]", ylabel="share of motions below  [–]")
    axes.set_xlim(LEAST, BEYOND)
    axes.xaxis.set_ticks([LEAST, 0.1, 1.0, BEYOND], ["0.01", "0.1", "1", "over-\nturned"])
    axes.xaxis.set_ticks([], minor=True)
    axes.set_title(f"Distribution of the peak at {level:g} onsets", fontsize=10)
    axes.grid(alpha=0.25)


def _fragility(axes: Axes, stripes: pd.DataFrame, curves: pd.DataFrame) -> None:
    sources = list(stripes["source"].unique())
    for number, source in enumerate(sources):
        style = style_of(source)
        curve = curves[curves["source"] == source]
        axes.plot(
            curve["intensity"],
            curve["probability"],
            linestyle=_line(source),
            color=style.colour,
            linewidth=style.width,
        )
        if source == "exact":
            axes.fill_between(curve["intensity"], curve["low"], curve["high"], color="#dddddd")
        stripe = stripes[stripes["source"] == source]
        # side by side, or one would hide the other
        beside = 1.0 + 0.008 * (number - 0.5 * len(sources))
        axes.plot(
            beside * stripe["intensity"],
            stripe["share"],
            linestyle="none",
            marker=style.marker or ".",
            markersize=4.0,
            markerfacecolor="none",
            color=style.colour,
        )
    axes.set(xscale="log", xlabel="PGA / (g tan α)  [–]", ylabel="overturned  [–]")
    ticks = sorted(stripes["intensity"].unique())
    axes.xaxis.set_ticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.xaxis.set_ticks([], minor=True)
    axes.set_ylim(-0.03, 1.03)
    axes.grid(alpha=0.25)


def _line(source: str) -> str:
    """Return the line of a source: an engine's is dotted where it is used as it comes."""
    return style_of(source).line or (":" if ":" in source else "-")


def _handle(source: str) -> Line2D:
    style = style_of(source)
    handle = Line2D([], [], color=style.colour, linewidth=style.width, markersize=5, label=source)
    handle.set(linestyle=_line(source), marker=style.marker or ".")
    handle.set_markerfacecolor("none" if style.marker else style.colour)
    return handle
