"""Work-precision diagrams, and what each thing put back into a scene costs and changes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from engines import ENGINES
from studies.drawing.facets import error_scale, strip_beyond
from studies.drawing.labels import Name, around
from studies.drawing.styles import LOWEST, Style, engine_style, title_of
from studies.measures.finer import joint
from studies.measures.presets import in_order, told
from studies.measures.words import capital, duration, out_of, per_cent
from studies.precision.choices import EXACT, cheapest_below, exact_cost

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
OTHERS = "Models, and solvers of ordinary differential equations"
LEAST = 1e-10
"""End of the scale of errors of engines."""
PALE = "#dcdcdc"
"""Of the other methods behind those that a panel is about."""
ACROSS = 3
"""Panels of engines in a row."""
TARGET = 1e-3
"""The error that the title tells the price of."""
WRONG, EDGE, TOP = 10.0, 3.0, 60.0
"""Where methods are drawn that fail or get an outcome wrong, and the strip around that."""


def engine_in(method: str) -> tuple[str, str]:
    """Return the engine of a method and its preset; two empty words for all other methods."""
    engine, _, preset = method.partition(" ")
    return (engine, preset) if engine in ENGINES else ("", "")


def called(method: str) -> str:
    """Return how a method is called beside others: an engine by its title, with its preset."""
    engine, varied = engine_in(method)
    preset, comma, dial = varied.partition(", ")
    return f"{title_of(engine)}, {told(preset).short}{comma}{dial}" if engine else method


def style_of(method: str) -> Style:
    """Return the style of a method: of an engine that of its preset; grey for what is unknown."""
    engine, varied = engine_in(method)
    if not engine:
        return STYLES.get(method, Style("#777777", "-", "."))
    preset, _, dial = varied.partition(", ")
    colour = told(preset).colour
    return Style(colour, ":", "+", 0.9) if dial else Style(colour, "-", "o", 1.6, "full")


def draw_precision(table: pd.DataFrame) -> Figure:
    """Draw the largest error of the peak against the run time of a case."""
    lines = placed(table)
    engine = lines["method"].map(lambda method: engine_in(method)[0])
    engines = [name for name in engine.unique() if name]
    down = -(-len(engines) // ACROSS)
    drawing = Figure(figsize=(10.4, 4.1 + 2.4 * down), layout="constrained")
    grid = drawing.add_gridspec(1 + down, ACROSS, height_ratios=[1.4, *[1.0] * down])
    panels = [drawing.add_subplot(grid[0, :])]
    for place in range(len(engines)):
        shared = {"sharex": panels[0], "sharey": panels[1] if place else None}
        axes = drawing.add_subplot(grid[1 + place // ACROSS, place % ACROSS], **shared)
        axes.tick_params(labelleft=place % ACROSS == 0, labelbottom=place + ACROSS >= len(engines))
        panels.append(axes)
    for place, (axes, name) in enumerate(zip(panels, ["", *engines], strict=True)):
        low = LEAST if name else LOWEST / 3.0
        if place < 2:  # the others share its scale
            axes.set(xscale="log", yscale="log", ylim=(low, TOP))
            error_scale(axes.yaxis, low, 1.0, 2 if name else 4)
        _panel(axes, lines[engine == name], lines[engine != name])
        strip_beyond(axes, EDGE, "" if name else f"failed or wrong in one of {_cases(table)} cases")
        axes.set_title(title_of(name) or OTHERS, fontsize=10.5, fontweight="bold")
    drawing.supxlabel("run time of a case, set-up apart  [s]", fontsize=10)
    drawing.supylabel("median relative error of the peak, of the harder set", fontsize=10)
    drawing.suptitle(message(table), fontsize=12)
    for axes, name in zip(panels, ["", *engines], strict=True):
        around(axes, _names(lines[engine == name]), 8.0)
    return drawing


def _cases(table: pd.DataFrame) -> int:
    return int(table.groupby("set")["cases"].max().sum())


def placed(table: pd.DataFrame) -> pd.DataFrame:
    """Return both sets of a setting as one line, with its place on the scale of errors.

    Its error is the larger of the medians; "wrong" says whether a case failed or fell wrongly.
    """
    medians = table.groupby(["method", "value"], sort=False)["median_error"].max()
    lines = joint(table).assign(error=medians.to_numpy())
    lines = lines.assign(wrong=(lines["failed"] > 0) | ~np.isfinite(lines["max_error"]))
    lines["error"] = lines["error"].where(np.isfinite(lines["error"])).clip(lower=LOWEST)
    # a case that was given up before it was timed has no place on the scale
    return lines[lines["wall_s"] > 0.0]


def message(table: pd.DataFrame) -> str:
    """Say how many engines keep an error at best and as they come, and at which price."""
    best: dict[str, list[float]] = {}
    for method, line in joint(table).groupby("method", sort=False):
        engine, preset = engine_in(str(method))
        if engine and "," not in preset:
            kept = cheapest_below(line, TARGET)
            best.setdefault(preset, []).append(np.inf if kept is None else kept["wall_s"])
    exact = f"the exact solution takes {duration(exact_cost(table))} a case"
    counts = {name: np.isfinite(best[name]).sum() for name in reversed(in_order(best))}
    ends = list(dict.fromkeys([*list(counts)[:1], *list(counts)[-1:]]))
    words = [f"{told(name).short} in {out_of(counts[name], len(best[name]))}" for name in ends]
    if not words:
        return capital(exact)
    cheapest = min(min(times) for times in best.values())
    price = f"from {duration(cheapest)} a case; " if np.isfinite(cheapest) else ""
    kept_in = f"An error below {per_cent(TARGET)} in all {_cases(table)} cases"
    return f"{kept_in}: {', '.join(words)} engines;\n{price}{exact}"


def _panel(axes: Axes, mine: pd.DataFrame, others: pd.DataFrame) -> None:
    behind = [line[["wall_s", "error"]].to_numpy() for _, line in others.groupby("method")]
    axes.add_collection(LineCollection(behind, colors=PALE, linewidths=0.8, zorder=0))
    for name, line in mine.groupby("method", sort=False):
        style = style_of(str(name))
        size = 9.0 if style.marker == "*" else 3.2
        look = {**style.points(size), "linestyle": style.line or "none", "linewidth": style.width}
        axes.plot(line["wall_s"], line["error"], **look)
        lost = line[line["wrong"]]
        broken = {**style.points(4.0), "marker": "x", "markeredgewidth": 1.2}
        axes.plot(lost["wall_s"], [WRONG] * len(lost), **broken)
    axes.grid(alpha=0.2)


def _names(lines: pd.DataFrame) -> Sequence[Name]:
    names = []
    for method, line in lines.groupby("method", sort=False):
        preset, _, dial = engine_in(str(method))[1].partition(", ")
        best = line.fillna({"error": WRONG}).sort_values("error").iloc[0]
        words = dial or (told(preset).short if preset else str(method))
        names.append(Name(words, best["wall_s"], best["error"], style_of(str(method)).colour))
    return names


def draw_scenes(scenes: pd.DataFrame) -> Figure:
    """Draw what each thing put back into a scene costs and changes, a dot for each engine."""
    names = list(scenes["scene"].unique())
    engines = list(scenes["engine"].unique())
    drawing = Figure(figsize=(9.6, 1.4 + 0.4 * len(names)), layout="constrained")
    costs, errors = drawing.subplots(1, 2, sharey=True)
    for number, engine in enumerate(engines):
        rows = scenes[scenes["engine"] == engine].set_index("scene").loc[names]
        places = np.arange(len(names)) + 0.7 * ((number + 0.5) / len(engines) - 0.5)
        # what an engine has not takes no time
        taken = rows["wall_s"].where(rows["error"].notna())
        factor, look = taken / taken.iloc[0], engine_style(engine, "").points(6.5)
        costs.hlines(places, 1.0, factor, color=look["color"], linewidth=1.2)
        costs.plot(factor, places, **look)
        errors.plot(rows["error"].abs().clip(lower=LOWEST), places, **look, label=title_of(engine))
    costs.set_yticks(range(len(names)), names)
    costs.invert_yaxis()
    costs.set(xscale="log", xlabel="run time over the scene as it is  [–]")
    costs.axvline(1.0, color="#555555", linewidth=0.8)
    costs.set_xticks([0.5, 1, 2, 5, 10, 20], ["½", "1", "2", "5", "10", "20"])
    costs.set_xticks([], minor=True)
    errors.set(xscale="log", xlabel="relative error of the peak  [–]")
    for axes in (costs, errors):
        axes.grid(alpha=0.25)
    drawing.legend(loc="outside lower center", ncols=min(len(engines), 5), frameon=False)
    return drawing
