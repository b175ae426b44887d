"""Overturning maps drawn: modes, where models and engines are wrong, what contact they need."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy.typing import NDArray

from studies.cases.window import LEAST_ONSETS, Window
from studies.drawing.facets import HALO, key, panels
from studies.drawing.styles import full_name, title_of
from studies.measures.wrongness import NO_ANSWER, REST

AMPLITUDE, FREQUENCY = "amplitude  $a_p$ / (g tan α)", "frequency  ω/p"
ACROSS = 3
"""Panels in a row of planes."""
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
PLACES = {name: place for place, name in enumerate(VERDICTS)}
CONTOURS = (("friction_needed", (0.3, 0.5, 1.0), "#000000"), ("min_normal", (0.0,), "#D55E00"))
"""Column of the contact forces, its levels and their colour."""


def draw_map(
    modes: Mapping[str, NDArray[np.int32]], forces: pd.DataFrame, window: Window
) -> Figure:
    """Draw the exact modes with the contact that they need, and where each other model differs."""
    drawing, grid = panels(len(modes), 2, (4.6, 3.8), 1.6, sharex=True, sharey=True)
    exact, seen = modes["exact"], {"survives", "overturns"}
    for axes, (model, found) in zip(grid, modes.items(), strict=True):
        codes, colours, title = np.clip(found, -1, 3) + 1, [*MODES.values()], "exact"
        if model != "exact":
            over = np.where(found >= 0, PLACES["overturns"], PLACES["survives"])
            side = np.where(found >= 0, PLACES["false"], PLACES["missed"])
            wrong = (found >= 0) != (exact >= 0)
            codes, colours = np.where(wrong, side, over), COLOURS
            title = f"{full_name(model)}: {100.0 * wrong.mean():.1f} % wrong"
            seen |= {name for name, place in PLACES.items() if place in codes}
        extent = (window.low, window.high, LEAST_ONSETS, window.onsets)
        axes.imshow(codes.T, origin="lower", aspect="auto", interpolation="nearest", extent=extent,
                    **_scale(colours))  # fmt: skip
        axes.set_title(title, fontsize=10)
    _contours(grid[0], forces)
    _name_axes(drawing, grid, 2)
    drawing.suptitle(
        f"Which pulses overturn a block: {window.title}\n"
        "lines: the friction μ that holds the exact motion, and where it lifts off", fontsize=11,
    )  # fmt: skip
    parts = np.bincount(np.clip(exact, -1, 3).ravel() + 1, minlength=len(MODES)) / exact.size
    looks = [look[::-1] for look, part in zip(MODES.items(), parts, strict=True) if part > 1e-3]
    _key(drawing, [*looks, *(VERDICTS[name] for name in VERDICTS if name in seen)], 3)
    return drawing


def _contours(axes: Axes, forces: pd.DataFrame) -> None:
    for name, levels, colour in CONTOURS:
        wide = forces.pivot(index="onsets", columns="omega_over_p", values=name)
        level = np.ma.masked_invalid(wide.to_numpy())
        if level.count() and min(wide.shape) > 1:
            lines = axes.contour(wide.columns, wide.index, level, levels, colors=colour)
            lines.set_path_effects([*HALO])
            for text in axes.clabel(lines, fmt=lambda at: f"μ = {at:g}" if at else "lifts off"):
                text.set_path_effects([*HALO])


def draw_plane(rows: pd.DataFrame, rest_s: float) -> Figure:
    """Draw the verdicts on full sines that come after a rest [s], a map for each engine."""
    shown = (rows["pulse"] == "full-sine") & (rows["aspect"] == 3.0) & (rows["width_m"] == 0.5)
    asked = rows[shown & (rows["source"] != "exact")]
    over = np.where(asked["outcome"] == "overturned", "overturns", "survives")
    known = asked["verdict"].where(asked["verdict"] != "right", over)
    asked = asked.assign(code=known.map(PLACES).where(asked["rest_s"] == rest_s))
    groups = asked.groupby("source", sort=False)
    drawing, grid = panels(len(groups), ACROSS, (2.4, 2.4), 1.3, sharex=True, sharey=True)
    for axes, (source, of) in zip(grid, groups, strict=True):
        codes = of.pivot(index="onsets", columns="omega_over_p", values="code")
        codes = codes.ffill(axis=1).bfill(axis=1)
        axes.pcolormesh(codes.columns, codes.index, codes, shading="nearest", **_scale(COLOURS))
        valid = of.loc[of["code"].notna() & (of["verdict"] != "invalid"), "verdict"]
        right = f"{(valid == 'right').mean():.0%}".replace("%", " %")
        axes.set_title(f"{title_of(str(source))}: {right} right", fontsize=10)
    _name_axes(drawing, grid, ACROSS)
    words = f"after {rest_s:g} s of rest" if rest_s else "at once"
    drawing.suptitle(f"Full sines that come {words}: B = 0.5 m, H = 1.5 m", fontsize=11)
    seen = [VERDICTS[name] for name in VERDICTS if PLACES[name] in set(asked["code"])]
    _key(drawing, seen, 3 if len(groups) >= ACROSS else 2)
    return drawing


def _scale(colours: Sequence[str]) -> dict[str, Any]:
    norm = BoundaryNorm(np.arange(len(colours) + 1) - 0.5, len(colours))
    return {"cmap": ListedColormap(colours), "norm": norm}


def _name_axes(drawing: Figure, grid: Sequence[Axes], across: int) -> None:
    drawing.supylabel(AMPLITUDE, fontsize=10)
    for axes in grid[-across:]:
        axes.set_xlabel(FREQUENCY)


def _key(drawing: Figure, looks: Iterable[tuple[str, str]], across: int) -> None:
    patches = [Patch(facecolor=colour, edgecolor="#888888", label=name) for colour, name in looks]
    key(drawing, patches, across)
