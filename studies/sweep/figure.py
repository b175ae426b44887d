"""One of the paper's figures 6 to 9: peaks, who overturns, and errors; a column for each H/B."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.drawing.facets import error_scale
from studies.drawing.labels import Name, beside
from studies.drawing.styles import Style, line_of, name_of, style_of

OVERTURNED = "overturned"
TOP, ROW = 1.2, 0.085
"""Upper end of the scale of abs(theta)/theta_cr, and the height of a line in the band above it."""
LEAST, MOST = 1e-8, 1e1
"""Ends of the scale of errors."""


def draw_sweep(rows: pd.DataFrame) -> Figure:
    """Draw one of figures 6 to 9: the peaks of the smallest width, and the errors of all widths.

    Parameters
    ----------
    rows : DataFrame
        Of one figure, from `studies.measures.differences.with_reference`.
    """
    first, widths = rows.iloc[0], sorted(rows["width_m"].unique())
    sources = list(rows["source"].unique())
    drawn = rows.sort_values("omega_over_p", kind="stable").assign(
        survived=rows["peak_ratio"].where(rows["outcome"].isin(["rocked", "at rest"])),
        error=rows["error"].abs().clip(LEAST, MOST),
    )
    panels = dict(list(drawn.groupby("aspect")))
    drawing = Figure(figsize=(9.4, 6.6), layout="constrained")
    grid = drawing.subplots(
        2, len(panels), sharex=True, sharey="row", squeeze=False, height_ratios=(1.25, 1.0)
    )
    for upper, lower, (aspect, panel) in zip(*grid, panels.items(), strict=True):
        _peaks(upper, panel[panel["width_m"] == widths[0]], sources)
        _errors(lower, panel, widths[0])
        upper.set_title(f"H/B = {aspect:g}", fontsize=10)
        lower.set_xlabel("frequency of the pulse  ω/p  [–]")
    grid[0, 0].set(ylim=(0.0, _level(len(sources) - 0.7)), yticks=[0.0, 0.2, 0.4, 0.6, 0.8, 1.0],
                   ylabel="largest rotation  |θ|/θcr  [–]", xlim=(0.0, 4.1))  # fmt: skip
    grid[1, 0].set(yscale="log", ylim=(LEAST, MOST), ylabel="relative error of it  [–]")
    error_scale(grid[1, 0].yaxis, LEAST, MOST)
    for axes in grid.flat:
        axes.grid(alpha=0.25)
    _name_the_lines(grid[0, -1], grid[1, -1], panel, sources)
    pulse = f"{first['pulse']} pulse, amplitude (B/H + {first['excess_g']:g}) g"
    narrowest, *others = (f"B = {width_m:g} m" for width_m in widths)
    pale = f"; pale, and the same by similarity: {', '.join(others)}" if others else ""
    drawing.suptitle(f"Figure {first['figure']}: {pulse}; {narrowest}{pale}", fontsize=11)
    return drawing


def _peaks(axes: Axes, panel: pd.DataFrame, sources: Sequence[str]) -> None:
    for number, source in enumerate(sources):
        style = style_of(source)
        points = panel[panel["source"] == source]
        line = {"color": style.colour, "linestyle": style.line, "linewidth": style.width}
        look = line if style.line else {**style.points(4.0), "zorder": 4}
        axes.plot(points["omega_over_p"], points["survived"], **look)
        _beyond_the_scale(axes, points[points["survived"] > TOP], style)
        for outcome, level, mark, size in (
            (OVERTURNED, _level(number), "s", 2.6),
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
    return TOP + ROW * (number + 0.7)


def _beyond_the_scale(axes: Axes, survivors: pd.DataFrame, style: Style) -> None:
    for x, peak in zip(survivors["omega_over_p"], survivors["survived"], strict=True):
        axes.plot(x, TOP - 0.04, marker=6, color=style.colour, markersize=6, zorder=5)
        axes.annotate(f"  {peak:.2f}", (x, TOP - 0.06), color=style.colour, fontsize=7, va="center")


def _errors(axes: Axes, panel: pd.DataFrame, narrowest: float) -> None:
    known = panel[panel["error"].notna() & (panel["source"] != "exact")]
    for (name, width_m), points in known.groupby(["source", "width_m"], sort=False):
        source = str(name)
        look = {**style_of(source).points(3.0), "linestyle": line_of(source), "linewidth": 0.9}
        pale = {"alpha": 0.3, "zorder": 2} if width_m != narrowest else {"zorder": 3}
        axes.plot(points["omega_over_p"], points["error"], **look, **pale)


def _name_the_lines(upper: Axes, lower: Axes, panel: pd.DataFrame, sources: Sequence[str]) -> None:
    colours = {source: style_of(source).colour for source in sources}
    size = 7.5 if len(sources) < 9 else 6.0
    beside(
        upper, [Name(name_of(s), 4.1, _level(i), colours[s]) for i, s in enumerate(sources)], size
    )
    known = panel[panel["error"].notna() & (panel["source"] != "exact")]
    last = known.groupby("source", sort=False)[["omega_over_p", "error"]].last()
    beside(
        lower,
        [Name(name_of(str(s)), x, error, colours[str(s)]) for s, x, error in last.itertuples()],
    )
