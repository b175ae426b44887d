"""The pictures of an overturning map: the modes, and where the sources differ from exact."""

from __future__ import annotations

from pathlib import Path
from textwrap import fill

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, Colormap, ListedColormap, LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from scipy.ndimage import distance_transform_edt

from analytic.motion import FloatArray
from studies.cases.window import LEAST_ONSETS, Window
from studies.drawing.facets import key, panels
from studies.drawing.kept import Pictures
from studies.drawing.styles import engine_title, full_name, style_of
from studies.old.tables import table_in
from studies.measures.differences import conditioning_of
from studies.measures.presets import in_words, preset_of
from studies.measures.words import gathered
from studies.measures.wrongness import NO_ANSWER, REST, WORDS
from studies.overturning.report import modes_at, no_impact_line, window_of, with_verdicts

AMPLITUDE = "amplitude of the pulse  $a_p$ / (g tan α)  [–]"
LETTERS = 32
"""In a line of a title, for each panel under it."""
PIXELS = 900
ACROSS = 3
"""Panels in a row."""
KAPPA_SHOWN = 1e2
"""Upper end of the colours of κ: what is beyond needs no telling apart."""
# the palette of Okabe and Ito, lightened where a whole area is filled
MODES = {
    "survives": "#FFFFFF",
    "overturns at once": "#8CC7EE",
    "overturns after 1 impact": "#F5D58A",
    "overturns after 2": "#7FCDB8",
    "overturns after 3 or more": "#CC79A7",
}
CELLS = ("false", "missed", REST, NO_ANSWER)
"""Verdicts on cells that are wrong, in the order of their colours below."""
ROOM = 0.08
"""Distance to its edge, over the size of the picture, of an area that has room for words."""
DIFFERENCE_COLOURS = {
    "both survive": "#FFFFFF",
    "both overturn": "#CCCCCC",
    "false overturning": "#E69F00",
    "missed overturning": "#0072B2",
    WORDS[REST]: "#56B4E9",
    WORDS[NO_ANSWER]: "#000000",
}


def draw_map(areas: pd.DataFrame, window: Window) -> Figure:
    """Draw the exact modes, and the first edge of every model, from the columns of map.csv."""
    drawing = Figure(figsize=(8.6, 6.4), layout="constrained")
    axes = drawing.subplots()
    exact = areas[areas["model"] == "exact"]
    codes = np.clip(picture(exact, window), -1, 3) + 1
    shown = _paint(axes, codes, MODES, window)
    named = _name_the_areas(axes, codes, window)
    handles: list[Line2D | Patch] = [*_patches(MODES, shown - named)]
    for model, part in areas.groupby("model", sort=False):
        least, style = part[part["mode"] >= 0].groupby("x")["low"].min(), style_of(str(model))
        handles += axes.plot(least.index, least, style.line, color=style.colour, lw=style.width,
                             label=f"{model}: least that overturns")  # fmt: skip
    x = window.centres(200)
    handles += axes.plot(x, no_impact_line(x, window, "housner"), color="#D55E00", lw=0.8,
                         label="housner: no impact, closed form")  # fmt: skip
    _frame(axes, window)
    axes.set_title(f"Which pulses overturn a block: {window.title}", fontsize=11)
    key(drawing, handles, 3)
    return drawing


def _name_the_areas(axes: Axes, codes: FloatArray, window: Window) -> set[str]:
    named = set()
    x, y = window.centres(codes.shape[0]), window.amplitudes(codes.shape[1])
    for code, mode in enumerate(MODES):
        # what is beyond the picture is another area
        size = tuple(1.0 / count for count in codes.shape)
        depth = distance_transform_edt(np.pad(codes == code, 1), sampling=size)[1:-1, 1:-1]
        column, row = np.unravel_index(int(depth.argmax()), depth.shape)
        if depth.max() > ROOM:
            axes.text(x[column], y[row], mode.replace(" ", "\n", 1), ha="center", va="center",
                      fontsize=11, color="#333333")  # fmt: skip
            named.add(mode)
    return named


