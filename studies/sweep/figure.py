"""One of the paper's figures 6 to 9: peaks, who overturns, and errors; a column for each H/B."""

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.drawing.labels import Name, beside
from studies.drawing.styles import Style, line_of, style_of

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
    aspects, widths = sorted(rows["aspect"].unique()), sorted(rows["width_m"].unique())
    sources = list(rows["source"].unique())
    drawing = Figure(figsize=(9.4, 6.6), layout="constrained")
    grid = drawing.subplots(
        2, len(aspects), sharex=True, sharey="row", squeeze=False, height_ratios=(1.25, 1.0)
    )
    for upper, lower, aspect in zip(*grid, aspects, strict=True):
        panel = rows[rows["aspect"] == aspect]
        _peaks(upper, panel[panel["width_m"] == widths[0]], sources)
        for width_m in widths:
            _errors(lower, panel[panel["width_m"] == width_m], pale=width_m != widths[0])
        upper.set_title(f"H/B = {aspect:g}", fontsize=10)
        lower.set_xlabel("frequency of the pulse  ω/p  [–]")
    grid[0, 0].set_ylabel("largest rotation  |θ|/θcr  [–]")
    grid[1, 0].set_ylabel("relative error of it  [–]")
    _name_the_lines(grid[0, -1], grid[1, -1], rows[rows["aspect"] == aspects[-1]], sources)
    first = rows.iloc[0]
    pulse = f"{first['pulse']} pulse, amplitude (B/H + {first['excess_g']:g}) g"
    drawing.suptitle(f"Figure {first['figure']}: {pulse}; {_widths(widths)}", fontsize=11)
    return drawing


def _widths(widths: Sequence[float]) -> str:
    """Say which widths are shown."""
    first, *others = (f"B = {width_m:g} m" for width_m in widths)
    pale = f"; pale, and the same by similarity: {', '.join(others)}" if others else ""
    return first + pale


def _peaks(axes: Axes, panel: pd.DataFrame, sources: Sequence[str]) -> None:
    for number, source in enumerate(sources):
        style = style_of(source)
        points = panel[panel["source"] == source].sort_values("omega_over_p")
        x = points["omega_over_p"]
        survived = points["peak_ratio"].where(points["outcome"].isin(["rocked", "at rest"]))
        if style.line:
            axes.plot(x, survived, style.line, color=style.colour, linewidth=style.width)
        else:
            axes.plot(x, survived, **style.points(4.0), zorder=4)
        _beyond_the_scale(axes, x, survived, style)
        lost = x[points["outcome"] == OVERTURNED]
        axes.plot(lost, np.full(len(lost), _level(number)), "s", color=style.colour, markersize=2.6)
        failed = x[points["outcome"] == "failed"]
        axes.plot(failed, np.full(len(failed), 0.02), "*", color=style.colour)
    top = TOP + ROW * len(sources)
    axes.axhspan(TOP, top, color="#eeeeee", zorder=0)
    axes.text(4.05, TOP - 0.02, "above: overturned", ha="right", va="top", fontsize=8,
              color="#555555")  # fmt: skip
    axes.set(xlim=(0.0, 4.1), ylim=(0.0, top), yticks=[0.0, 0.2, 0.4, 0.6, 0.8, 1.0])
    axes.axhline(1.0, color="#999999", linewidth=0.6, zorder=1)
    axes.grid(alpha=0.25)


def _level(number: int) -> float:
    """Return the height of a source's line in the band of overturned cases."""
    return TOP + ROW * (number + 0.7)


def _beyond_the_scale(
    axes: Axes, omega_over_p: "pd.Series[float]", survived: "pd.Series[float]", style: Style
) -> None:
    """Point to survivors above the scale: beyond θcr, and brought back by the ground."""
    for x, peak in zip(omega_over_p[survived > TOP], survived[survived > TOP], strict=True):
        axes.plot(x, TOP - 0.04, marker=6, color=style.colour, markersize=6, zorder=5)
        axes.annotate(f"  {peak:.2f}", (x, TOP - 0.06), color=style.colour, fontsize=7, va="center")


def _errors(axes: Axes, panel: pd.DataFrame, *, pale: bool) -> None:
    for source, points in panel[panel["source"] != "exact"].groupby("source", sort=False):
        style = style_of(str(source))
        known = points[points["error"].notna()].sort_values("omega_over_p")
        axes.plot(
            known["omega_over_p"],
            known["error"].abs().clip(LEAST, MOST),
            **{**style.points(3.0), "linestyle": line_of(str(source)), "linewidth": 0.9},
            alpha=0.3 if pale else 1.0,
            zorder=2 if pale else 3,
        )
    axes.set(yscale="log", ylim=(LEAST, MOST))
    axes.grid(alpha=0.25)


def _name_the_lines(upper: Axes, lower: Axes, panel: pd.DataFrame, sources: Sequence[str]) -> None:
    """Write the sources beside their lines: in the band above, and at the end of their errors."""
    colours = {source: style_of(source).colour for source in sources}
    size = 7.5 if len(sources) < 9 else 6.0
    beside(upper, [Name(s, 4.1, _level(i), colours[s]) for i, s in enumerate(sources)], size)
    known = panel[panel["error"].notna() & (panel["source"] != "exact")]
    last = known.sort_values("omega_over_p").groupby("source", sort=False).last()
    beside(
        lower,
        [
            Name(
                str(source),
                row.omega_over_p,
                min(max(abs(row.error), LEAST), MOST),
                colours[str(source)],
            )
            for source, row in last.iterrows()
        ],
    )
