"""The paper's figures 6 to 9, a column for each H/B; and errors and run times of all presets."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from engines.declaration import AT_REST
from studies.drawing.facets import error_scale, key, preset_dots, rows, sheet
from studies.drawing.styles import line_of, name_of, style_of, title_of
from studies.kit.say import part
from studies.measures.presets import in_order, look_of
from studies.measures.wrongness import KINDS

TOP, LINE = 1.2, 0.085
"""Upper end of the scale of abs(theta)/theta_cr, and the height of a line in the band above it."""
FLOOR, CEILING = 1e-8, 1e1
"""Ends of the scale of errors."""


def draw_sweep(rows: pd.DataFrame) -> Figure:
    """Draw one of figures 6 to 9: the peaks of the smallest width, and the errors of all widths."""
    first, widths = rows.iloc[0], sorted(rows["width_m"].unique())
    sources = list(rows["source"].unique())
    drawn = rows.sort_values("omega_over_p", kind="stable").assign(
        survived=rows["peak_ratio"].where(rows["outcome"].isin(["rocked", "at rest"])),
        error=rows["error"].abs().clip(FLOOR, CEILING),
    )
    panels = dict(list(drawn.groupby("aspect")))
    drawing = Figure(figsize=(9.4, 6.6), layout="constrained")
    grid = drawing.subplots(
        2, len(panels), sharex=True, sharey="row", squeeze=False, height_ratios=(1.25, 1.0)
    )
    for upper, lower, (aspect, panel) in zip(*grid, panels.items(), strict=True):
        _peaks(upper, panel[panel["width_m"] == widths[0]], sources)
        known = panel[panel["error"].notna() & (panel["source"] != "exact")]
        _errors(lower, known, widths[0])
        upper.set_title(f"H/B = {aspect:g}", fontsize=10)
        lower.set_xlabel("frequency of the pulse  ω/p  [–]")
    grid[0, 0].set(ylim=(0.0, _level(len(sources) - 0.7)), yticks=[0.0, 0.2, 0.4, 0.6, 0.8, 1.0],
                   ylabel="largest rotation  |θ|/θcr  [–]", xlim=(0.0, 4.1))  # fmt: skip
    grid[1, 0].set(yscale="log", ylim=(FLOOR, CEILING), ylabel="relative error of it  [–]")
    error_scale(grid[1, 0].yaxis, FLOOR, CEILING)
    for axes in grid.flat:
        axes.grid(alpha=0.25)
    looks = [Line2D([], [], label=name_of(source), **_look(source)) for source in sources]
    key(drawing, looks, 6, 8.0)
    pulse = f"{first['pulse']} pulse, amplitude (B/H + {first['excess_g']:g}) g"
    narrowest, *others = (f"B = {width_m:g} m" for width_m in widths)
    pale = f"; pale, and the same by similarity: {', '.join(others)}" if others else ""
    drawing.suptitle(f"Figure {first['figure']}: {pulse}; {narrowest}{pale}", fontsize=11)
    return drawing


def _peaks(axes: Axes, panel: pd.DataFrame, sources: Sequence[str]) -> None:
    for number, source in enumerate(sources):
        style = style_of(source)
        points = panel[panel["source"] == source]
        axes.plot(points["omega_over_p"], points["survived"], **_look(source))
        beyond = points.loc[points["survived"] > TOP, ["omega_over_p", "survived"]]
        for x, peak in beyond.itertuples(index=False):
            axes.plot(x, TOP - 0.04, marker=6, color=style.colour, markersize=6, zorder=5)
            axes.annotate(f"  {peak:.2f}", (x, TOP - 0.06), color=style.colour, fontsize=7,
                          va="center")  # fmt: skip
        for outcome, level, mark, size in (
            ("overturned", _level(number), "s", 2.6),
            ("failed", 0.02, "*", 6.0),
        ):
            x = points.loc[points["outcome"] == outcome, "omega_over_p"]
            if len(x):
                axes.plot(x, [level] * len(x), mark, color=style.colour, markersize=size)
    axes.axhspan(TOP, _level(len(sources) - 0.7), color="#eeeeee", zorder=0)
    axes.text(4.05, TOP - 0.02, "above: overturned", ha="right", va="top", fontsize=8,
              color="#555555")  # fmt: skip
    axes.axhline(1.0, color="#999999", linewidth=0.6, zorder=1)


def _level(number: float) -> float:
    return TOP + LINE * (number + 0.7)


def _errors(axes: Axes, known: pd.DataFrame, narrowest: float) -> None:
    for (name, width_m), points in known.groupby(["source", "width_m"], sort=False):
        source = str(name)
        look = {**style_of(source).points(3.0), "linestyle": line_of(source), "linewidth": 0.9}
        pale = {"alpha": 0.3, "zorder": 2} if width_m != narrowest else {"zorder": 3}
        axes.plot(points["omega_over_p"], points["error"], **look, **pale)


def _look(source: str) -> dict[str, Any]:
    style = style_of(source)
    line = {"color": style.colour, "linestyle": style.line, "linewidth": style.width}
    return line if style.line else {**style.points(4.0), "zorder": 4}


def draw_overview(table: pd.DataFrame) -> Figure:
    """Draw errors and run times of a table of presets: engines as rows, presets as dots."""
    table = table[table["preset"] != AT_REST]  # a variant, which the table has
    engines, presets = list(dict.fromkeys(table["engine"])), in_order(table["preset"])
    size = (8.6, 1.9 + 0.125 * len(presets) * len(engines))
    drawing, (errors, times) = sheet(size, 1, 2, sharey=True, width_ratios=(1.7, 1.0))
    for line in table.to_dict("records"):
        place = presets.index(str(line["preset"])) - 0.5 * (len(presets) - 1)
        y = engines.index(str(line["engine"])) + 0.76 * place / len(presets)
        colour = look_of(str(line["preset"])).colour
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
    words = [f"by up to {most[name]} {look_of(name).words}" for name in (presets[0], presets[-1])]
    head = f"In {table['cases'].max():.0f} cases peaks are off {words[0]},\n{words[1]}"
    drawing.suptitle(head, fontsize=12)
    key(drawing, preset_dots(presets), 5, fontsize=10, handletextpad=0.2, columnspacing=1.2)
    return drawing
