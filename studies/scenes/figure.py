"""Errors of a scene's engines against their run times, and what a floor carries."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
from matplotlib.figure import Figure

from studies.drawing.block import draw_scene
from studies.drawing.facets import key, preset_dots
from studies.drawing.kept import Pictures
from studies.drawing.labels import Name, around
from studies.drawing.styles import title_of
from studies.measures.presets import engine_of, in_order, preset_of
from studies.measures.presets import told as as_told
from studies.measures.wrongness import KINDS
from studies.scenes.told import SCENES, by_scene, found_in, ranked

LOWEST = 1e-7
"""Smaller errors are drawn here."""


FLOORS = (
    ("carried", "moved at once", "o", "#0072B2"),
    ("carried_after_rest", "after 1 s of rest", "s", "#D55E00"),
)
"""Column -> how it is drawn."""


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

    Outcomes that are wrong are counted beside the name.

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
        colour = as_told(preset).colour
        axes.plot([row["ms"]] * 2, ends, color=colour, linewidth=1.5, alpha=0.5)
        axes.plot(row["ms"], ends[0], "o", color=colour, markersize=6)
        wrong = sum(row[kind] for kind in KINDS)
        named = title_of(engine) + (f", {wrong:.0f} wrong" if wrong else "")
        names.append(Name(named, row["ms"], ends[0], colour))
    axes.grid(alpha=0.25)
    key(figure, preset_dots(in_order(map(preset_of, lines["source"]))), 4, fontsize=10)
    axes.set_title(title, fontsize=11)
    around(axes, names)
    return figure


def pictures(folder: Path) -> Pictures:
    """Draw each scene, its engines' errors against their times, and what there is of floors."""
    drawn = {f"{name}-scene": draw_scene(told.system, told.at) for name, told in SCENES.items()}
    for name, lines in by_scene(folder).items():
        told = SCENES[name]
        low, high = ranked(lines, told.words)
        title = f"{told.title.capitalize()}: median errors from {low} to {high}"
        drawn[f"{name}-time"] = draw_times(lines, title, told.along)
    floors = found_in(folder / "floor-summary.csv")
    return drawn | ({} if floors.empty else {"floor": draw_floors(floors)})
