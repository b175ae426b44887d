"""The presets of the engines beside each other: all cases at once, and along the frequency."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from engines.declaration import AT_REST
from studies.drawing.facets import STRIP, cells, dot, error_scale, key, preset_dots, rows
from studies.drawing.styles import title_of
from studies.measures.presets import engine_of, in_order, is_engine, preset_of, told
from studies.measures.words import out_of, part
from studies.measures.wrongness import FALL, KINDS, NO_ANSWER, REST, WORDS, wrong_in

LEAST, MOST = 1e-6, 1.0
"""Ends of the colours of errors along the frequency."""
MARKERS = {FALL: "s", REST: "_", NO_ANSWER: "x"}
"""Kind of a wrong outcome -> its mark in a strip."""
ROW = 0.125
"""Height of a preset in a row of an engine [in]."""
APART = 0.76
"""Part of a row over which its presets are spread."""


def draw_overview(table: pd.DataFrame) -> Figure:
    """Draw error and run time beside each other: engines as rows, presets as dots.

    Parameters
    ----------
    table : DataFrame
        From `studies.sweep.study.preset_table`.
    """
    table = table[table["preset"] != AT_REST]  # a variant, which the table has
    engines, presets = list(dict.fromkeys(table["engine"])), in_order(table["preset"])
    size = (8.6, 1.9 + ROW * len(presets) * len(engines))
    drawing = Figure(figsize=size, layout="constrained")
    errors, times = drawing.subplots(1, 2, sharey=True, width_ratios=(1.7, 1.0))
    for line in table.to_dict("records"):
        place = presets.index(str(line["preset"])) - 0.5 * (len(presets) - 1)
        y = engines.index(str(line["engine"])) + APART * place / len(presets)
        colour = told(str(line["preset"])).colour
        errors.plot([line["median"], line["max"]], [y, y], color=colour, lw=2.4, alpha=0.45)
        errors.plot(line["median"], y, "|", color=colour, markersize=7)
        errors.plot(line["max"], y, "o", color=colour, markersize=5.5)
        times.plot(line["ms"], y, "o", color=colour, markersize=5.5)
        if lost := sum(line[kind] for kind in KINDS):
            errors.annotate(f"{lost:.0f} wrong", (line["max"], y), (6, 0), color=colour,
                            textcoords="offset points", fontsize=8.5, va="center")  # fmt: skip
    rows(errors, [title_of(name) for name in engines], 11.0)
    for axes in (errors, times):
        axes.set(xscale="log")
        axes.tick_params(axis="x", labelsize=10)
        for place in range(1, len(engines)):
            axes.axhline(place - 0.5, color="#cccccc", linewidth=0.8)
        axes.grid(axis="y", visible=False)
        axes.tick_params(axis="y", length=0)
        axes.spines[["top", "right", "left"]].set_visible(False)
    low, high = errors.get_xlim()
    errors.set_xlim(low, 8.0 * high)  # for the words
    error_scale(errors.xaxis, low, max(high, 1.0))
    errors.set_xlabel("error of the largest rotation:\nmedian (bar) to largest (dot)", fontsize=10)
    times.xaxis.set_major_formatter("{x:g}")
    times.set_xlabel("run time of a case  [ms]", fontsize=10)
    times.grid(axis="x", alpha=0.25)
    most = {name: part(table.loc[table["preset"] == name, "max"].max()) for name in presets}
    said = ",\n".join(
        f"by up to {most[name]} {told(name).words}" for name in (presets[0], presets[-1])
    )
    cases = int(table["cases"].max())
    drawing.suptitle(f"In {cases} cases peaks are off {said}", fontsize=12)
    key(drawing, preset_dots(presets), 5, fontsize=10, handletextpad=0.2, columnspacing=1.2)
    return drawing


def draw_by_preset(rows: pd.DataFrame) -> Figure:
    """Draw the errors of one of figures 6 to 9 along the frequency as colours.

    A strip for each engine and preset, a column for each H/B; of widths that similarity makes alike
    a cell holds the largest error, and every mark.

    Parameters
    ----------
    rows : DataFrame
        Of one figure, from `studies.measures.differences.with_reference`.
    """
    rows = rows[rows["source"].map(is_engine)]
    rows = rows.assign(preset=rows["source"].map(preset_of), wrong=wrong_in(rows))
    aspects, presets = sorted(rows["aspect"].unique()), in_order(rows["preset"])
    groups = {preset: rows[rows["preset"] == preset] for preset in presets}
    counts = [group["source"].nunique() for group in groups.values()]
    size = (9.4, 1.7 + 0.2 * sum(counts) + 0.28 * len(counts))
    drawing = Figure(figsize=size, layout="constrained")
    grid = drawing.subplots(
        len(presets), len(aspects), squeeze=False, sharex="col", height_ratios=counts
    )
    for line, (preset, group) in zip(grid, groups.items(), strict=True):
        sources = list(group["source"].unique())
        for axes, aspect in zip(line, aspects, strict=True):
            shown = _strips(axes, group[group["aspect"] == aspect], sources)
            axes.set_yticks([])
        names = [title_of(engine_of(source)) for source in sources]
        line[0].set_yticks(range(len(names)), names, fontsize=8.5)
        wrong = out_of((group["wrong"] != "").sum(), len(group))
        line[0].set_title(f"{told(preset).short}: {wrong} outcomes wrong", loc="left",
                          color=told(preset).colour, fontsize=9.5, fontweight="bold")  # fmt: skip
    for axes, aspect in zip(grid[-1], aspects, strict=True):
        axes.set_xlabel(f"ω/p at H/B = {aspect:g}", fontsize=10)
    bar = drawing.colorbar(shown, ax=grid, extend="both", aspect=40, pad=0.015)
    error_scale(bar.ax.yaxis, LEAST, MOST, 1)
    bar.ax.set_title("error", fontsize=9)
    median = {name: part(groups[name]["error"].abs().median()) for name in presets}
    words = [f"{median[name]} {told(name).words}" for name in (presets[0], presets[-1])]
    number = rows["figure"].iloc[0]
    drawing.suptitle(
        f"Figure {number}: half of the engines' errors are below\n{', '.join(words)}", fontsize=12
    )
    key(drawing, [dot(WORDS[kind], look, "#d00000", markersize=5) for kind, look in MARKERS.items()]
        + [dot("both overturn, as they should", "s", STRIP, markersize=8)])  # fmt: skip
    return drawing


def _strips(axes: Axes, mine: pd.DataFrame, sources: list[str]) -> Any:
    size = mine["error"].abs()
    table = mine.assign(size=size).pivot_table(
        index="source", columns="omega_over_p", values="size", aggfunc="max", dropna=False
    )
    frequencies = sorted(mine["omega_over_p"].unique())
    axes.set_facecolor(STRIP)
    shown = cells(axes, table.reindex(index=sources, columns=frequencies), LEAST, MOST)
    for kind, look in MARKERS.items():
        wrong = mine[mine["wrong"] == kind]
        x = np.searchsorted(frequencies, wrong["omega_over_p"])
        y = [sources.index(source) for source in wrong["source"]]
        axes.plot(x, y, look, color="#d00000", markersize=2.8)
    ticks = [k for k, value in enumerate(frequencies) if abs(value - round(value)) < 1e-9]
    axes.set_xticks(ticks, [f"{frequencies[k]:g}" for k in ticks], fontsize=9)
    axes.set_yticks(np.arange(0.5, len(sources) - 1), minor=True)
    axes.grid(axis="y", which="minor", color="white", linewidth=1.2)
    axes.tick_params(which="minor", length=0)
    return shown
