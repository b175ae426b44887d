"""The ensemble drawn: single responses; the fragility of each block, and the capacity by each."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.drawing.labels import Name, beside
from studies.drawing.styles import line_of, name_of, style_of
from studies.measures.presets import in_words, is_engine, preset_of

LEAST, BEYOND = 1e-2, 3.0
"""Ends of the scale of the peaks: less is drawn at its foot, and overturned blocks at its top."""


def draw_singles(rows: pd.DataFrame) -> Figure:
    """Draw each response beside the exact one, a row for each block, a column for each kind.

    Parameters
    ----------
    rows : DataFrame
        ensemble.csv.
    """
    sizes = _sizes(rows)
    kinds: dict[str, list[str]] = {}
    for source in rows["source"].unique():
        if source != "exact":
            kinds.setdefault(_kind(source), []).append(source)
    drawing = Figure(figsize=(3.9 * len(kinds) + 0.8, 3.4 * len(sizes)), layout="constrained")
    grid = drawing.subplots(len(sizes), len(kinds), sharex=True, sharey=True, squeeze=False)
    for place, (line, size) in enumerate(zip(grid, sizes, strict=True)):
        here = _of(rows, size)
        for axes, (kind, sources) in zip(line, kinds.items(), strict=True):
            _singles(axes, here, sources)
            if place == 0:
                axes.set_title(kind, fontsize=11)
                looks = [style_of(source).colour for source in sources]
                for number, (source, colour) in enumerate(zip(sources, looks, strict=True)):
                    axes.text(0.04, 0.93 - 0.06 * number, name_of(source), color=colour, fontsize=8,
                              transform=axes.transAxes)  # fmt: skip
        line[0].set_ylabel(f"{_name(size)}\npeak by the source  |θ|/θcr  [–]")
    for axes in grid[-1]:
        axes.set_xlabel("exact peak  |θ|/θcr  [–]")
    drawing.suptitle("One response at a time: on the line it is the exact one", fontsize=11)
    return drawing


def _kind(source: str) -> str:
    """Return the column that a source is drawn in."""
    if source.startswith("exact "):
        return "the exact solution, nudged"
    return "engines " + in_words(preset_of(source)) if is_engine(source) else "linearizations"


def draw_fragility(stripes: pd.DataFrame, curves: pd.DataFrame, agreement: pd.DataFrame) -> Figure:
    """Draw who overturns at which intensity, and above what a source's capacity is off.

    Parameters
    ----------
    stripes, curves, agreement : DataFrame
        stripes.csv, curves.csv and agreement.csv.
    """
    sizes = _sizes(stripes)
    others = [name for name in stripes["source"].unique() if name != "exact"]
    size_in = (2.6 * len(sizes) + 1.4, 4.4 + 0.25 * len(others))
    drawing = Figure(figsize=size_in, layout="constrained")
    grid = drawing.subplots(
        2, len(sizes), sharey="row", squeeze=False, height_ratios=(3.2, 0.25 * len(others) + 0.3)
    )
    for upper, lower, size in zip(*grid, sizes, strict=True):
        _curves(upper, _of(stripes, size), _of(curves, size))
        _capacities(lower, _of(agreement, size), others)
        lower.set_xlim(*_known(agreement))
        upper.set_title(_name(size), fontsize=10)
    grid[0, 0].set_ylabel("overturned  [–]")
    beside(grid[0, -1], _ends(_of(curves, sizes[-1]), _of(stripes, sizes[-1])), 7.5)
    drawing.suptitle("Fragility; grey: the 95 % interval of the exact curve", fontsize=11)
    return drawing


def _sizes(table: pd.DataFrame) -> list[tuple[float, float]]:
    return list(table[["width_m", "height_m"]].drop_duplicates().itertuples(index=False, name=None))


def _name(size: tuple[float, float]) -> str:
    return f"B = {size[0]:g} m, H = {size[1]:g} m"


def _of(table: pd.DataFrame, size: tuple[float, float]) -> pd.DataFrame:
    return table[(table["width_m"] == size[0]) & (table["height_m"] == size[1])]


def _shown(peaks: pd.Series[float]) -> pd.Series[float]:
    return peaks.replace(math.inf, BEYOND).clip(LEAST, BEYOND)


def _singles(axes: Axes, rows: pd.DataFrame, sources: Sequence[str]) -> None:
    case = ["motion", "intensity"]
    exact = rows[rows["source"] == "exact"].set_index(case)["peak_ratio"]
    axes.plot([LEAST, BEYOND], [LEAST, BEYOND], color="#999999", linewidth=0.8, zorder=1)
    for source in sources:
        found = rows[rows["source"] == source].set_index(case)["peak_ratio"]
        look = style_of(source).points(4.0)
        axes.plot(_shown(exact.reindex(found.index)), _shown(found), **look, markeredgewidth=0.7)
    axes.set(xscale="log", yscale="log")
    for scale in (axes.xaxis, axes.yaxis):
        scale.set_ticks([LEAST, 0.1, 1.0, BEYOND], ["≤ 0.01", "0.1", "1", "over-\nturned"])
        scale.set_ticks([], minor=True)
    axes.grid(alpha=0.25)


def _curves(axes: Axes, stripes: pd.DataFrame, curves: pd.DataFrame) -> None:
    sources = list(stripes["source"].unique())
    for number, source in enumerate(sources):
        style, curve = style_of(source), curves[curves["source"] == source]
        axes.plot(curve["intensity"], curve["probability"], line_of(source), color=style.colour,
                  linewidth=style.width)  # fmt: skip
        if source == "exact":
            axes.fill_between(curve["intensity"], curve["low"], curve["high"], color="#dddddd")
        stripe = stripes[stripes["source"] == source]
        # side by side, or one would hide the other
        nudge = 1.0 + 0.008 * (number - 0.5 * len(sources))
        axes.plot(nudge * stripe["intensity"], stripe["share"], **style.points(4.0))
    axes.set(xscale="log", xlabel="peak acceleration / (g tan α)", ylim=(-0.03, 1.03))
    ticks = sorted(stripes["intensity"].unique())
    axes.xaxis.set_ticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.xaxis.set_ticks([], minor=True)
    axes.grid(alpha=0.25)


def _known(agreement: pd.DataFrame) -> tuple[float, float]:
    """Return between what the ratios of capacities lie that the outcomes tell, and 1."""
    bounds = agreement[["ratio_low", "ratio_high"]].to_numpy(float)
    known = np.append(bounds[np.isfinite(bounds)], 1.0)
    return 0.98 * float(known.min()), 1.02 * float(known.max())


def _ends(curves: pd.DataFrame, stripes: pd.DataFrame) -> list[Name]:
    """Return the names of the curves, where the exact one is at even odds."""
    exact = curves[curves["source"] == "exact"]
    even = exact["intensity"].iloc[int((exact["probability"].fillna(0.0) - 0.5).abs().argmin())]
    names = []
    for source in stripes["source"].unique():
        curve = curves[curves["source"] == source]
        level = float(np.interp(even, curve["intensity"], curve["probability"]))
        names.append(Name(name_of(str(source)), float(even), level, style_of(str(source)).colour))
    return names


def _capacities(axes: Axes, agreement: pd.DataFrame, sources: Sequence[str]) -> None:
    """Draw the ratio of each median capacity to the exact one, with its 95 % interval."""
    lines = agreement.set_index("source")
    for place, source in enumerate(sources):
        style, line = style_of(source), lines.loc[source]
        if not np.isfinite(line["capacity_ratio"]):
            words = "never overturns" if line["capacity_ratio"] == np.inf else "not known"
            axes.text(1.01, place, words, fontsize=8, va="center")
            continue
        axes.plot([line["ratio_low"], line["ratio_high"]], [place, place], color=style.colour)
        axes.plot(line["capacity_ratio"], place, **style.points(6.0))
    axes.axvline(1.0, color="#999999", linewidth=0.8, zorder=0)
    axes.set(ylim=(len(sources) - 0.4, -0.6), xlabel="capacity / exact  [–]")
    axes.set_yticks(range(len(sources)), [*map(name_of, sources)], fontsize=8)
    axes.grid(axis="x", alpha=0.25)
