"""The errors of random cases in bands of their sensitivity, a box for each engine and band."""

from __future__ import annotations

from itertools import pairwise
from math import inf

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.drawing.facets import error_scale, panels, rows
from studies.drawing.styles import LOWEST, name_of, style_of
from studies.measures.differences import sensitivity_of
from studies.measures.words import part

BANDS = (0.0, 3.0, 10.0, 100.0, inf)
"""Where bands of the sensitivity S end."""


def draw_conditioning(compared: pd.DataFrame) -> Figure:
    """Draw the errors of cases by how far small errors move their peaks."""
    sizes = compared.assign(s=sensitivity_of(compared), size=compared["error"].abs())
    sizes = sizes[sizes["size"].notna() & sizes["s"].notna()]
    sources = list(compared["source"].unique())
    bands = {
        (low, high): sizes[(sizes["s"] >= low) & (sizes["s"] < high)]
        for low, high in pairwise(BANDS)
    }
    bands = {ends: cases for ends, cases in bands.items() if len(cases)} or {BANDS[:2]: sizes}
    each = (9.4 / len(bands), 0.9 + 0.32 * len(sources))
    drawing, grid = panels(len(bands), len(bands), each, 1.1, sharex=True, sharey=True)
    low = sizes["size"].clip(lower=LOWEST).min() if len(sizes) else 1e-8
    high = max(sizes["size"].max(), 1.0) if len(sizes) else 1.0
    grid[0].set(xscale="log", xlim=(0.5 * low, 2.0 * high))
    error_scale(grid[0].xaxis, *grid[0].get_xlim())
    for axes, ((start, end), cases) in zip(grid, bands.items(), strict=True):
        _boxes(axes, cases, sources)
        words = f"from {start:g}" if end == inf else f"{start:g} to {end:g}" if start else "below 3"
        axes.set_title(f"S {words}: {cases['case'].nunique()} cases", fontsize=10)
    drawing.supxlabel(
        "relative error of the peak; S: how many times as far as the pulse or an impact it moves",
        fontsize=10,
    )
    drawing.suptitle(_title(list(bands.items())), fontsize=12)
    return drawing


def _boxes(axes: Axes, cases: pd.DataFrame, sources: list[str]) -> None:
    rows(axes, [name_of(source) for source in sources], 10.0)
    for place, source in enumerate(sources):
        size = cases.loc[cases["source"] == source, "size"].clip(lower=LOWEST)
        if size.empty:
            continue
        colour = style_of(source).colour
        axes.boxplot(
            size, positions=[place], orientation="horizontal", widths=0.55, whis=(0, 100),
            patch_artist=True, manage_ticks=False, medianprops={"color": "black"},
            boxprops={"facecolor": colour, "alpha": 0.6, "edgecolor": colour},
            whiskerprops={"color": colour}, capprops={"color": colour},
        )  # fmt: skip


def _title(bands: list[tuple[tuple[float, float], pd.DataFrame]]) -> str:
    ((_, low), calm), ((high, _), wild) = bands[0], bands[-1]
    if calm.empty:
        return "No case that both survive"
    least, most = (part(cases["size"].max()) for cases in (calm, wild))
    if calm is wild:
        return f"Peaks are off by up to {least}"
    return (
        f"Errors grow with the sensitivity S: up to {least} below {low:g}, {most} from {high:g} on"
    )
