"""Colours, markers and panels; every figure is drawn from the columns of its CSV alone."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from engines import ENGINES
from studies.kit.drafts import draft

LOWEST = 1e-16
"""Errors below are drawn here, on the floor of double precision."""
OVERTURNED = "overturned"
TOP = 1.2
"""Upper end of the scale of abs(theta)/theta_cr; overturned cases stand in a band above it."""


@dataclass(frozen=True, slots=True)
class Style:
    """How a source is drawn: colour, its line (models and solvers) or its marker (engines)."""

    colour: str
    line: str = ""
    marker: str = ""
    width: float = 1.4


# the palette of Okabe and Ito, which colour-blind readers tell apart
STYLES = {
    "exact": Style("#000000", "-", width=2.2),
    "housner": Style("#D55E00", "--"),
    "modified": Style("#0072B2", "-."),
    "onset-matched": Style("#CC79A7", ":", width=1.8),
    "rk4": Style("#56B4E9", "-", width=1.0),
    "average-acceleration": Style("#E69F00", "--", width=1.0),
}

# from Tol's muted palette, but for the first two
ENGINE_COLOURS = (
    *("#009E73", "#7A4FBF", "#882255", "#999933", "#332288", "#44AA99", "#AA4499", "#661100"),
)
MARKERS = {"": "o^", "fixed": "sv", "naive": "x+"}
"""Preset -> markers of engines, in turn; the empty name is the best there is."""


def engine_style(engine: str, preset: str) -> Style:
    """Return colour and marker of an engine, by its place among all."""
    number = list(ENGINES).index(engine)
    markers = MARKERS.get(preset, MARKERS[""])
    colour = ENGINE_COLOURS[number % len(ENGINE_COLOURS)]
    return Style(colour, marker=markers[number % len(markers)])


def style_of(source: str) -> Style:
    """Return the style of a source; one without a style of its own is grey."""
    plain, _, preset = source.partition(":")
    if plain in ENGINES:
        return engine_style(plain, preset)
    return STYLES.get(plain) or Style("#777777", marker="D")


def draw_sweep(rows: pd.DataFrame, figure: int) -> Figure:
    """Draw one of figures 6 to 9 in the paper's arrangement.

    Parameters
    ----------
    rows : DataFrame
        The columns of sweep.csv.
    figure : int
    """
    rows = rows[rows["figure"] == figure]
    aspects, widths = sorted(rows["aspect"].unique()), sorted(rows["width_m"].unique())
    sources = list(rows["source"].unique())
    drawing = Figure(figsize=(10.0, 3.1 * len(aspects) + 1.2))
    # told where the panels go, it draws in half the time that finding out takes
    grid = drawing.subplots(
        len(aspects),
        len(widths),
        sharex=True,
        sharey=True,
        squeeze=False,
        gridspec_kw=_margins(drawing, len(aspects), _legend_rows(len(sources))),
    )
    for i, aspect in enumerate(aspects):
        for j, width_m in enumerate(widths):
            panel = rows[(rows["aspect"] == aspect) & (rows["width_m"] == width_m)]
            _sweep_panel(grid[i, j], panel, sources)
            grid[i, j].set_title(f"H/B = {aspect:g},  B = {width_m:g} m", fontsize=10)
    for axes in grid[-1]:
        axes.set_xlabel("frequency of the pulse  ω/p  [–]")
    for axes in grid[:, 0]:
        axes.set_ylabel("largest rotation  |θ|/θcr  [–]")
    first = rows.iloc[0]
    drawing.suptitle(
        f"Figure {figure}: {first['pulse']} pulse, amplitude (B/H + {first['excess_g']:g}) g",
        y=1.0 - 0.1 / drawing.get_size_inches()[1],
    )
    _legend_below(drawing, sources)
    return drawing


def _margins(drawing: Figure, panel_rows: int, legend_rows: int) -> dict[str, float]:
    """Return the room around panels that share their axes, below titles and above a legend."""
    width, height = map(float, drawing.get_size_inches())
    below, above, between = 0.6 + 0.2 * legend_rows, 0.62, 0.35
    panel = (height - below - above - between * (panel_rows - 1)) / panel_rows
    return {
        "left": 0.56 / width,
        "right": 1.0 - 0.06 / width,
        "bottom": below / height,
        "top": 1.0 - above / height,
        "hspace": between / panel,
        "wspace": 0.045,
    }


def _sweep_panel(axes: Axes, panel: pd.DataFrame, sources: Sequence[str]) -> None:
    row_height = 0.075
    for number, source in enumerate(sources):
        style = style_of(source)
        points = panel[panel["source"] == source].sort_values("omega_over_p")
        survived = points["peak_ratio"].where(points["outcome"].isin(["rocked", "at rest"]))
        axes.plot(
            points["omega_over_p"],
            survived,
            color=style.colour,
            linestyle=style.line or "none",
            linewidth=style.width,
            marker=style.marker or ".",
            markersize=4.5 if style.marker else 2.5,
            markerfacecolor="none" if style.marker else style.colour,
            zorder=4 if style.marker else 3,
        )
        _beyond_the_scale(axes, points["omega_over_p"], survived, style)
        level = TOP + row_height * (len(sources) - number - 0.5)
        _mark(axes, points, OVERTURNED, level, "s", color=style.colour, markersize=2.6)
        _mark(axes, points, "failed", 0.02, "*", color=style.colour)
    top = TOP + row_height * len(sources)
    axes.axhspan(TOP, top, color="#eeeeee", zorder=0)
    axes.text(4.05, TOP + 0.015, OVERTURNED, ha="right", fontsize=8, color="#555555")
    axes.set(xlim=(0.0, 4.1), ylim=(0.0, top), yticks=[0.0, 0.2, 0.4, 0.6, 0.8, 1.0])
    axes.axhline(1.0, color="#999999", linewidth=0.6, zorder=1)
    axes.grid(alpha=0.25)


def _mark(
    axes: Axes, points: pd.DataFrame, outcome: str, level: float, marker: str, **look: Any
) -> None:
    """Mark the cases with an outcome, all at the same height."""
    marked = points.loc[points["outcome"] == outcome, "omega_over_p"]
    if len(marked):
        axes.plot(marked, [level] * len(marked), marker, **look)


def _beyond_the_scale(
    axes: Axes, omega_over_p: "pd.Series[float]", survived: "pd.Series[float]", style: Style
) -> None:
    """Point to survivors above the scale: beyond θcr, and brought back by the ground."""
    for x, peak in zip(omega_over_p[survived > TOP], survived[survived > TOP], strict=True):
        axes.plot(x, TOP - 0.04, marker=6, color=style.colour, markersize=6, zorder=5)
        axes.annotate(f"  {peak:.2f}", (x, TOP - 0.06), color=style.colour, fontsize=7, va="center")


def draw_histories(samples: pd.DataFrame, title: str) -> Figure:
    """Draw time histories, one column of panels for each value of `panel`.

    Parameters
    ----------
    samples : DataFrame
        Columns panel, pulse, width_m, height_m, amplitude_g, source, outcome, time_s, ground_g,
        theta_ratio.
    title : str
    """
    panels = list(samples["panel"].unique())
    sources = list(samples["source"].unique())
    drawing = Figure(figsize=(10.0, 2.9 * len(panels) + 1.3), layout="constrained")
    grid = drawing.subplots(len(panels), 1, squeeze=False)[:, 0]
    for axes, name in zip(grid, panels, strict=True):
        _history_panel(axes, samples[samples["panel"] == name])
    grid[-1].set_xlabel("time  t  [s]")
    drawing.suptitle(title)
    _legend_below(drawing, sources, ground=True)
    return drawing


def _history_panel(axes: Axes, panel: pd.DataFrame) -> None:
    limit = _history_limit(panel)
    ground = axes.twinx()
    motion = panel[panel["time_s"].notna()].drop_duplicates("time_s").sort_values("time_s")
    ground.fill_between(motion["time_s"], motion["ground_g"], color="#bbbbbb", alpha=0.45, lw=0)
    reach = 1.15 * max(float(motion["ground_g"].abs().max()), 1e-12)
    ground.set(ylim=(-reach, reach), ylabel="ground  üg/g  [–]")
    axes.set_zorder(ground.get_zorder() + 1)
    axes.patch.set_visible(False)
    leavers = 0
    for source, points in panel.groupby("source", sort=False):
        _one_history(axes, points, style_of(str(source)))
        leavers += _name_the_leaver(axes, points, style_of(str(source)), limit, leavers)
    axes.axhline(0.0, color="#999999", linewidth=0.6)
    axes.set(ylim=(-limit, limit), ylabel="rotation  θ/θcr  [–]")
    axes.set_xlim(0.0, float(motion["time_s"].max()))
    axes.set_title(_caption(panel.iloc[0]), fontsize=10)
    axes.grid(alpha=0.25)


def _caption(row: "pd.Series[Any]") -> str:
    label = f"({row['panel']})  " if isinstance(row["panel"], str) and row["panel"] else ""
    size = f"B = {row['width_m']:g} m, H = {row['height_m']:g} m"
    return f"{label}{size}, {row['amplitude_g']:g} g, {row['pulse']}"


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
        color=style.colour,
        linestyle=style.line or "-",
        linewidth=style.width if style.line else 0.7,
        marker=style.marker or None,
        markevery=max(len(points) // 40, 1),
        markersize=4.5,
        markerfacecolor="none",
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
    columns = math.ceil(len(handles) / _legend_rows(len(handles)))
    drawing.legend(handles=handles, loc="outside lower center", ncols=columns, frameon=False)


def _legend_rows(entries: int) -> int:
    return math.ceil(entries / 5)


def _handle(source: str) -> Line2D:
    style = style_of(source)
    handle = Line2D([], [], color=style.colour, linewidth=style.width, label=source)
    handle.set(linestyle=style.line or "none", marker=style.marker, markerfacecolor="none")
    return handle


def save(drawing: Figure, path: Path) -> None:
    """Write a figure in one piece, in the format of the file's suffix."""
    with draft(path) as file:
        drawing.savefig(file, format=path.suffix[1:], dpi=130)


def save_all(drawings: Mapping[str, Figure], folder: Path, suffix: str = ".png") -> list[Path]:
    """Write the figures of a study under their names into its folder; return the files."""
    paths = [folder / f"{name}{suffix}" for name in drawings]
    for drawing, path in zip(drawings.values(), paths, strict=True):
        save(drawing, path)
    return paths
