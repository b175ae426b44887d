"""Lines: the figures of the paper, linearizations over slenderness, strikes over e."""

import io
import math
from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from analytic.response import Outcome, Response
from studies.drawing.facets import error_scale, key, panels, sheet
from studies.drawing.styles import LOWEST, full_name, line_of, style_of, title_of

ONSETS = {"0": ("#D55E00", "lifts at g α"), "1": ("#0072B2", "lifts at g tan α")}
"""What a variant takes as the onset -> its colour, and what that is."""
TOP = 1.25
"""End of the scale of a ratio of speeds."""
EDGE, LINE = 1.2, 0.085
"""Upper end of the scale of abs(theta)/theta_cr, and the height of a line in the band above it."""
FLOOR, CEILING = 1e-8, 1e1
"""Ends of the scale of errors."""


def draw_histories(samples: pd.DataFrame, title: str, *, errors: bool = False) -> Figure:
    """Draw time histories over each other, a panel for each value of `panel` in samples."""
    sources, groups = samples["source"].unique(), list(samples.groupby("panel", sort=False))
    heights = (1.5, 1.0) if errors and "exact" in sources else (1.0,)
    size = (10.0, (3.6 if len(heights) > 1 else 2.9) * len(groups) + 1.3)
    down = len(groups) * len(heights)
    drawing, grid = sheet(size, down, height_ratios=heights * len(groups))
    for place, (_, panel) in enumerate(groups):
        _draw_panel(grid[place * len(heights)], panel)
        if len(heights) > 1:
            _draw_errors(grid[2 * place + 1], panel)
    grid[-1].set_xlabel("time  t  [s]")
    drawing.suptitle(title)
    handles = [
        Line2D([], [], label=full_name(source), **_look(source, style_of(source).width, 6.0))
        for source in sources
    ]
    if samples["amplitude_g"].any():
        handles.append(Line2D([], [], color="#bbbbbb", linewidth=6, label="ground acceleration"))
    key(drawing, handles, math.ceil(len(handles) / math.ceil(len(handles) / 5)), 10.0)
    return drawing


def _look(source: str, width: float, size: float = 4.5) -> dict[str, Any]:
    style = style_of(source)
    line = {"linestyle": line_of(source), "linewidth": width}
    return {**style.points(size), "marker": style.marker, **line}


