"""The error of every case against how far small errors move its peak."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from studies.drawing.labels import Name, beside
from studies.drawing.styles import LOWEST, style_of
from studies.measures.differences import scientific, sensitivity_of


def draw_conditioning(compared: pd.DataFrame) -> Figure:
    """Draw the error of every case against how far small errors move its peak.

    Parameters
    ----------
    compared : DataFrame
        The columns of errors.csv.
    """
    drawing = Figure(figsize=(8.6, 5.2), layout="constrained")
    axes = drawing.subplots()
    judged = sensitivity_of(compared)
    finite = judged[np.isfinite(judged)]
    ends = np.array([1.0, float(np.fmax(finite.max(), 10.0))])
    places = judged.clip(upper=1.1 * ends[1])
    bounds = []
    largest = (compared["error"].abs() / judged).groupby(compared["source"]).max()
    for source, bound in largest.sort_values(ascending=False, na_position="first").items():
        style, rows = style_of(str(source)), compared[compared["source"] == source]
        axes.plot(places[rows.index], rows["error"].abs().clip(lower=LOWEST), **style.points(3.0))
        if math.isnan(bound):
            continue
        axes.plot(ends, bound * ends, color=style.colour, linewidth=1.0, zorder=-1)
        words = f"{source}: none beyond {scientific(bound)} S"
        bounds.append(Name(words, float(ends[1]), bound * float(ends[1]), style.colour))
    axes.set(xscale="log", yscale="log", xlim=(0.8, 1.2 * ends[1]))
    edge = "; at the right edge an outcome changes" if np.isinf(judged).any() else ""
    axes.set_xlabel(
        "S, the larger of κ and the sensitivity: how many times as far as the pulse or η\n"
        f"the exact peak moves{edge}  [–]"
    )
    axes.set_ylabel("relative error of the peak  [–]")
    if bounds:
        axes.set_title("Errors of the peak grow with its sensitivity")
    else:
        axes.set(title="no case that both survive", ylim=(LOWEST, 1.0))
    axes.grid(alpha=0.25)
    beside(axes, bounds, 9.0)
    return drawing
