"""Median error of the peak against cases a second of batches."""

from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from studies.drawing.facets import dot, error_scale, key, preset_dots, sheet
from studies.measures.batches import EXACT, NAMES, WARP
from studies.measures.presets import look_of


def draw_batch(lines: pd.DataFrame) -> Figure:
    """Draw a line for each preset and way to step, over its steps, and name other sizes."""
    figure, (axes,) = sheet((9.0, 5.6))
    axes.set(xscale="log", yscale="log", xlabel="cases a second", ylim=(1e-5, 1.0))
    axes.set_ylabel("median relative error of the peak")
    usable = lines[(lines["backend"] != EXACT) & lines["median_error"].notna()]
    for (backend, preset), mine in usable.groupby(["backend", "preset"], sort=False):
        look: dict[str, Any] = {
            "color": look_of(str(preset)).colour,
            "marker": "s" if backend == WARP else "o",
        }
        along = mine[mine["worlds"] == mine["worlds"].mode().max()].sort_values("dt_ms")
        axes.plot(along["cases_per_s"], along["median_error"], **look)
        for line in mine.drop(along.index).query("runs == 1").to_dict("records"):
            place = line["cases_per_s"], line["median_error"]
            axes.plot(*place, fillstyle="none", **look)
            axes.annotate(
                f"{line['worlds']}", place, (0, 7), textcoords="offset points", ha="center"
            )
    for line in lines[lines["backend"] == EXACT].to_dict("records"):
        axes.axvline(line["cases_per_s"], color="black", linewidth=2.0)
        axes.annotate("exact solution ", (line["cases_per_s"], 1.3e-5), ha="right")
    error_scale(axes.yaxis, 1e-5, 1.0, 1)
    axes.grid(alpha=0.25)
    ways = [dot(NAMES[name], "s" if name == WARP else "o") for name in usable["backend"].unique()]
    key(figure, [*ways, *preset_dots(usable["preset"].unique())])
    return figure
