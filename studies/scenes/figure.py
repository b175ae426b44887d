"""Errors of frames and slides, and what a floor carries: engines as rows, bars and dots."""

from __future__ import annotations

import pandas as pd
from matplotlib.figure import Figure

from studies.drawing.facets import key, preset_dots
from studies.drawing.labels import Name, around
from studies.drawing.styles import title_of
from studies.measures.presets import engine_of, in_order, preset_of, told

LOWEST = 1e-7
"""Smaller errors are drawn here."""


FLOORS = (
    ("carried", "moved at once", "o", "#0072B2"),
    ("carried_after_rest", "after 1 s of rest", "s", "#D55E00"),
)
"""Column -> how it is drawn."""

ROOM = 30.0
"""By how much the axis is longer where words stand beside a bar."""


def draw_frames(lines: pd.DataFrame) -> Figure:
    """Draw for each engine and preset a bar from the median to the largest error of the peak.

    Parameters
    ----------
    lines : DataFrame
        The columns of frame-summary.csv.
    """
    bars = lines.assign(
        low=lines["median_error"],
        high=lines["largest_error"],
        said=lines["wrong"].astype(str) + " of " + lines["frames"].astype(str) + " fall wrongly",
    )
    return _draw(
        bars.assign(said=bars["said"].where(bars["wrong"] > 0, "")),
        "A rocking frame: how far off its peak is, median to largest",
        "error of the largest rotation of a column, relative  [–]",
    )


def draw_slides(lines: pd.DataFrame) -> Figure:
    """Draw for each engine and preset the largest error of a slip.

    Parameters
    ----------
    lines : DataFrame
        The columns of slide-summary.csv.
    """
    off = 1e3 * lines["largest_slip_error_m"]
    return _draw(
        lines.assign(low=off, high=off, said=""),
        "A sliding block: the largest error of a slip",
        "largest error of a slip  [mm]",
    )


def draw_floors(lines: pd.DataFrame) -> Figure:
    """Draw how far a floor carries a block: a row for each engine and way of moving the floor.

    Parameters
    ----------
    lines : DataFrame
        The columns of floor-summary.csv.
    """
    figure = Figure(figsize=(8.0, 1.2 + 0.26 * len(lines)), layout="constrained")
    axes = figure.subplots()
    for column, label, marker, colour in FLOORS:
        axes.plot(100.0 * lines[column], range(len(lines)), marker, color=colour, label=label,
                  markersize=8, markerfacecolor=colour if marker == "o" else "none")  # fmt: skip
    pairs = zip(lines["engine"].astype(str), lines["floor"], strict=True)
    names = [f"{title_of(engine)}: {floor}" for engine, floor in pairs]
    axes.set_yticks(range(len(lines)), names)
    axes.set(ylim=(len(lines) - 0.5, -0.5), xlim=(-8.0, 108.0))
    axes.set_xlabel("way over which the floor carries the block, of its own  [%]")
    axes.grid(axis="x", alpha=0.25)
    axes.legend(loc="center", frameon=False)
    axes.set_title("A floor that is moved by position alone carries nothing", fontsize=12)
    return figure


def draw_times(lines: pd.DataFrame, title: str, along: str) -> Figure:
    """Draw for each engine and preset a line from the median to the largest error at its time.

    Parameters
    ----------
    lines : DataFrame
        The columns of `studies.scenes.told.lines_of`.
    title, along : str
        What stands above, and along the axis of errors.
    """
    figure = Figure(figsize=(8.0, 4.6), layout="constrained")
    axes = figure.subplots()
    axes.set(xscale="log", yscale="log", xlabel="run time of a case  [ms]", ylabel=along)
    names = []
    for row in lines.dropna(subset="median_error").to_dict("records"):
        engine, preset = engine_of(row["source"]), preset_of(row["source"])
        ends = [max(row[name], LOWEST) for name in ("median_error", "largest_error")]
        colour = told(preset).colour
        axes.plot([row["ms"]] * 2, ends, color=colour, linewidth=1.5, alpha=0.5)
        axes.plot(row["ms"], ends[0], "o", color=colour, markersize=6)
        names.append(Name(title_of(engine), row["ms"], ends[0], colour))
    axes.grid(alpha=0.25)
    key(figure, preset_dots(in_order(map(preset_of, lines["source"]))), 4, fontsize=10)
    axes.set_title(title, fontsize=12)
    around(axes, names)
    return figure


def _draw(lines: pd.DataFrame, title: str, along: str) -> Figure:
    """Draw a row for each engine, in it a bar for each preset from low to high, and what is said.

    Parameters
    ----------
    lines : DataFrame
        Columns source, low, high and said, which stands behind the bar.
    title, along : str
        What stands above, and along the axis.
    """
    engines = list(dict.fromkeys(map(engine_of, lines["source"])))
    presets = in_order(map(preset_of, lines["source"]))
    each = 0.25 + 0.12 * len(presets)
    figure = Figure(figsize=(8.0, 1.3 + each * len(engines)), layout="constrained")
    axes = figure.subplots()
    for row in lines.to_dict("records"):
        place = presets.index(preset_of(row["source"])) - 0.5 * (len(presets) - 1)
        y = engines.index(engine_of(row["source"])) + 0.6 * place / len(presets)
        ends = [max(row[name], LOWEST) for name in ("low", "high")]
        colour = told(preset_of(row["source"])).colour
        axes.plot(ends, [y, y], color=colour, linewidth=5, solid_capstyle="round")
        axes.plot(ends[0], y, "o", color=colour, markersize=7)
        axes.text(ends[1], y, f"   {row['said']}", va="center", fontsize=8, color=colour,
                  clip_on=False)  # fmt: skip
    axes.set_yticks(range(len(engines)), [title_of(name) for name in engines])
    axes.set(xscale="log", ylim=(len(engines) - 0.5, -0.5), xlabel=along)
    if lines["said"].any():
        axes.set_xlim(right=ROOM * axes.get_xlim()[1])
    axes.grid(axis="x", alpha=0.25)
    key(figure, preset_dots(presets), 4, fontsize=10)
    axes.set_title(title, fontsize=12)
    return figure
