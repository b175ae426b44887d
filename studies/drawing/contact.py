"""The largest error with each change of a contact that matters, a panel for each engine."""

from __future__ import annotations

from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from engines.factors import BY_DEFAULT, OWN_STEP
from studies.drawing.facets import dot, error_scale, key, panels, preset_dots, rows, strip_beyond
from studies.drawing.styles import title_of
from studies.kit.say import capital
from studies.measures.presets import in_order, look_of

MATTER = 6
"""How many variants of an engine are drawn one by one."""
LOWEST = 1e-6
"""Errors below are drawn here."""


def draw_contact(lines: pd.DataFrame) -> Figure:
    """Draw the error of the peak of the variants that matter most, and count the others."""
    engines = list(lines["engine"].unique())
    drawn = [_ordered(lines[lines["engine"] == engine]) for engine in engines]
    most = max(len(ordered) for ordered, _ in drawn)
    drawing, grid = panels(len(engines), 2, (4.9, 0.6 + 0.2 * most), 0.9, sharex=True)
    grid[0].set(xscale="log", xlim=(LOWEST / 2.0, 15.0))
    error_scale(grid[0].xaxis, LOWEST, 1.0)
    for axes, engine, (ordered, others) in zip(grid, engines, drawn, strict=True):
        _one_engine(axes, ordered.to_dict("records"))
        axes.set_ylim(most + 0.5, -0.6)
        axes.set_title(title_of(engine), fontsize=11, fontweight="bold", loc="left")
        words = f"{len(others)} others, {others['broken'].sum()} of which break a case"
        axes.text(1.0, most, words, fontsize=8.5, ha="right", va="center", color="#555555",
                  transform=axes.get_yaxis_transform())  # fmt: skip
    changed = lines[lines["factor"] != ""]
    drawing.suptitle(
        f"{changed['worse'].sum()} of {len(changed)} changes of a contact, one at a time, break "
        f"a case;\nthe {MATTER} that matter most for each engine, median to largest",
        fontsize=12,
    )
    marks = [dot("a case fails", "X", "black"), dot("an outcome is wrong", "s", "black",
                                                     markerfacecolor="none")]  # fmt: skip
    key(drawing, [*preset_dots(lines["preset"]), *marks], 4)
    return drawing


def _one_engine(axes: Axes, records: list[dict[Any, Any]]) -> None:
    rows(axes, [_label(line) for line in records])
    strip_beyond(axes, 2.5, along="x")  # of failed variants and wrong outcomes
    for place, (text, line) in enumerate(zip(axes.get_yticklabels(), records, strict=True)):
        colour = look_of(str(line["preset"])).colour
        text.set(color=colour, fontweight="normal" if line["factor"] else "bold")
        median, error = (max(float(line[name]), LOWEST) for name in ("median_error", "max_error"))
        axes.plot([median, error], [place, place], color=colour, linewidth=2.0, alpha=0.5)
        axes.plot(error, place, "o", color=colour, markersize=4.5 if line["factor"] else 7)
        if line["failed"]:
            axes.plot(6.0, place, "X", color="#000000", markersize=6)
        elif line["wrong"]:
            axes.plot(6.0, place, "s", color="#000000", fillstyle="none", markersize=5.5)


def _ordered(lines: pd.DataFrame) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return an engine's presets with the variants that matter, and the other variants.

    Of each preset in turn the one that breaks most cases, or else moves a peak or an impact most;
    they stand by preset, from the most accurate to the failed.
    """
    broken = lines["worse"] | lines["max_error"].isna()
    lines = lines.assign(
        broken=broken,
        lost=(lines["failed"] + lines["wrong"]).where(broken, 0),
        matter=lines[["moved", "ratio_moved"]].max(axis=1).fillna(0.0),
        first=-lines["preset"].map(in_order(lines["preset"]).index),
        own=lines["factor"] != "",
    )
    most = ["broken", "lost", "matter"]
    varied = lines[lines["own"]].sort_values(most, ascending=False, kind="stable")
    turn = varied.groupby("preset").cumcount().sort_values(kind="stable")
    varied = varied.loc[turn.index]
    drawn = pd.concat([lines[~lines["own"]], varied.head(MATTER)])
    return drawn.sort_values(["first", "own", "broken", "max_error"]), varied.iloc[MATTER:]


def _label(line: dict[Any, Any]) -> str:
    if not line["factor"]:
        return capital(look_of(str(line["preset"])).short)
    level = str(line["level"]).replace(OWN_STEP, "its own").replace(BY_DEFAULT, "its own")
    return f"{line['factor']}: {level}"
