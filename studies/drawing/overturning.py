"""Overturning maps drawn: modes, where sources are wrong, where peaks are sensitive."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import fill
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap, LogNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patheffects import AbstractPathEffect, withStroke
from scipy.ndimage import distance_transform_edt

from analytic.motion import FloatArray
from studies.cases.window import AXES, LEAST_ONSETS, Window
from studies.drawing.facets import key, panels, sheet
from studies.drawing.styles import full_name, style_of, title_of
from studies.kit.say import listed
from studies.measures.differences import conditioning_of
from studies.measures.presets import in_words, preset_of
from studies.measures.wrongness import NO_ANSWER, REST

AMPLITUDE = "amplitude of the pulse  $a_p$ / (g tan α)  [–]"
ACROSS, PIXELS = 3, 900
"""Panels in a row, and points of a picture."""
# the palette of Okabe and Ito, lightened where a whole area is filled
MODES = {
    "survives": "#FFFFFF",
    "overturns at once": "#8CC7EE",
    "overturns after 1 impact": "#F5D58A",
    "overturns after 2": "#7FCDB8",
    "overturns after 3 or more": "#CC79A7",
}
VERDICTS = {
    "survives": ("#FFFFFF", "survives, as exact"),
    "overturns": ("#CCCCCC", "overturns, as exact"),
    "peak off": ("#F0E442", "survives, peak off by > 10 %"),
    "false": ("#D55E00", "overturns, exact survives"),
    "missed": ("#0072B2", "survives, exact overturns"),
    REST: ("#56B4E9", "missed rocking"),
    NO_ANSWER: ("#000000", "no result"),
    "invalid": ("#999999", "not counted: slides or lifts off"),
}
"""Verdict, or what is right -> its colour and name."""
COLOURS = [colour for colour, _ in VERDICTS.values()]


def draw_map(areas: pd.DataFrame, window: Window) -> Figure:
    """Draw the exact modes, and the first edge of every model, from the columns of map.csv."""
    drawing, (axes,) = sheet((8.6, 6.4))
    codes = np.clip(_picture(areas[areas["model"] == "exact"], window), -1, 3) + 1
    _paint(axes, codes, window, [*MODES.values()])
    named = _name_the_areas(axes, codes, window)
    handles: list[Line2D | Patch] = [
        Patch(facecolor=colour, edgecolor="#888888", label=mode)
        for code, (mode, colour) in enumerate(MODES.items())
        if code not in named and code in codes
    ]
    for model, part in areas.groupby("model", sort=False):
        least, style = part[part["mode"] >= 0].groupby("x")["low"].min(), style_of(str(model))
        handles += axes.plot(least.index, least, style.line, color=style.colour, lw=style.width,
                             label=f"{model}: least that overturns")  # fmt: skip
    _frame(axes, window)
    axes.set_title(f"Which pulses overturn a block: {window.title}", fontsize=11)
    key(drawing, handles, 3)
    return drawing


def _name_the_areas(axes: Axes, codes: FloatArray, window: Window) -> set[int]:
    named = set()
    x, y = window.centres(codes.shape[0]), window.amplitudes(codes.shape[1])
    for code, mode in enumerate(MODES):
        # what is beyond the picture is another area
        size = tuple(1.0 / count for count in codes.shape)
        depth = distance_transform_edt(np.pad(codes == code, 1), sampling=size)[1:-1, 1:-1]
        column, row = np.unravel_index(int(depth.argmax()), depth.shape)
        if depth.max() > 0.08:  # as far from its edge, an area has room for words
            axes.text(x[column], y[row], mode.replace(" ", "\n", 1), ha="center", va="center",
                      fontsize=11, color="#333333")  # fmt: skip
            named.add(code)
    return named


def draw_differences(areas: pd.DataFrame, cells: pd.DataFrame | None, window: Window) -> Figure:
    """Draw where each source differs from exact, from map.csv and engines.csv.

    Engines that differ in no cell are named instead, but for one if all are such.
    """
    models = [name for name in areas["model"].unique() if name != "exact"]
    groups = () if cells is None else cells.groupby("source", sort=False)
    parts = {str(name): part for name, part in groups}
    right = [name for name, part in parts.items() if (part["verdict"] == "right").all()]
    shown = right[: len(right) == len(parts)]
    drawn = [*models, *(name for name in parts if name not in right), *shown]
    drawing, grid = panels(len(drawn), ACROSS, (3.0, 2.8), 0.9)
    exact = _picture(areas[areas["model"] == "exact"], window) >= 0
    names, seen = list(VERDICTS), {"survives", "overturns"}
    for place, (axes, source) in enumerate(zip(grid, drawn, strict=True)):
        if source in models:
            found = _picture(areas[areas["model"] == source], window) >= 0
            side = np.where(found, names.index("false"), names.index("missed"))
            codes = np.where(found == exact, np.where(exact, 1, 0), side)
            wrong = f"{(found != exact).mean():.1%}".replace("%", " %")
        else:
            part = parts[source]
            codes = _coded(part).pivot(index="x", columns="onsets", values="code").to_numpy()
            wrong = f"{(part['verdict'] != 'right').sum()} of {len(part)} cells"
        seen |= {names[code] for code in np.unique(codes)}
        _paint(axes, codes, window, COLOURS)
        axes.set_title(f"{full_name(str(source))}:\n{wrong} wrong", fontsize=10)
        _frame(axes, window, below=place + ACROSS >= len(drawn), left=False)
    alike: dict[str, list[str]] = {}
    for name in right:
        alike.setdefault(preset_of(name), []).append(title_of(name))
    known = "; ".join(f"{listed(titles)} {in_words(name)}" for name, titles in alike.items())
    words = f"; no cell wrong: {known}" if right else ""
    title = fill(f"Beside the exact map, {window.title}{words}", 32 * min(len(drawn), ACROSS))
    drawing.suptitle(title, fontsize=11)
    drawing.supylabel(AMPLITUDE, fontsize=10)
    _key(drawing, seen, 3)
    return drawing


def draw_conditioning(table: pd.DataFrame, forces: pd.DataFrame, window: Window) -> Figure:
    """Draw how a small error grows into one of the exact peak, and what contact that needs.

    From conditioning.csv and validity.csv.
    """
    drawing, (axes,) = sheet((8.6, 5.8))
    axes.set_facecolor("#d9d9d9")
    values = table.assign(kappa=conditioning_of(table)).pivot(
        index="x", columns="onsets", values="kappa"
    )
    shown = axes.imshow(values.to_numpy().T, origin="lower", aspect="auto", cmap="viridis",
                        extent=_extent(window), norm=LogNorm(1.0, 1e2))  # fmt: skip
    drawing.colorbar(shown, ax=axes, extend="max", label="κ of the exact peak  [–]")
    halo: list[AbstractPathEffect] = [withStroke(linewidth=3, foreground="white")]
    for name, levels, colour in (
        ("friction_needed", [0.3, 0.4, 0.5, 0.7, 1.0, 1.5], "#000000"),
        ("min_normal", [0.0], "#D55E00"),
    ):
        wide = forces.pivot(index="onsets", columns="x", values=name)
        level = np.ma.masked_invalid(wide.to_numpy())
        if level.count() and min(wide.shape) > 1:
            lines = axes.contour(wide.columns, wide.index, level, levels, colors=colour)
            lines.set_path_effects(halo)
            for text in axes.clabel(lines, fmt=lambda at: f"μ = {at:g}" if at else "lifts off"):
                text.set_path_effects(halo)
    _frame(axes, window)
    title = (
        f"How sensitive a peak is: {window.title}\n"
        "grey: it overturns; lines: the friction μ that holds it, and where it lifts off"
    )
    axes.set_title(title, fontsize=11)
    return drawing


def draw_plane(rows: pd.DataFrame, width: float) -> Figure:
    """Draw the verdicts on full sines for blocks of one width at H/B 3, a map for each engine."""
    shown = (rows["pulse"] == "full-sine") & (rows["aspect"] == 3.0) & (rows["width_m"] == width)
    rows = _coded(rows[shown & (rows["source"] != "exact")])
    groups = rows.groupby("source", sort=False)
    drawing, grid = panels(len(groups), ACROSS, (2.4, 2.4), 1.3, sharex=True, sharey=True)
    for axes, (source, mine) in zip(grid, groups, strict=True):
        codes = mine.pivot(index="onsets", columns="omega_over_p", values="code")
        axes.pcolormesh(codes.columns, codes.index, codes, shading="nearest", **_scale(COLOURS))
        right = (mine.loc[mine["verdict"] != "invalid", "verdict"] == "right").mean()
        words = f"{title_of(str(source))}: {right:.0%} right".replace("%", " %")
        axes.set_title(words, fontsize=10)
    for axes in grid[::ACROSS]:
        axes.set_ylabel("amplitude  $a_p$ / (g tan α)")
    for axes in grid[-ACROSS:]:
        axes.set_xlabel("frequency  ω/p")
    title = f"Full sines, B = {width:g} m, H = {3.0 * width:g} m;\nevery other one comes after a "
    drawing.suptitle(f"{title}second of rest", fontsize=11)
    _key(drawing, {[*VERDICTS][code] for code in rows["code"]}, 3 if len(groups) >= ACROSS else 2)
    return drawing


def _coded(rows: pd.DataFrame) -> pd.DataFrame:
    """Return rows with the place of each among VERDICTS, as code."""
    over = np.where(rows["outcome"] == "overturned", "overturns", "survives")
    known = rows["verdict"].where(rows["verdict"] != "right", over)
    return rows.assign(code=known.map([*VERDICTS].index))


def _picture(areas: pd.DataFrame, window: Window) -> FloatArray:
    """Return the modes of a model's map on a grid as fine as a picture shows."""
    known = {float(str(at)): group for at, group in areas.groupby("x")}
    x, onsets = np.array(sorted(known)), window.amplitudes(PIXELS)
    found = np.empty((min(len(x), PIXELS), PIXELS))
    for i, at in enumerate(window.centres(len(found))):
        column = known[float(x[np.argmin(abs(x - at))])]
        place = np.searchsorted(column["low"].to_numpy(), onsets, side="right") - 1
        found[i] = column["mode"].to_numpy()[np.maximum(place, 0)]
    return found


