"""How many of the errors so many estimates bound: to the right of 10, an estimate is blind."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.drawing.styles import engine_title, style_of
from studies.estimate.study import CALIBRATE
from studies.measures.presets import in_order, in_words, preset_of
from studies.measures.words import alike, part

LEAST, MOST = 0.1, 1e4
"""Ends of the scale of factors."""

MARKED = 10.0
"""Factor at which engines are named, with the part of their errors that it bounds."""

LINE = 0.062
"""Distance of two names over the height of a panel."""


def draw_estimates(lines: pd.DataFrame) -> Figure:
    """Draw the part of each source's errors within a multiple of its estimates, by preset.

    Of the cases that calibrate.
    """
    lines = lines[lines["set"] == CALIBRATE]
    presets = lines["source"].map(preset_of)
    names = in_order(presets)
    drawing = Figure(figsize=(3.2 * len(names) + 0.6, 4.2), layout="constrained")
    panels = drawing.subplots(1, len(names), sharex=True, sharey=True, squeeze=False)[0]
    bounded: list[float] = []
    for axes, preset in zip(panels, names, strict=True):
        bounded += _panel(axes, lines[presets == preset])
        axes.set(xscale="log", xlim=(LEAST, MOST), ylim=(-0.02, 1.02))
        axes.set_title(in_words(preset), fontsize=9)
        axes.set_xlabel("times the difference to half the step")
        axes.grid(alpha=0.25)
    panels[0].set_ylabel("part of the errors that are smaller")
    found = alike([part(end(bounded, default=math.nan)) for end in (min, max)], "to")
    title = f"{MARKED:g} times the difference to half the step bounds {found} of an engine's errors"
    drawing.suptitle(title, fontsize=11)
    return drawing


def _panel(axes: Axes, lines: pd.DataFrame) -> list[float]:
    """Draw a line for each source, named in the order of the parts that MARKED bounds: these."""
    names = []
    for factor in (1.0, MARKED):
        axes.axvline(factor, color="#999999", linewidth=0.8, linestyle=":")
    for source, rows in lines.groupby("source", sort=False):
        over = np.sort(rows["over"].dropna().to_numpy())
        if len(over):
            colour = style_of(str(source)).colour
            parts = np.arange(len(over) + 1) / len(over)
            axes.step([LEAST, *np.maximum(over, LEAST)], parts, where="post", color=colour)
            within = float((over <= MARKED).mean())
            names.append((within, f"{engine_title(str(source))} {part(within)}", colour))
    # under the lines, which all end above
    for place, (_, name, colour) in enumerate(sorted(names)):
        axes.text(0.96, 0.04 + LINE * place, name, transform=axes.transAxes, ha="right",
                  color=colour, fontsize=9)  # fmt: skip
    return [within for within, _, _ in names]
