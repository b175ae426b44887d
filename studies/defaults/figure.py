"""A map of pulses for each engine: where it is right as it comes, and in what it is wrong."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from studies.defaults.study import CLOSE, FALSE, INVALID, MISSED, OFF, RIGHT, read
from studies.drawing.facets import key, panels
from studies.drawing.kept import Pictures
from studies.drawing.styles import engine_title
from studies.measures.words import part
from studies.measures.wrongness import NO_ANSWER, REST, WORDS

# the palette of Okabe and Ito, lightened where most of an area is filled
COLOURS = {
    RIGHT[0]: "#FFFFFF",
    RIGHT[1]: "#CCCCCC",
    OFF: "#F7EE8A",
    FALSE: "#D55E00",
    MISSED: "#0072B2",
    REST: "#56B4E9",
    NO_ANSWER: "#000000",
    INVALID: "#E6DCF0",
}
LABELS = {
    RIGHT[0]: f"survives, peak within {part(CLOSE)}",
    RIGHT[1]: "overturns, as it should",
    OFF: f"survives, peak off by more than {part(CLOSE)}",
    FALSE: "overturns falsely",
    MISSED: "overturning missed",
    REST: WORDS[REST],
    NO_ANSWER: WORDS[NO_ANSWER],
    INVALID: "not judged: it should slide or lift off",
}
ACROSS = 3
SHOWN_PULSE, SHOWN_ASPECT = "full-sine", 3.0


def draw_maps(rows: pd.DataFrame) -> Figure:
    """Draw the verdicts on full sines of one width at H/B 3, a map for each engine.

    Parameters
    ----------
    rows : DataFrame
        The columns of defaults.csv, with verdicts.
    """
    shown = (rows["pulse"] == SHOWN_PULSE) & (rows["aspect"] == SHOWN_ASPECT)
    rows = rows[shown & (rows["source"] != "exact")]
    sources = list(rows["source"].unique())
    drawing, grid = panels(len(sources), ACROSS, (2.4, 2.4), 1.3, sharex=True, sharey=True)
    for axes, source in zip(grid, sources, strict=True):
        _map(axes, rows[rows["source"] == source])
    for axes in grid[::ACROSS]:
        axes.set_ylabel("amplitude  $a_p$ / (g tan α)")
    for axes in grid[-ACROSS:]:
        axes.set_xlabel("frequency  ω/p")
    width = rows["width_m"].iloc[0]
    drawing.suptitle(
        f"As documented: full sines, B = {width:g} m, H = {SHOWN_ASPECT * width:g} m;\nevery "
        "other one comes after a second of rest",
        fontsize=11,
    )
    seen = {name: colour for name, colour in COLOURS.items() if name in set(rows["verdict"])}
    handles = [
        Patch(facecolor=colour, edgecolor="#888888", label=LABELS[name])
        for name, colour in seen.items()
    ]
    key(drawing, handles, 3 if len(sources) >= ACROSS else 2)
    return drawing


def _map(axes: Axes, rows: pd.DataFrame) -> None:
    names = list(COLOURS)
    codes = rows.assign(code=rows["verdict"].map(names.index)).pivot(
        index="onsets", columns="omega_over_p", values="code"
    )
    axes.pcolormesh(
        codes.columns,
        codes.index,
        codes,
        shading="nearest",
        cmap=ListedColormap(list(COLOURS.values())),
        norm=BoundaryNorm(np.arange(len(names) + 1) - 0.5, len(names)),
    )
    right_part = rows.loc[rows["verdict"] != INVALID, "verdict"].isin(RIGHT).mean()
    name = engine_title(str(rows["source"].iloc[0]))
    axes.set_title(f"{name}: {right_part:.0%} right".replace("%", " %"), fontsize=10)


def pictures(folder: Path) -> Pictures:
    """Draw the maps of the smallest and of the largest block from a folder's defaults.csv."""
    rows = read(folder)
    widths = {"small": rows["width_m"].min(), "large": rows["width_m"].max()}
    return {name: draw_maps(rows[rows["width_m"] == width]) for name, width in widths.items()}
