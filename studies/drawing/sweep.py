"""The paper's figures 6 to 9, a row for each H/B."""

from collections.abc import Sequence
from itertools import product
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from studies.drawing.facets import error_scale, key, sheet
from studies.drawing.styles import full_name, line_of, style_of

TOP, LINE = 1.2, 0.085
"""Upper end of the scale of abs(theta)/theta_cr, and the height of a line in the band above it."""
FLOOR, CEILING = 1e-8, 1e1
"""Ends of the scale of errors."""


def draw_sweep(rows: pd.DataFrame) -> Figure:
    """Draw one of figures 6 to 9 as the paper does, H/B down and B across, and below the errors."""
    sources, first = list(rows["source"].unique()), rows.iloc[0]
    drawn = rows.sort_values("omega_over_p", kind="stable")
    aspects, widths = (sorted(rows[name].unique()) for name in ("aspect", "width_m"))
    heights = [1.0] * len(aspects) + [1.1]
    size = (9.4, 1.2 + 2.4 * len(heights))
    drawing, grid = sheet(
        size, len(heights), len(widths), sharex=True, sharey="row", height_ratios=heights
    )
    for axes, (aspect, width_m) in zip(grid, product([*aspects, None], widths), strict=False):
        mine = drawn[drawn["width_m"] == width_m]
        axes.grid(alpha=0.25)
        if aspect is not None:
            _peaks(axes, mine[mine["aspect"] == aspect], sources)
            axes.set_title(f"H/B = {aspect:g}, B = {width_m:g} m", fontsize=10)
        else:
            _errors(axes, mine[mine["source"] != "exact"])
            axes.set_xlabel("frequency of the pulse  ω/p  [–]")
    for axes in grid[:: len(widths)]:
        axes.set(ylim=(0.0, _level(len(sources))), yticks=[0.0, 0.2, 0.4, 0.6, 0.8, 1.0],
                 ylabel="largest |θ|/θcr  [–]", xlim=(0.0, 4.1))  # fmt: skip
    errors = grid[-len(widths)]
    errors.set(
        yscale="log", ylim=(FLOOR, CEILING), ylabel="relative error,\nlargest of all H/B  [–]"
    )
    error_scale(errors.yaxis, FLOOR, CEILING)
    looks = [Line2D([], [], label=full_name(source), **_look(source)) for source in sources]
    key(drawing, looks, 3, 9.0)
    pulse = f"{first['pulse']} pulse, amplitude (B/H + {first['excess_g']:g}) g"
    drawing.suptitle(f"Figure {first['figure']}: {pulse}", fontsize=11)
    return drawing


def _peaks(axes: Axes, panel: pd.DataFrame, sources: Sequence[str]) -> None:
    survived = panel["peak_ratio"].where(panel["outcome"].isin(["rocked", "at rest"]))
    for number, source in enumerate(sources):
        mine, colour = panel["source"] == source, style_of(source).colour
        x, peaks = panel.loc[mine, "omega_over_p"], survived[mine]
        axes.plot(x, peaks, **_look(source))
        for at, peak in zip(x[peaks > TOP], peaks[peaks > TOP], strict=True):
            axes.plot(at, TOP - 0.04, marker=6, color=colour, markersize=6, zorder=5)
            axes.annotate(f"  {peak:.2f}", (at, TOP - 0.06), color=colour, fontsize=7, va="center")
        for outcome, level, mark, size in (
            ("overturned", _level(number), "s", 2.6),
            ("failed", 0.02, "*", 6.0),
        ):
            at = x[panel.loc[mine, "outcome"] == outcome]
            axes.plot(at, [level] * len(at), mark, color=colour, markersize=size)
    axes.axhspan(TOP, _level(len(sources) - 0.7), color="#eeeeee", zorder=0)
    axes.text(4.05, TOP - 0.02, "above: overturned", ha="right", va="top", fontsize=8,
              color="#555555")  # fmt: skip
    axes.axhline(1.0, color="#999999", linewidth=0.6, zorder=1)


def _level(number: float) -> float:
    return TOP + LINE * (number + 0.7)


def _errors(axes: Axes, lines: pd.DataFrame) -> None:
    for name, points in lines.groupby("source", sort=False):
        sizes = points["error"].abs().groupby(points["omega_over_p"]).max().clip(FLOOR, CEILING)
        look = {"linestyle": line_of(str(name)), "linewidth": 0.9}
        axes.plot(sizes.index, sizes, **{**style_of(str(name)).points(3.0), **look})


def _look(source: str) -> dict[str, Any]:
    style = style_of(source)
    line = {"color": style.colour, "linestyle": style.line, "linewidth": style.width}
    return line if style.line else {**style.points(4.0), "zorder": 4}