def _scale(colours: Sequence[str]) -> dict[str, Any]:
    norm = BoundaryNorm(np.arange(len(colours) + 1) - 0.5, len(colours))
    return {"cmap": ListedColormap(colours), "norm": norm}


def _paint(axes: Axes, codes: FloatArray, window: Window, colours: Sequence[str]) -> None:
    axes.imshow(codes.T, origin="lower", aspect="auto", interpolation="nearest",
                extent=_extent(window), **_scale(colours))  # fmt: skip


def _extent(window: Window) -> tuple[float, float, float, float]:
    return (window.low, window.high, LEAST_ONSETS, window.onsets)


def _key(drawing: Figure, seen: set[str], across: int) -> None:
    shown = [look for name, look in VERDICTS.items() if name in seen]
    patches = [Patch(facecolor=colour, edgecolor="#888888", label=name) for colour, name in shown]
    key(drawing, patches, across)


def _frame(axes: Axes, window: Window, *, below: bool = True, left: bool = True) -> None:
    axes.set(xlim=(window.low, window.high), ylim=(LEAST_ONSETS, window.onsets))
    if below:
        axes.set_xlabel(AXES[window.over][2])
        axes.tick_params(labelbottom=True)
    if left:
        axes.set_ylabel(AMPLITUDE)
