"""The place of an engine on the diagram of error against run time."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.drawing.kept import Pictures
from studies.drawing.labels import Name, beside
from studies.drawing.styles import LOWEST, Style
from studies.measures.finer import joint
from studies.measures.words import listed
from studies.precision.choices import engines_of
from studies.precision.figure import called, style_of
from studies.score.report import ladder, published, table_of
from studies.stability.figure import draw_matrix

BACKGROUND = "#b5b5b5"
"""Colour of the published engines."""
WRONG = 10.0
"""Where settings that fail or get an outcome wrong are drawn."""


def draw_score(along: pd.DataFrame, published: pd.DataFrame) -> Figure:
    """Draw the largest error over all cases against the run time of a case.

    Parameters
    ----------
    along, published : DataFrame
        The columns of work-precision.csv, of the engine and of the published ones.
    """
    drawing = Figure(figsize=(9.0, 5.4), layout="constrained")
    axes = drawing.subplots()
    axes.set(xscale="log", yscale="log", ylim=(1e-8, 30.0))
    mine, others = joint(along), joint(engines_of(published))
    others = others[~others["method"].isin(mine["method"])]
    grey = Style(BACKGROUND, "-", ".", 0.9)
    names = [
        _line(axes, str(name), line, grey if lines is others else style_of(str(name)))
        for lines in (others, mine)
        for name, line in lines[lines["wall_s"] > 0.0].groupby("method", sort=False)
    ]
    axes.axhspan(3.0, 30.0, color="#eeeeee", zorder=-1)
    failed = "failed, or a wrong outcome"
    if untimed := sorted(set(mine["method"]) - set(mine.loc[mine["wall_s"] > 0.0, "method"])):
        failed += f"; without a run time: {listed([*map(called, untimed)])}"
    axes.text(0.01, 0.985, failed, va="top", fontsize=8, color="#666666", transform=axes.transAxes)
    axes.set_xlabel("run time of a case, set-up apart  [s]")
    counts = dict.fromkeys(f"{lines['cases'].max()}" for lines in (mine, others) if len(lines))
    axes.set_ylabel(f"largest relative error of the peak, {' (grey: '.join(counts)} cases"
                    f"{')' * (len(counts) - 1)}  [–]")  # fmt: skip
    axes.set_title("Error against run time along the step; grey: the published engines")
    axes.grid(alpha=0.25)
    beside(axes, names)
    return drawing


def _line(axes: Axes, name: str, line: pd.DataFrame, style: Style) -> Name:
    right = (line["failed"] == 0) & np.isfinite(line["max_error"])
    error = line["max_error"].where(right, WRONG).clip(lower=LOWEST)
    colour = "#777777" if style.colour == BACKGROUND else style.colour
    look = {**style.points(), "linestyle": style.line or "none", "linewidth": style.width}
    axes.plot(line["wall_s"], error, **look)
    last = int(np.argmax(line["wall_s"]))
    return Name(called(name), float(line["wall_s"].iloc[last]), float(error.iloc[last]), colour)


def pictures(folder: Path) -> Pictures:
    """Draw the error-time diagram and the matrix of extremes, from the tables alone."""
    return {
        "score": draw_score(ladder(folder), published()),
        "extremes": draw_matrix(table_of(folder, "extremes")),
    }