def _draw_panel(axes: Axes, panel: pd.DataFrame) -> None:
    """Draw the lines of a panel, on the scale of those that survive, over the ground's motion."""
    overturned = panel["outcome"] == "overturned"
    reach = panel.loc[~overturned, "theta_ratio"].abs().max()
    limit = 1.25 if overturned.any() else 1.15 * (reach if reach > 1e-6 else 1e-6)
    motion = panel[panel["time_s"].notna()].drop_duplicates("time_s").sort_values("time_s")
    first, end = panel.iloc[0], float(motion["time_s"].max())
    if first["amplitude_g"]:
        ground = axes.twinx()
        ground.fill_between(motion["time_s"], motion["ground_g"], color="#bbbbbb", alpha=0.45, lw=0)
        most = 1.15 * max(float(motion["ground_g"].abs().max()), 1e-12)
        ground.set(ylim=(-most, most), ylabel="ground  üg/g  [–]")
        axes.set_zorder(ground.get_zorder() + 1)
        axes.patch.set_visible(False)
    level = 0.9
    for source, points in panel.groupby("source", sort=False):
        style, every = style_of(str(source)), max(len(points) // 40, 1)
        look = _look(str(source), style.width if style.line else 0.7)
        axes.plot(points["time_s"], points["theta_ratio"], **look, markevery=every)
        beyond = points["theta_ratio"].abs() > limit
        leaving = points[beyond & (points["outcome"] == "overturned")]
        if len(leaving):  # each is named in a row of its own
            time, ratio = leaving[["time_s", "theta_ratio"]].iloc[0]
            axes.annotate(" overturned", (time, math.copysign(level * limit, ratio)),
                          color=style.colour, fontsize=8, va="center")  # fmt: skip
            level -= 0.11
    axes.axhline(0.0, color="#999999", linewidth=0.6)
    for side, name in ((1.0, "θcr"), (-1.0, "−θcr")) if limit > 1.0 else ():
        axes.axhline(side, color="#999999", linewidth=0.8, linestyle=(0, (5, 4)))
        axes.text(0.995 * end, 0.97 * side, name, ha="right", fontsize=8, color="#666666",
                  va="top" if side > 0.0 else "bottom")  # fmt: skip
    axes.set(xlim=(0.0, end), ylim=(-limit, limit), ylabel="rotation  θ/θcr  [–]")
    label = f"({first['panel']})  " if isinstance(first["panel"], str) and first["panel"] else ""
    shaken = f"{first['amplitude_g']:g} g, {first['pulse']}" if first["amplitude_g"] else "released"
    size = f"B = {first['width_m']:g} m, H = {first['height_m']:g} m"
    axes.set_title(f"{label}{size}, {shaken}", fontsize=10)
    axes.grid(alpha=0.25)


def _draw_errors(axes: Axes, panel: pd.DataFrame) -> None:
    found = panel.pivot_table(index="time_s", columns="source", values="theta_ratio")
    for source in panel.loc[panel["source"] != "exact", "source"].unique():
        off = (found[source] - found["exact"]).abs()
        # the smallest of a stretch would be the zeros between two swings
        worst = off.rolling(max(len(off) // 60, 1), center=True, min_periods=1).max()
        colour = style_of(source).colour
        axes.plot(worst.index, worst.clip(lower=LOWEST), line_of(source), color=colour)
    axes.set(yscale="log", ylabel="distance from\nexact  [θcr]", xlim=(0.0, found.index.max()))
    axes.grid(alpha=0.25)


def draw_responses(responses: Mapping[str, Response]) -> Figure:
    """Draw the histories of named responses over each other; ValueError where one has none."""
    if not responses:
        raise ValueError("responses is empty; it must hold one or more")
    drawing, (axes,) = sheet((8.0, 4.0))
    for name, response in responses.items():
        if (history := response.history) is None:
            words = "ask for one by respond(..., history=True) or simulate(..., times=...)"
            raise ValueError(f"{name} has no history; {words}")
        look = "--" if axes.lines else "-"  # one that lies over another hides nothing
        axes.plot(history.time, history.theta, look, label=f"{name}: {response.outcome.value}")
    slid = any(response.outcome is Outcome.SLID for response in responses.values())
    axes.set(xlabel="time  t  [s]", ylabel="place  x  [m]" if slid else "rotation  θ  [rad]")
    axes.grid(alpha=0.25)
    axes.legend()
    return shown_by_itself(drawing)


def shown_by_itself(drawing: Figure) -> Figure:
    """Return a figure that a notebook shows where it is the value of a cell."""

    def png() -> bytes:
        stream = io.BytesIO()
        drawing.savefig(stream, format="png")
        return stream.getvalue()

    drawing._repr_png_ = png  # type: ignore[attr-defined]
    return drawing


def draw_errors(lines: pd.DataFrame, titles: Mapping[str, str]) -> Figure:
    """Draw a panel for each grid: colour is the onset of a line, dash its frequency."""
    grids = list(lines["grid"].unique())
    drawing, panels = sheet((9.4, 5.2), 1, len(grids), sharey=True)
    for axes, grid in zip(panels, grids, strict=True):
        mine = lines[lines["grid"] == grid]
        for changed, rows in mine.groupby("changed", sort=False):
            words, _, name = titles[str(changed)].partition(", ")[2].rstrip(")").partition(" (")
            colour, dash = ONSETS[str(changed)[0]][0], (0, (4, 2)) if changed[1] == "1" else "-"
            axes.plot(rows["aspect"], rows["median_error"], color=colour, linestyle=dash,
                      marker="o", markersize=3.0, linewidth=1.8 if name else 0.9,
                      label=f"{name}: {words}" if name else words)  # fmt: skip
        axes.set(xscale="log", yscale="log", title=f"{grid} grid", xlabel="slenderness  H/B  [–]")
        ticks = [at for at in (2, 3, 4, 6, 10) if at <= mine["aspect"].max()]
        axes.set_xticks(ticks, list(map(str, ticks)))
        axes.set_xticks([], minor=True)
        axes.grid(alpha=0.25)
    for onset, (colour, words) in ONSETS.items():
        panels[0].text(0.03, 0.1 - 0.05 * int(onset), words, color=colour,
                       transform=panels[0].transAxes)  # fmt: skip
    error_scale(panels[0].yaxis, 1e-4, 10.0, 1)
    key(drawing, panels[-1].get_lines(), 4, 8.0)
    panels[0].set_ylabel("median relative error of the peak  [–]")
    return drawing


def draw_strikes(rows: pd.DataFrame, plain: pd.DataFrame, best: pd.DataFrame) -> Figure:
    """Draw the speed of the corner over the coefficient, in each engine's plainest and best way."""
    drawing, grid = panels(len(best), 4, (2.35, 2.5), 0.9, sharex=True, sharey=True)
    for axes, first, last in zip(grid, plain.itertuples(), best.itertuples(), strict=True):
        mine, look = rows[rows["engine"] == last.engine], style_of(str(last.engine))
        axes.plot([0.0, 1.0], [0.0, 1.0], color="#999999", linewidth=0.8, label="as asked for")
        _way(axes, mine[mine["way"] == last.way], look.colour, "-", "best way")
        usual = mine[(mine["way"] == first.way) & (mine["varied"] == "")]
        _way(axes, usual, "#000000", "--", "plainest way")
        axes.set_title(title_of(str(last.engine)), fontsize=10.5)
        axes.set(xlim=(-0.03, 1.03), ylim=(-0.05, TOP))
        axes.grid(alpha=0.25)
    drawing.supylabel("found: speed of the corner, after over before", fontsize=10)
    drawing.supxlabel("coefficient of restitution that was asked for", fontsize=10)
    grid[0].legend(loc="upper left", frameon=False, fontsize=8.5)
    return drawing


def _way(axes: Axes, rows: pd.DataFrame, colour: str, line: str, label: str) -> None:
    """Draw the usual strikes as a line, and as a band whatever was varied."""
    ratio = rows.assign(ratio=rows["corner_ratio"].clip(upper=TOP)).groupby("wanted")["ratio"]
    usual = rows[rows["varied"] == ""].groupby("wanted")["corner_ratio"].median()
    axes.fill_between(ratio.min().index, ratio.min(), ratio.max(), color=colour, alpha=0.3, lw=0.0)
    axes.plot(usual.index, usual, line, color=colour, linewidth=1.4, label=label)


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
    looks = [Line2D([], [], label=full_name(source), **_look_of(source)) for source in sources]
    key(drawing, looks, 3, 9.0)
    pulse = f"{first['pulse']} pulse, amplitude (B/H + {first['excess_g']:g}) g"
    drawing.suptitle(f"Figure {first['figure']}: {pulse}", fontsize=11)
    return drawing


def _peaks(axes: Axes, panel: pd.DataFrame, sources: Sequence[str]) -> None:
    survived = panel["peak_ratio"].where(panel["outcome"].isin(["rocked", "at rest"]))
    for number, source in enumerate(sources):
        mine, colour = panel["source"] == source, style_of(source).colour
        x, peaks = panel.loc[mine, "omega_over_p"], survived[mine]
        axes.plot(x, peaks, **_look_of(source))
        for at, peak in zip(x[peaks > EDGE], peaks[peaks > EDGE], strict=True):
            axes.plot(at, EDGE - 0.04, marker=6, color=colour, markersize=6, zorder=5)
            axes.annotate(f"  {peak:.2f}", (at, EDGE - 0.06), color=colour, fontsize=7, va="center")
        for outcome, level, mark, size in (
            ("overturned", _level(number), "s", 2.6),
            ("failed", 0.02, "*", 6.0),
        ):
            at = x[panel.loc[mine, "outcome"] == outcome]
            axes.plot(at, [level] * len(at), mark, color=colour, markersize=size)
    axes.axhspan(EDGE, _level(len(sources) - 0.7), color="#eeeeee", zorder=0)
    axes.text(4.05, EDGE - 0.02, "above: overturned", ha="right", va="top", fontsize=8,
              color="#555555")  # fmt: skip
    axes.axhline(1.0, color="#999999", linewidth=0.6, zorder=1)


def _level(number: float) -> float:
    return EDGE + LINE * (number + 0.7)


def _errors(axes: Axes, lines: pd.DataFrame) -> None:
    for name, points in lines.groupby("source", sort=False):
        sizes = points["error"].abs().groupby(points["omega_over_p"]).max().clip(FLOOR, CEILING)
        look = {"linestyle": line_of(str(name)), "linewidth": 0.9}
        axes.plot(sizes.index, sizes, **{**style_of(str(name)).points(3.0), **look})


def _look_of(source: str) -> dict[str, Any]:
    style = style_of(source)
    line = {"color": style.colour, "linestyle": style.line, "linewidth": style.width}
    return line if style.line else {**style.points(4.0), "zorder": 4}
