"""The ensemble drawn: single responses; the fragility of each block, and the capacity by each."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from engines.declaration import UNTUNED
from studies.drawing.facets import NARROWEST
from studies.drawing.kept import Pictures
from studies.drawing.labels import Name, beside
from studies.drawing.styles import line_of, name_of, style_of
from studies.ensemble.agreement import BLOCK
from studies.ensemble.study import read_rows
from studies.measures.presets import in_order, in_words, is_engine, preset_of
from studies.measures.words import part

EXACT = "exact"
"""How its sources begin, of whom those of stronger motions have no name in the registry."""

LEAST, BEYOND = 1e-2, 3.0
"""Ends of the scale of the peaks: less is drawn at its foot, and overturned blocks at its top."""


def draw_singles(rows: pd.DataFrame) -> Figure:
    """Draw each response beside the exact one, a row for each block, a column for each kind.

    Parameters
    ----------
    rows : DataFrame
        ensemble.csv.
    """
    others = rows.loc[rows["source"] != "exact", "source"].drop_duplicates()
    kinds = others.groupby(others.map(_kind), sort=False)
    blocks = rows.groupby(BLOCK, sort=False)
    size = (3.9 * len(kinds) + 0.8, 3.4 * len(blocks))
    drawing = Figure(figsize=size, layout="constrained")
    grid = drawing.subplots(len(blocks), len(kinds), sharex=True, sharey=True, squeeze=False)
    for line, (block, here) in zip(grid, blocks, strict=True):
        for axes, (_, sources) in zip(line, kinds, strict=True):
            _singles(axes, here, sources.to_list())
        line[0].set_ylabel(f"{_name(block)}\npeak by the source  |θ|/θcr  [–]")
    for top, foot, (kind, sources) in zip(grid[0], grid[-1], kinds, strict=True):
        foot.set_xlabel("exact peak  |θ|/θcr  [–]")
        top.set_title(kind, fontsize=11)
        for number, source in enumerate(sources):
            top.text(0.04, 0.93 - 0.06 * number, _called(source), fontsize=8,
                     color=style_of(source).colour, transform=top.transAxes)  # fmt: skip
    drawing.suptitle("One response at a time: on the line it is the exact one", fontsize=11)
    return drawing


def _kind(source: str) -> str:
    """Return the column that a source is drawn in."""
    if source.startswith(EXACT):
        return "the exact solution, nudged"
    return "engines " + in_words(preset_of(source)) if is_engine(source) else "linearizations"


def _is_tuned(source: str) -> bool:
    """Return whether a source is an engine that is not used as its library says."""
    if source.startswith(EXACT):
        return False
    return is_engine(source) and preset_of(source) not in UNTUNED


def _called(source: str) -> str:
    """Return how a source is called; the exact solution of stronger motions by how much."""
    strength = source.removeprefix(EXACT).removeprefix(" at ")
    if strength in ("", source):
        return name_of(source)
    return f"exact, motions {100.0 * (float(strength) - 1.0):+.3g} %"


def _name(block: tuple[Any, ...]) -> str:
    return "B = {:g} m, H = {:g} m".format(*block)


def _singles(axes: Axes, rows: pd.DataFrame, sources: Sequence[str]) -> None:
    peaks = rows.pivot(index=["motion", "intensity"], columns="source", values="peak_ratio")
    shown = peaks.replace(math.inf, BEYOND).clip(LEAST, BEYOND)
    axes.plot([LEAST, BEYOND], [LEAST, BEYOND], color="#999999", linewidth=0.8, zorder=1)
    for source in sources:
        axes.plot(shown["exact"], shown[source], **style_of(source).points(4.0), mew=0.7)
    axes.set(xscale="log", yscale="log")
    for scale in (axes.xaxis, axes.yaxis):
        scale.set_ticks([LEAST, 0.1, 1.0, BEYOND], ["≤ 0.01", "0.1", "1", "over-\nturned"])
        scale.set_ticks([], minor=True)
    axes.grid(alpha=0.25)


def draw_fragility(stripes: pd.DataFrame, curves: pd.DataFrame, agreement: pd.DataFrame) -> Figure:
    """Draw who overturns at which intensity, and below by how much a source's capacity is off.

    Engines that are tuned are drawn below alone: above they would lie on the exact curve.

    Parameters
    ----------
    stripes, curves, agreement : DataFrame
        stripes.csv, curves.csv and agreement.csv.
    """
    each = [table.groupby(BLOCK, sort=False) for table in (stripes, curves, agreement)]
    count, others = len(each[0]), stripes["source"].nunique() - 1
    size = (max(2.6 * count + 1.4, NARROWEST), 4.4 + 0.25 * others)
    drawing = Figure(figsize=size, layout="constrained")
    grid = drawing.subplots(
        2, count, sharey="row", squeeze=False, height_ratios=(3.2, 0.25 * others + 0.3)
    )
    bounds = agreement[["capacity_ratio", "ratio_low", "ratio_high"]].to_numpy(float)
    known = np.append(bounds[np.isfinite(bounds)], 1.0)  # what the outcomes tell, and 1
    for upper, lower, *blocks in zip(*grid, *each, strict=True):
        shares, fitted, capacities = (table for _, table in blocks)
        ends = _curves(upper, shares, fitted)
        _capacities(lower, capacities[capacities["source"] != "exact"])
        lower.set_xlim(0.98 * float(known.min()), 1.02 * float(known.max()))
        upper.set_title(_name(blocks[0][0]), fontsize=10)
    grid[0, 0].set_ylabel("overturned  [–]")
    beside(grid[0, -1], ends, 7.5)
    drawing.suptitle(_finding(agreement), fontsize=11)
    return drawing


def _finding(agreement: pd.DataFrame) -> str:
    """Say by how much capacities are off at most, by preset."""
    engines = agreement[~agreement["source"].str.startswith(EXACT)]
    engines = engines[engines["source"].map(is_engine)]
    off = (engines["capacity_ratio"] - 1.0).abs().groupby(engines["source"].map(preset_of)).max()
    words = [f"{part(off[preset])} {in_words(preset)}" for preset in in_order(off.index)]
    known = f"Engines put the capacity off by up to {', '.join(words)}\n" if words else ""
    return f"{known}grey: the 95 % interval of the exact curve"


def _curves(axes: Axes, stripes: pd.DataFrame, curves: pd.DataFrame) -> list[Name]:
    """Draw shares and curves; return the names of these, where the exact one is at even odds."""
    exact = curves[curves["source"] == "exact"]
    even = exact["intensity"].iloc[int((exact["probability"].fillna(0.0) - 0.5).abs().argmin())]
    axes.fill_between(exact["intensity"], exact["low"], exact["high"], color="#dddddd")
    named = list(stripes["source"].unique())
    untuned = [source for source in named if not _is_tuned(source)]
    names, sources = [], untuned if len(untuned) > 1 else named
    for number, source in enumerate(sources):
        style, curve = style_of(source), curves[curves["source"] == source]
        axes.plot(curve["intensity"], curve["probability"], line_of(source), color=style.colour,
                  linewidth=style.width)  # fmt: skip
        stripe = stripes[stripes["source"] == source]
        # side by side, or one would hide the other
        nudge = 1.0 + 0.008 * (number - 0.5 * len(sources))
        axes.plot(nudge * stripe["intensity"], stripe["share"], **style.points(4.0))
        level = float(np.interp(even, curve["intensity"], curve["probability"]))
        names.append(Name(_called(source), float(even), level, style.colour))
    axes.set(xscale="log", xlabel="peak acceleration / (g tan α)", ylim=(-0.03, 1.03))
    ticks = sorted(stripes["intensity"].unique())
    axes.xaxis.set_ticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.xaxis.set_ticks([], minor=True)
    axes.grid(alpha=0.25)
    return names


def _capacities(axes: Axes, lines: pd.DataFrame) -> None:
    """Draw the ratio of each median capacity to the exact one, with its 95 % interval."""
    for place, line in enumerate(lines.to_dict("records")):
        style, ratio = style_of(line["source"]), line["capacity_ratio"]
        if not math.isfinite(ratio):
            words = "never overturns" if ratio == math.inf else "not known"
            axes.text(1.01, place, words, fontsize=8, va="center")
            continue
        axes.plot([line["ratio_low"], line["ratio_high"]], [place, place], color=style.colour)
        axes.plot(ratio, place, **style.points(6.0))
    axes.axvline(1.0, color="#999999", linewidth=0.8, zorder=0)
    axes.set(ylim=(len(lines) - 0.4, -0.6), xlabel="capacity / exact  [–]")
    axes.set_yticks(range(len(lines)), [*map(_called, lines["source"])], fontsize=8)
    axes.grid(axis="x", alpha=0.25)


def pictures(folder: Path) -> Pictures:
    """Draw a folder's figures from its tables alone; single responses where it holds them."""
    tables = (pd.read_csv(folder / f"{name}.csv") for name in ("stripes", "curves", "agreement"))
    drawn = {"ensemble": draw_fragility(*tables)}
    if (folder / "ensemble.csv").is_file():
        drawn["singles"] = draw_singles(read_rows(folder))
    return drawn
