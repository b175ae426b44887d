"""Error against run time of a case, and against cases a second of batches."""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from engines import ENGINES
from engines.factors import BEST, DEFAULT
from studies.drawing.facets import dot, error_scale, key, preset_dots, sheet
from studies.drawing.styles import LOWEST, style_of, title_of
from studies.kit.say import capital, duration
from studies.measures.batches import MJX, MJX32, NAMES, WARP, C
from studies.measures.costs import EXACT, exact_cost, joint, parts_of
from studies.measures.presets import look_of

WRONG = 10.0
"""Where settings are drawn with which half of the cases and more have no error."""
GAP = 0.07
"""Least distance between two names, over the height of a panel."""
LANDING = "landing"
MARKERS = {C: "o", WARP: "s", MJX: "^", MJX32: "v"}
"""Way to step a batch -> its marker."""


def band_of(method: str) -> str | None:
    """Return the preset in whose band a method is drawn, "" without one; None if in none."""
    engine, preset, dial = parts_of(method)
    if not engine or (preset in (DEFAULT, BEST) and not dial):
        return preset
    return LANDING if preset == ENGINES[engine].best.name and not dial else None


def _banded(table: pd.DataFrame) -> pd.DataFrame:
    medians = table.groupby(["method", "value"], sort=False)["median_error"].max().to_numpy()
    error = np.where(np.isfinite(medians), np.maximum(medians, LOWEST), WRONG)
    lines = joint(table).assign(error=error).query("wall_s > 0.0")
    return lines.assign(band=lines["method"].map(band_of))


def draw_precision(table: pd.DataFrame, others: pd.DataFrame | None = None) -> Figure:
    """Draw the median error of the peak, of the harder set, against the run time of a case."""
    lines = _banded(table)
    cloud = lines.iloc[:0] if others is None or others.empty else _banded(others)
    cloud = cloud[~cloud["method"].isin(lines["method"])]
    known = [name for name in ("", DEFAULT, BEST, LANDING) if name in {*lines["band"]}]
    drawing, grid = sheet((9.4, 1.2 + 2.6 * len(known)), len(known), 1, sharex=True)
    grid[0].set(xscale="log")
    for axes, name in zip(grid, known, strict=True):
        mine, grey = (each[each["band"] == name] for each in (lines, cloud))
        errors = pd.concat([mine, grey])["error"]
        axes.set(yscale="log", ylim=(0.3 * errors.min(), 2.0 * max(errors.max(), 1.0)))
        error_scale(axes.yaxis, *axes.get_ylim(), 2 if name else 4)
        axes.grid(alpha=0.2)
        title = capital(look_of(name).words) if name else "Models and solvers"
        axes.set_title(title, fontsize=10.5, fontweight="bold", loc="left")
        _lines(axes, mine, grey)
    grid[-1].set_xlabel("run time of a case, set-up apart  [s]", fontsize=10)
    drawing.supylabel("median relative error of the peak, of the harder set", fontsize=10)
    exact = exact_cost(table)
    own = "" if np.isnan(exact) else f"; the exact solution takes {duration(exact)} a case"
    beside = "" if cloud.empty else "; grey: other engines, published"
    cases = int(table.groupby("set")["cases"].max().sum())
    drawing.suptitle(
        f"Error against run time, from coarse to fine{own}\n"
        f"a cross: a failure or a wrong outcome in one of {cases} cases{beside}", fontsize=12,
    )  # fmt: skip
    return drawing


def _lines(axes: Axes, lines: pd.DataFrame, cloud: pd.DataFrame) -> None:
    """Draw a line for each method, and write the names beside their ends, from above."""
    least = cloud.groupby("method", sort=False)["error"].last().sort_values(kind="stable").index
    best = sorted(least, key=lambda it: it != least[0] and parts_of(it)[0] != "mujoco")[:2]
    drawn = pd.concat([lines, cloud[cloud["method"].isin(best)]])
    ends = drawn.groupby("method", sort=False)["error"].last().sort_values(kind="stable")
    low, high = np.log(axes.get_ylim())
    gaps = GAP * np.arange(len(ends))
    heights = np.maximum.accumulate((np.log(ends) - low) / (high - low) - gaps) + gaps
    heights -= max(heights.iloc[-1] - 0.97, 0.0) if len(ends) else 0.0
    places = dict(zip(ends.index, heights, strict=True))
    for name, line in cloud.groupby("method", sort=False):
        axes.plot(line["wall_s"], line["error"], color="#BBBBBB", linewidth=0.9)
        if name in places:
            _name(axes, str(name), line, places[name], "#666666")
    for number, (name, line) in enumerate(lines.groupby("method", sort=False)):
        engine = parts_of(str(name))[0]
        other = "#000000" if name == EXACT else f"C{number}"
        colour = style_of(engine).colour if engine else other
        axes.plot(line["wall_s"], line["error"], color=colour, linewidth=1.4)
        wrong = (line["failed"] > 0) | ~np.isfinite(line["max_error"])
        for points, marker in ((line[~wrong], "o"), (line[wrong], "x")):
            axes.plot(points["wall_s"], points["error"], marker, color=colour, markersize=4.0)
        _name(axes, str(name), line, places[name], colour)


def _name(axes: Axes, method: str, line: pd.DataFrame, place: float, colour: str) -> None:
    engine = parts_of(method)[0]
    words = title_of(engine) if engine else capital(method)
    leader = {"arrowstyle": "-", "color": colour, "lw": 0.5, "alpha": 0.6}
    end = line["wall_s"].iloc[-1], line["error"].iloc[-1]
    axes.annotate(words, end, (1.06, place), textcoords="axes fraction", va="center", fontsize=9,
                  color=colour, arrowprops=leader)  # fmt: skip


def draw_batch(lines: pd.DataFrame) -> Figure:
    """Draw a line for each preset and way to step, over its steps, and name other sizes."""
    figure, (axes,) = sheet((9.0, 5.6))
    axes.set(xscale="log", yscale="log", xlabel="cases a second", ylim=(1e-5, 1.0))
    axes.set_ylabel("median relative error of the peak")
    stepped = lines["backend"].isin(MARKERS)
    usable = lines[stepped & lines["median_error"].notna()]
    for (backend, preset), mine in usable.groupby(["backend", "preset"], sort=False):
        colour, marker = look_of(str(preset)).colour, MARKERS[str(backend)]
        look: dict[str, Any] = {"color": colour, "marker": marker}
        along = mine[mine["worlds"] == mine["worlds"].mode().max()].sort_values("dt_ms")
        axes.plot(along["cases_per_s"], along["median_error"], **look)
        for it in mine.drop(along.index).to_dict("records"):
            worlds, place = str(it["worlds"]), (it["cases_per_s"], it["median_error"])
            axes.plot(*place, fillstyle="none", **look)
            axes.annotate(worlds, place, (0, -14), textcoords="offset points", ha="center")
    for it in lines[~stepped].to_dict("records"):
        axes.axvline(it["cases_per_s"], color="black", linewidth=2.0)
        axes.annotate(f"exact solution, \n{it['name']} ", (it["cases_per_s"], 1.3e-5), ha="right")
    error_scale(axes.yaxis, 1e-5, 1.0, 1)
    axes.grid(alpha=0.25)
    ways = [dot(NAMES[name], MARKERS[name]) for name in usable["backend"].unique()]
    key(figure, [*ways, *preset_dots(usable["preset"].unique())])
    return figure
