"""Error against run time, a panel for each engine."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from studies.drawing.facets import error_scale, strip_beyond
from studies.drawing.labels import Name, around
from studies.drawing.styles import LOWEST, Style, title_of
from studies.kit.say import duration
from studies.measures.costs import EXACT, exact_cost, joint, parts_of
from studies.measures.presets import look_of

STYLES = {
    EXACT: Style("#000000", "-", "o", 2.2),
    "SciPy RK45": Style("#999999", "-", "s"),
    "SciPy DOP853": Style("#777777", "--", "D"),
    "SciPy Radau": Style("#aaaaaa", "-.", "v"),
    "SciPy LSODA": Style("#555555", ":", "^"),
    "RK4": Style("#56B4E9", "-", "o"),
    "RK4, contact to 1e-6": Style("#56B4E9", "--", "x"),
    "average acceleration": Style("#E69F00", "-", "s"),
    "housner, closed form": Style("#D55E00", "", "*"),
    "modified, closed form": Style("#0072B2", "", "*"),
    "onset-matched, closed form": Style("#CC79A7", "", "*"),
}
WRONG, EDGE, TOP, ACROSS = 10.0, 3.0, 60.0, 3
"""Where methods that fail or are wrong are drawn, the strip there, and most panels in a row."""


def method_style(method: str) -> Style:
    """Return the style of a method: of an engine that of its preset; grey for what is unknown."""
    engine, preset, dial = parts_of(method)
    if not engine:
        return STYLES.get(method, Style("#777777", "-", "."))
    colour = look_of(preset).colour
    return Style(colour, ":", "+", 0.9) if dial else Style(colour, "-", "o", 1.6, "full")


def placed(table: pd.DataFrame) -> pd.DataFrame:
    """Return both sets of a setting as one line, with its place on the scale of errors.

    Its error is the larger of the medians; "wrong" says whether a case failed or has a wrong
    outcome. A case that was given up before it was timed has no place on the scale.
    """
    medians = table.groupby(["method", "value"], sort=False)["median_error"].max().to_numpy()
    lines = joint(table)
    lines["wrong"] = (lines["failed"] > 0) | ~np.isfinite(lines["max_error"])
    lines["error"] = np.maximum(np.where(np.isfinite(medians), medians, np.nan), LOWEST)
    return lines[lines["wall_s"] > 0.0]


def draw_precision(table: pd.DataFrame) -> Figure:
    """Draw the median error of the peak against the run time of a case; others pale behind."""
    lines = placed(table)
    engine = lines["method"].map(lambda method: parts_of(method)[0])
    names = sorted(engine.unique(), key=bool)  # what is no engine comes first
    first = names.count("")
    across = max(min(len(names) - first, ACROSS), 1)
    down = -(-(len(names) - first) // across)
    high = 1.2 + 2.9 * first + (2.4 if across > 1 else 3.8) * down
    drawing = Figure(figsize=(10.4, high), layout="constrained")
    grid = drawing.add_gridspec(first + down, across, height_ratios=[1.4] * first + [1.0] * down)
    panels: list[Axes] = []
    named = []
    for place, name in enumerate(names, start=-first):
        where = grid[first + place // across, place % across] if name else grid[0, :]
        scale = panels[first] if name and place else None
        axes = drawing.add_subplot(where, sharex=panels[0] if panels else None, sharey=scale)
        if name:
            lowest = place + across >= len(names) - first
            axes.tick_params(labelleft=place % across == 0, labelbottom=lowest)
        if scale is None:  # the others share its scale
            low = 1e-10 if name else LOWEST / 3.0
            axes.set(xscale="log", yscale="log", ylim=(low, TOP))
            error_scale(axes.yaxis, low, 1.0, 2 if name else 4)
        mine = lines[engine == name]
        named.append(_panel(axes, mine, lines[engine != name]))
        cases = int(table.groupby("set")["cases"].max().sum())
        words = f"a failure or a wrong outcome in one of {cases} cases" * (not panels)
        strip_beyond(axes, EDGE, words)
        title = title_of(name) or "Models, and solvers of ordinary differential equations"
        axes.set_title(title, fontsize=10.5, fontweight="bold")
        panels.append(axes)
    drawing.supxlabel("run time of a case, set-up apart  [s]", fontsize=10)
    drawing.supylabel("median relative error of the peak, of the harder set", fontsize=10)
    exact = exact_cost(table)
    own = "" if np.isnan(exact) else f"; the exact solution takes {duration(exact)} a case"
    drawing.suptitle(f"Error against run time, from coarse to fine{own}", fontsize=12)
    for axes, of_it in zip(panels, named, strict=True):
        around(axes, of_it)
    return drawing


def _panel(axes: Axes, mine: pd.DataFrame, others: pd.DataFrame) -> list[Name]:
    """Draw some methods, pale behind them the others; return where their names belong."""
    behind = [line[["wall_s", "error"]].to_numpy() for _, line in others.groupby("method")]
    axes.add_collection(LineCollection(behind, colors="#dcdcdc", linewidths=0.8, zorder=0))
    names = []
    for name, line in mine.groupby("method", sort=False):
        style = method_style(str(name))
        size = 9.0 if style.marker == "*" else 3.2
        look = {**style.points(size), "linestyle": style.line or "none", "linewidth": style.width}
        axes.plot(line["wall_s"], line["error"], **look)
        lost = line[line["wrong"]]
        broken = {**style.points(4.0), "marker": "x", "markeredgewidth": 1.2}
        axes.plot(lost["wall_s"], [WRONG] * len(lost), **broken)
        _, preset, dial = parts_of(str(name))
        words = dial or (look_of(preset).short if preset else str(name))
        best = line.fillna({"error": WRONG}).sort_values("error").iloc[0]
        names.append(Name(words, best["wall_s"], best["error"], style.colour))
    axes.grid(alpha=0.2)
    return names
