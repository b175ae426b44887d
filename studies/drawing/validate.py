"""Random cases: errors in bands of their sensitivity, and errors over the engines' estimates."""

from __future__ import annotations

from itertools import pairwise
from math import inf

import pandas as pd
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
        rows(axes, [name_of(source) for source in sources], 10.0)
        for source, size in cases.groupby("source")["size"]:
            look = {"color": style_of(str(source)).colour}
            axes.boxplot(
                size.clip(lower=LOWEST), positions=[sources.index(source)], widths=0.55,
                orientation="horizontal", whis=(0, 100), patch_artist=True, manage_ticks=False,
                medianprops={"color": "black"}, whiskerprops=look, capprops=look,
                boxprops={"facecolor": look["color"], "alpha": 0.6, "edgecolor": look["color"]},
            )  # fmt: skip
        words = f"from {start:g}" if end == inf else f"{start:g} to {end:g}" if start else "below 3"
        axes.set_title(f"S {words}: {cases['case'].nunique()} cases", fontsize=10)
    drawing.supxlabel(
        "relative error of the peak;  S: by how many per cent a peak moves for 1 % of the pulse "
        "or of an impact's velocity ratio",
        fontsize=10,
    )
    drawing.suptitle("Errors of the peak grow with the sensitivity S of a case", fontsize=12)
    return drawing


def draw_estimates(lines: pd.DataFrame) -> Figure:
    """Draw the part of each source's errors within a multiple of its estimates, by preset."""
    presets = lines["source"].map(preset_of)
    names = in_order(presets)
    drawing, grid = panels(len(names), len(names), (3.4, 3.6), 0.6, sharex=True, sharey=True)
    for axes, preset in zip(grid, names, strict=True):
        over = lines[presets == preset].dropna(subset="over").groupby("source")["over"]
        within = over.agg(lambda each: (each <= MARKED).mean()).sort_values(ascending=False)
        axes.vlines((1.0, MARKED), 0.0, 1.0, color="#999999", linewidth=0.8, linestyle=":")
        for source, share in within.items():
            label, colour = f"{title_of(str(source))} {part(share)}", style_of(str(source)).colour
            axes.ecdf(over.get_group(source).clip(LEAST), label=label, color=colour)
        axes.set(xscale="log", xlim=(LEAST, MOST), ylim=(-0.02, 1.02))
        axes.set_title(in_words(preset), fontsize=9)
        axes.set_xlabel("times the difference to half the step")
        axes.legend(loc="lower right", frameon=False, handlelength=0, labelcolor="linecolor",
                    fontsize=9)  # fmt: skip
        axes.grid(alpha=0.25)
    grid[0].set_ylabel("part of the errors that are smaller")
    title = (
        f"Errors within {MARKED:g} times the difference to half the step, in % beside each engine"
    )
    drawing.suptitle(title, fontsize=11)
    return drawing
