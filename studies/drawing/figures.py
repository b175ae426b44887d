"""Time histories over each other, and how a figure is written to a file."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from PIL import Image

from studies.drawing.styles import LOWEST, Style, line_of, name_of, style_of
from studies.kit.tables import draft

OVERTURNED = "overturned"
DPI = 130
"""Points of a picture to the inch."""
COLOURS = 256
"""Of a picture, the nearest to those that it was drawn in."""


def draw_histories(samples: pd.DataFrame, title: str, *, errors: bool = False) -> Figure:
    """Draw time histories over each other, a panel for each value of `panel`.

    Parameters
    ----------
    samples : DataFrame
        Columns panel, pulse, width_m, height_m, amplitude_g, source, outcome, time_s, ground_g,
        theta_ratio.
    title : str
    errors : bool
        Whether to draw under each panel how far its lines are from the exact one.
    """
    panels = list(samples["panel"].unique())
    sources = list(samples["source"].unique())
    heights = (1.5, 1.0) if errors else (1.0,)
    size = (10.0, (3.6 if errors else 2.9) * len(panels) + 1.3)
    drawing = Figure(figsize=size, layout="constrained")
    grid = drawing.subplots(len(panels) * len(heights), height_ratios=heights * len(panels),
                            squeeze=False)[:, 0]  # fmt: skip
    for place, name in enumerate(panels):
        part = samples[samples["panel"] == name]
        _history_panel(grid[place * len(heights)], part)
        if errors:
            _error_panel(grid[2 * place + 1], part)
    grid[-1].set_xlabel("time  t  [s]")
    drawing.suptitle(title)
    _legend_below(drawing, sources, ground=bool(samples["amplitude_g"].any()))
    return drawing


def _history_panel(axes: Axes, panel: pd.DataFrame) -> None:
    limit = _history_limit(panel)
    motion = panel[panel["time_s"].notna()].drop_duplicates("time_s").sort_values("time_s")
    if panel["amplitude_g"].iloc[0]:
        _ground(axes, motion)
    leavers = 0
    for source, points in panel.groupby("source", sort=False):
        _one_history(axes, points, style_of(str(source)))
        leavers += _name_the_leaver(axes, points, style_of(str(source)), limit, leavers)
    axes.axhline(0.0, color="#999999", linewidth=0.6)
    axes.set(ylim=(-limit, limit), ylabel="rotation  θ/θcr  [–]")
    axes.set_xlim(0.0, float(motion["time_s"].max()))
    if limit > 1.0:
        _name_the_bounds(axes)
    axes.set_title(_caption(panel.iloc[0]), fontsize=10)
    axes.grid(alpha=0.25)


def _ground(axes: Axes, motion: pd.DataFrame) -> None:
    ground = axes.twinx()
    ground.fill_between(motion["time_s"], motion["ground_g"], color="#bbbbbb", alpha=0.45, lw=0)
    reach = 1.15 * max(float(motion["ground_g"].abs().max()), 1e-12)
    ground.set(ylim=(-reach, reach), ylabel="ground  üg/g  [–]")
    axes.set_zorder(ground.get_zorder() + 1)
    axes.patch.set_visible(False)


def _name_the_bounds(axes: Axes) -> None:
    end = axes.get_xlim()[1]
    for side, name in ((1.0, "θcr"), (-1.0, "−θcr")):
        axes.axhline(side, color="#999999", linewidth=0.8, linestyle=(0, (5, 4)))
        axes.text(0.995 * end, 0.97 * side, name, ha="right", fontsize=8, color="#666666",
                  va="top" if side > 0.0 else "bottom")  # fmt: skip


def _error_panel(axes: Axes, panel: pd.DataFrame) -> None:
    found = panel.pivot_table(index="time_s", columns="source", values="theta_ratio")
    for source in [name for name in panel["source"].unique() if name != "exact"]:
        style = style_of(source)
        off = (found[source] - found["exact"]).abs()
        # the smallest of a stretch would be the zeros between two swings
        worst = off.rolling(max(len(off) // 60, 1), center=True, min_periods=1).max()
        axes.plot(worst.index, worst.clip(lower=LOWEST), line_of(source), color=style.colour)
    axes.set(yscale="log", ylabel="distance from\nexact  [θcr]", xlim=(0.0, found.index.max()))
    axes.grid(alpha=0.25)


def _caption(row: pd.Series[Any]) -> str:
    label = f"({row['panel']})  " if isinstance(row["panel"], str) and row["panel"] else ""
    size = f"B = {row['width_m']:g} m, H = {row['height_m']:g} m"
    ground = f"{row['amplitude_g']:g} g, {row['pulse']}" if row["amplitude_g"] else "released"
    return f"{label}{size}, {ground}"


def _name_the_leaver(
    axes: Axes, points: pd.DataFrame, style: Style, limit: float, row: int
) -> bool:
    """Write "overturned" where the line leaves the panel, in a row of its own; say if it does."""
    leaving = points[points["theta_ratio"].abs() > limit]
    if not ((points["outcome"] == OVERTURNED).any() and len(leaving)):
        return False
    first = leaving.iloc[0]
    level = (0.9 - 0.11 * row) * limit * (1.0 if first["theta_ratio"] > 0.0 else -1.0)
    place = (first["time_s"], level)
    axes.annotate(f" {OVERTURNED}", place, color=style.colour, fontsize=8, va="center")
    return True


def _one_history(axes: Axes, points: pd.DataFrame, style: Style) -> None:
    axes.plot(
        points["time_s"],
        points["theta_ratio"],
        **{
            **style.points(),
            "marker": style.marker,
            "linestyle": line_of(str(points["source"].iloc[0])),
        },
        linewidth=style.width if style.line else 0.7,
        markevery=max(len(points) // 40, 1),
    )


def _history_limit(panel: pd.DataFrame) -> float:
    """Return the scale: all of the survivors, and the overturning ones on their way out."""
    survivors = panel.loc[panel["outcome"] != OVERTURNED, "theta_ratio"].abs().max()
    overturned = (panel["outcome"] == OVERTURNED).any()
    reach = float(survivors) if survivors > 0.0 else 0.0
    return 1.25 if overturned else 1.15 * max(reach, 1e-6)


def _legend_below(drawing: Figure, sources: Sequence[str], *, ground: bool = False) -> None:
    handles = [_handle(source) for source in sources]
    if ground:
        handles.append(Line2D([], [], color="#bbbbbb", linewidth=6, label="ground acceleration"))
    columns = math.ceil(len(handles) / math.ceil(len(handles) / 5))
    drawing.legend(handles=handles, loc="outside lower center", ncols=columns, frameon=False)


def _handle(source: str) -> Line2D:
    style = style_of(source)
    handle = Line2D([], [], color=style.colour, linewidth=style.width, label=name_of(source))
    handle.set(linestyle=line_of(source), marker=style.marker, fillstyle=style.fill)
    return handle


def lay_out(drawing: Figure) -> None:
    """Give the panels of a figure their places for good.

    As long as a figure has a layout to find, matplotlib draws it twice to write it once.
    """
    if layout := drawing.get_layout_engine():
        layout.execute(drawing)
        drawing.set_layout_engine(None)


def save(drawing: Figure, path: Path) -> None:
    """Write a figure in one piece, in the format of the file's suffix.

    Parameters
    ----------
    drawing : Figure
        Its size is in inches; points are DPI to the inch. Its layout is fixed by this.
    path : Path
        Ends in .png, with COLOURS colours, or in what else matplotlib writes.

    Raises
    ------
    OSError
        That names `path`.
    ValueError
        If there is no such format.
    """
    drawing.set_dpi(DPI)
    lay_out(drawing)
    with draft(path) as part, part.open("wb") as file:
        if path.suffix != ".png":
            drawing.savefig(file, format=path.suffix[1:], dpi=DPI)
            return
        write_points(drawing, file)


def write_points(drawing: Figure, file: BinaryIO) -> None:
    """Write a figure that has its layout as a PNG with COLOURS colours."""
    drawing.set_dpi(DPI)
    canvas = FigureCanvasAgg(drawing)
    canvas.draw()
    # a palette of its own makes a picture a third as large
    whole = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")
    few = whole.quantize(COLOURS, Image.Quantize.MAXCOVERAGE, kmeans=1, dither=Image.Dither.NONE)
    few.save(file, "png", optimize=True, dpi=(DPI, DPI))


def save_all(drawings: Mapping[str, Figure], folder: Path) -> list[Path]:
    """Write the figures of a study under their names into its folder; return the files.

    Parameters
    ----------
    drawings : mapping
        Name of a file without suffix -> figure.
    folder : Path

    Returns
    -------
    list of Path
        In the order of the figures.
    """
    paths = [folder / f"{name}.png" for name in drawings]
    for drawing, path in zip(drawings.values(), paths, strict=True):
        save(drawing, path)
    return paths