def draw_differences(areas: pd.DataFrame, engines: pd.DataFrame, window: Window) -> Figure:
    """Draw where each source differs from exact, from the columns of map.csv and engines.csv.

    Engines that differ in no cell are named instead of drawn.
    """
    models = [name for name in areas["model"].unique() if name != "exact"]
    cells = with_verdicts(engines, window) if len(engines) else engines
    parts = dict(iter(cells.groupby("source", sort=False))) if len(cells) else {}
    off = {name: int((part["verdict"] != "right").sum()) for name, part in parts.items()}
    drawn = [*models, *(name for name in parts if off[name])]
    # without any that differs, the first shows what all of them say
    drawn += list(parts)[:1] if not any(off.values()) else []
    drawing, grid = panels(len(drawn), ACROSS, (3.0, 2.8), 0.9)
    across = min(len(drawn), ACROSS)
    exact = picture(areas[areas["model"] == "exact"], window)
    for place, (axes, source) in enumerate(zip(grid, drawn, strict=True)):
        if source in models:
            found = picture(areas[areas["model"] == source], window)
            codes = np.where(found >= 0, np.where(exact >= 0, 1, 2), np.where(exact >= 0, 3, 0))
            wrong = f"{np.isin(codes, (2, 3)).mean():.1%}".replace("%", " %")
        else:
            codes = _cell_codes(parts[source])
            wrong = f"{off[source]} of {len(parts[source])} cells"
        _paint(axes, codes, DIFFERENCE_COLOURS, window)
        axes.set_title(f"{full_name(source)}:\n{wrong} wrong", fontsize=10)
        _frame(axes, window, below=place + across >= len(drawn), left=False)
    right = [str(name) for name in parts if not off[name]]
    alike = gathered((engine_title(name), in_words(preset_of(name))) for name in right)
    words = f"; no cell wrong: {alike}" if alike else ""
    drawing.supylabel(AMPLITUDE, fontsize=10)
    title = fill(f"Beside the exact map, {window.title}{words}", LETTERS * across)
    drawing.suptitle(title, fontsize=11)
    seen = set(cells.get("verdict", ()))
    unseen = {WORDS[kind] for kind in (REST, NO_ANSWER) if kind not in seen}
    key(drawing, _patches(DIFFERENCE_COLOURS, set(DIFFERENCE_COLOURS) - unseen))
    return drawing


def draw_conditioning(table: pd.DataFrame, window: Window) -> Figure:
    """Draw by how much a small error grows into one of the exact peak, from conditioning.csv.

    Grey where the block does not survive.
    """
    drawing = Figure(figsize=(8.6, 5.8), layout="constrained")
    axes = drawing.subplots()
    values = table.assign(kappa=conditioning_of(table)).pivot(
        index="x", columns="onsets", values="kappa"
    )
    axes.set_facecolor("#d9d9d9")
    shown = _fill(axes, values.to_numpy(), window, "viridis", LogNorm(1.0, KAPPA_SHOWN))
    drawing.colorbar(shown, ax=axes, extend="max", label="κ of the exact peak  [–]")
    _frame(axes, window)
    title = f"How sensitive a peak is: {window.title}; grey: it overturns or stays at rest"
    axes.set_title(title, fontsize=11)
    return drawing


def picture(areas: pd.DataFrame, window: Window) -> FloatArray:
    """Return the modes of a model on a grid as fine as a picture shows."""
    columns = min(areas["x"].nunique(), PIXELS)
    return modes_at(areas, window.centres(columns), window.amplitudes(PIXELS))


def _cell_codes(cells: pd.DataFrame) -> FloatArray:
    both = np.where(cells["exact_mode"] >= 0, 1, 0)
    codes = np.select([cells["verdict"] == name for name in CELLS], range(2, 2 + len(CELLS)), both)
    marked = cells.assign(code=codes)
    return marked.pivot_table(index="x", columns="onsets", values="code").to_numpy()


def _paint(axes: Axes, codes: FloatArray, colours: dict[str, str], window: Window) -> set[str]:
    norm = BoundaryNorm(np.arange(len(colours) + 1) - 0.5, len(colours))
    _fill(axes, codes, window, ListedColormap(list(colours.values())), norm)
    names = list(colours)
    return {names[int(code)] for code in np.unique(codes)}


def _fill(
    axes: Axes, values: FloatArray, window: Window, colours: Colormap | str, norm: Normalize
) -> AxesImage:
    extent = (window.low, window.high, LEAST_ONSETS, window.onsets)
    return axes.imshow(values.T, origin="lower", aspect="auto", interpolation="nearest",
                       extent=extent, cmap=colours, norm=norm)  # fmt: skip


def _patches(colours: dict[str, str], shown: set[str]) -> list[Patch]:
    return [
        Patch(facecolor=colour, edgecolor="#888888", label=name)
        for name, colour in colours.items()
        if name in shown
    ]


def _frame(axes: Axes, window: Window, *, below: bool = True, left: bool = True) -> None:
    axes.set(xlim=(window.low, window.high), ylim=(LEAST_ONSETS, window.onsets))
    if below:
        axes.set_xlabel(window.label)
        axes.tick_params(labelbottom=True)
    if left:
        axes.set_ylabel(AMPLITUDE)


def pictures(folder: Path) -> Pictures:
    """Draw the figures of a folder from its CSVs alone."""
    areas, engines = table_in(folder, "map"), table_in(folder, "engines")
    window = window_of(folder)
    drawn = {
        "map": draw_map(areas, window),
        "conditioning": draw_conditioning(table_in(folder, "conditioning"), window),
    }
    if areas["model"].nunique() > 1 or len(engines):
        drawn["differences"] = draw_differences(areas, engines, window)
    return drawn
