"""Random cases: errors in bands of their sensitivity."""

from itertools import pairwise
from math import inf

import pandas as pd
from matplotlib.figure import Figure

from studies.drawing.facets import error_scale, panels, rows
from studies.drawing.styles import LOWEST, full_name, style_of
from studies.measures.differences import sensitivity_of

BANDS = (0.0, 3.0, 10.0, 100.0, inf)
"""Where bands of the sensitivity S end."""


def draw_conditioning(errors: pd.DataFrame) -> Figure:
    """Draw the errors of cases by how far small errors move their peaks."""
    sizes = errors.assign(s=sensitivity_of(errors), size=errors["error"].abs())
    sizes = sizes[sizes["size"].notna() & sizes["s"].notna()]
    sources = list(errors["source"].unique())
    bands = {ends: sizes[sizes["s"].between(*ends, inclusive="left")] for ends in pairwise(BANDS)}
    bands = {ends: cases for ends, cases in bands.items() if len(cases)} or {BANDS[:2]: sizes}
    each = (9.4 / len(bands), 0.9 + 0.32 * len(sources))
    drawing, grid = panels(len(bands), len(bands), each, 1.1, sharex=True, sharey=True)
    low, high = sizes["size"].clip(lower=LOWEST).agg(["min", "max"]).fillna(1.0)
    grid[0].set(xscale="log", xlim=(0.5 * low, 2.0 * max(high, 1.0)))
    error_scale(grid[0].xaxis, *grid[0].get_xlim())
    for axes, ((start, end), cases) in zip(grid, bands.items(), strict=True):
        rows(axes, [full_name(source) for source in sources], 10.0)
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
