"""Random cases: errors in bands of their sensitivity, and errors over the engines' estimates."""

from __future__ import annotations

from itertools import pairwise
from math import inf

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.drawing.facets import error_scale, panels, rows
from studies.drawing.styles import LOWEST, name_of, style_of, title_of
from studies.kit.say import part
from studies.measures.differences import sensitivity_of
from studies.measures.presets import in_order, in_words, preset_of

BANDS = (0.0, 3.0, 10.0, 100.0, inf)
"""Where bands of the sensitivity S end."""
LEAST, MARKED, MOST = 0.1, 10.0, 1e4
"""Ends of the scale of factors, and the factor at which engines are named with their part."""


def draw_conditioning(errors: pd.DataFrame) -> Figure:
    """Draw the errors of cases by how far small errors move their peaks."""
    sizes = errors.assign(s=sensitivity_of(errors), size=errors["error"].abs())
    sizes = sizes[sizes["size"].notna() & sizes["s"].notna()]
    sources = list(errors["source"].unique())
    bands = {ends: sizes[sizes["s"].between(*ends, inclusive="left")] for ends in pairwise(BANDS)}
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
        "relative error of the peak;  S: by how many per cent a peak moves for 1 % of the pulse "
        "or of an impact's velocity ratio",
        fontsize=10,
    )
    ends, most = [*bands], [part(cases["size"].max()) for cases in bands.values()]
    title = f"Peaks are off by up to {most[0]}" if len(sizes) else "No case that both survive"
    if len(ends) > 1:
        words = f"{most[0]} below {ends[0][1]:g}, {most[-1]} from {ends[-1][0]:g} on"
        title = f"Errors grow with the sensitivity S: up to {words}"
    drawing.suptitle(title, fontsize=12)
    return drawing


def _boxes(axes: Axes, cases: pd.DataFrame, sources: list[str]) -> None:
    rows(axes, [name_of(source) for source in sources], 10.0)
    for place, source in enumerate(sources):
        size = cases.loc[cases["source"] == source, "size"].clip(lower=LOWEST)
        if len(size):
            colour = style_of(source).colour
            axes.boxplot(
                size, positions=[place], orientation="horizontal", widths=0.55, whis=(0, 100),
                patch_artist=True, manage_ticks=False, medianprops={"color": "black"},
                boxprops={"facecolor": colour, "alpha": 0.6, "edgecolor": colour},
                whiskerprops={"color": colour}, capprops={"color": colour},
            )  # fmt: skip


def draw_estimates(lines: pd.DataFrame) -> Figure:
    """Draw the part of each source's errors within a multiple of its estimates, by preset."""
    presets = lines["source"].map(preset_of)
    names = in_order(presets)
    drawing, grid = panels(len(names), len(names), (3.4, 3.6), 0.6, sharex=True, sharey=True)
    bounded: list[float] = []
    for axes, preset in zip(grid, names, strict=True):
        bounded += _parts(axes, lines[presets == preset])
        axes.set(xscale="log", xlim=(LEAST, MOST), ylim=(-0.02, 1.02))
        axes.set_title(in_words(preset), fontsize=9)
        axes.set_xlabel("times the difference to half the step")
        axes.grid(alpha=0.25)
    grid[0].set_ylabel("part of the errors that are smaller")
    if bounded:
        ends = " to ".join(dict.fromkeys((part(min(bounded)), part(max(bounded)))))
        words = f"bounds {ends} of an engine's errors"
        title = f"{MARKED:g} times the difference to half the step {words}"
        drawing.suptitle(title, fontsize=11)
    return drawing


def _parts(axes: Axes, lines: pd.DataFrame) -> list[float]:
    """Draw a line for each source, named in the order of the parts that MARKED bounds: these."""
    names = []
    for factor in (1.0, MARKED):
        axes.axvline(factor, color="#999999", linewidth=0.8, linestyle=":")
    for source, cases in lines.groupby("source", sort=False):
        over = np.sort(cases["over"].dropna().to_numpy())
        if len(over):
            colour = style_of(str(source)).colour
            parts = np.arange(len(over) + 1) / len(over)
            axes.step([LEAST, *np.maximum(over, LEAST)], parts, where="post", color=colour)
            within = float((over <= MARKED).mean())
            names.append((within, f"{title_of(str(source))} {part(within)}", colour))
    # under the lines, which all end above
    for place, (_, name, colour) in enumerate(sorted(names)):
        axes.text(0.96, 0.04 + 0.062 * place, name, transform=axes.transAxes, ha="right",
                  color=colour, fontsize=9)  # fmt: skip
    return [within for within, _, _ in names]
