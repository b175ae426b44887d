"""The presets of the engines beside each other: all cases at once, and along the frequency."""

from __future__ import annotations

import math
import re
from textwrap import fill

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from engines import ENGINES
from engines.declaration import AT_REST
from studies.drawing.labels import Name, around
from studies.drawing.styles import preset_style, style_of
from studies.measures.presets import engine_of, in_order, in_words, is_engine, preset_of
from studies.measures.words import capital, per_cent
from studies.measures.wrongness import FALL, KINDS, NO_ANSWER, REST, WORDS, wrong_in

LEAST, MOST = 1e-8, 1e1
"""Ends of the scale of errors along the frequency."""
LETTERS = 26
"""In a line beside a panel."""
ROW = 0.045
"""Height of a row of wrong outcomes over that of a panel."""
MARKERS = {FALL: "s", REST: "_", NO_ANSWER: "x"}
"""Kind of a wrong outcome -> its mark in that row."""


def draw_overview(table: pd.DataFrame) -> Figure:
    """Draw error against run time: a bar from the median to the largest error, for each source.

    Parameters
    ----------
    table : DataFrame
        From `studies.sweep.claims.preset_table`.
    """
    table = table[table["preset"] != AT_REST]  # a variant, which the table has
    drawing = Figure(figsize=(8.6, 5.6), layout="constrained")
    axes = drawing.subplots()
    axes.set(xscale="log", yscale="log")
    names = []
    for _, line in table.iterrows():
        style = preset_style(str(line["preset"]))
        ends = [(line["ms"], line["median"]), (line["ms"], line["max"])]
        axes.plot(*zip(*ends, strict=True), color=style.colour, linewidth=1.6, alpha=0.45)
        axes.plot(*ends[1], **style.points(7.0))
        axes.plot(*ends[0], "_", color=style.colour, markersize=8)
        title = ENGINES[str(line["engine"])].title
        counts = " + ".join(f"{line[kind]:.0f}" for kind in KINDS)
        lost = re.sub(r"( \+ 0)+$", "", counts) if any(line[list(KINDS)]) else ""
        words = f"{title} ({lost})" if lost else title
        names.append(Name(words, *ends[1], style.colour))
    axes.margins(x=0.12, y=0.08)
    axes.set_xlabel("run time of a case  [ms]")
    axes.set_ylabel("error of the largest rotation: median (bar) to largest (dot)")
    axes.xaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_major_formatter(_mark)
    axes.set_title(f"{int(table['cases'].max())} cases: errors by engine and by how it is used;\n"
                   f"in brackets how many outcomes are wrong: {' + '.join(WORDS.values())}",
                   fontsize=11)  # fmt: skip
    axes.grid(alpha=0.25)
    around(axes, names, 9.5)
    handles = [
        Line2D([], [], **preset_style(name).points(7.0), label=in_words(name))
        for name in in_order(table["preset"])
    ]
    drawing.legend(handles=handles, loc="outside upper center", ncols=2, frameon=False, fontsize=9)
    return drawing


def _mark(value: float, _: float) -> str:
    """Return a relative error as a mark along an axis: in per cent, as a power of ten below."""
    return per_cent(value) if value >= 1e-4 else f"$10^{{{round(math.log10(value))}}}$"


def draw_by_preset(rows: pd.DataFrame) -> Figure:
    """Draw the errors of one of figures 6 to 9: a row for each preset, a column for each H/B.

    Parameters
    ----------
    rows : DataFrame
        Of one figure, from `studies.measures.differences.with_reference`.
    """
    rows = rows[rows["source"].map(is_engine)]
    rows = rows.assign(preset=rows["source"].map(preset_of))
    aspects, presets = sorted(rows["aspect"].unique()), in_order(rows["preset"])
    engines = list(dict.fromkeys(map(engine_of, rows["source"])))
    drawing = Figure(figsize=(9.0, 2.4 * len(presets) + 1.2), layout="constrained")
    grid = drawing.subplots(len(presets), len(aspects), sharex=True, sharey=True, squeeze=False)
    for line, preset in zip(grid, presets, strict=True):
        for axes, aspect in zip(line, aspects, strict=True):
            mine = rows[(rows["preset"] == preset) & (rows["aspect"] == aspect)]
            _panel(axes, mine, engines)
        line[0].set_ylabel(f"{_broken(in_words(preset))}\nrelative error  [–]", fontsize=8.5)
    for axes, aspect in zip(grid[0], aspects, strict=True):
        axes.set_title(f"H/B = {aspect:g}", fontsize=10)
    for axes in grid[-1]:
        axes.set_xlabel("frequency  ω/p  [–]")
    first, *others = (f"B = {width_m:g} m" for width_m in sorted(rows["width_m"].unique()))
    pale = f" (pale: {', '.join(others)})" if others else ""
    title = f"errors of the peak, {first}{pale}; in the grey band wrong outcomes"
    drawing.suptitle(f"Figure {rows['figure'].iloc[0]}: {title}", fontsize=11)
    handles = [Line2D([], [], **style_of(name).points(5.0), label=name) for name in engines]
    handles += [
        Line2D(
            [], [], color="#555555", linestyle="", marker=mark, markersize=4.0, label=WORDS[kind]
        )
        for kind, mark in MARKERS.items()
    ]
    drawing.legend(handles=handles, loc="outside lower center", ncols=6, frameon=False, fontsize=9)
    return drawing


def _broken(words: str) -> str:
    """Return what a preset is in lines that are no longer than a panel is high."""
    return fill(capital(words), LETTERS)


def _panel(axes: Axes, rows: pd.DataFrame, engines: list[str]) -> None:
    """Draw the errors of some engines, and above them where their outcomes are wrong."""
    top = 1.0 + ROW * (len(engines) + 1)
    reach = (MOST / LEAST) ** top * LEAST
    axes.set(yscale="log", ylim=(LEAST, reach), xlim=(0.0, 4.1))
    axes.axhspan(MOST, reach, color="#eeeeee", zorder=0)
    narrowest = rows["width_m"].min()
    for (source, width_m), points in rows.groupby(["source", "width_m"], sort=False):
        look = {**style_of(str(source)).points(3.0), "linestyle": "-", "linewidth": 0.7}
        pale = width_m != narrowest
        known = points[points["error"].notna()].sort_values("omega_over_p")
        error = known["error"].abs().clip(LEAST, MOST)
        axes.plot(known["omega_over_p"], error, **look, alpha=0.3 if pale else 1.0)
        row = engines.index(engine_of(str(source)))
        level = (MOST / LEAST) ** (1.0 + ROW * (row + 1)) * LEAST
        wrong = wrong_in(points)
        for kind, mark in MARKERS.items():
            x = points.loc[wrong == kind, "omega_over_p"]
            axes.plot(x, [level] * len(x), mark, color=look["color"], markersize=2.6)
    axes.set_yticks([1e-8, 1e-6, 1e-4, 1e-2, 1.0])
    axes.set_yticks([], minor=True)
    axes.grid(alpha=0.25)
