"""How many of the errors so many estimates bound: to the right of 10, an estimate is blind."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.drawing.labels import Name, beside
from studies.drawing.styles import style_of
from studies.measures.presets import engine_of, in_order, in_words, preset_of
from studies.measures.words import part

LEAST, MOST = 0.1, 1e4
"""Ends of the scale of factors."""

MARKED = 10.0
"""Factor at which engines are named, with the part of their errors that it bounds."""


def draw_estimates(lines: pd.DataFrame) -> Figure:
    """Draw the part of each source's errors within a multiple of its estimates, by preset.

    Parameters
    ----------
    lines : DataFrame
        The columns of estimates.csv.
    """
    presets = lines["source"].map(preset_of)
    names = in_order(presets)
    drawing = Figure(figsize=(4.3 * len(names), 4.2), layout="constrained")
    panels = drawing.subplots(1, len(names), sharex=True, sharey=True, squeeze=False)[0]
    named = [_panel(axes, lines[presets == name]) for axes, name in zip(panels, names, strict=True)]
    for axes, preset in zip(panels, names, strict=True):
        axes.set(xscale="log", xlim=(LEAST, MOST), ylim=(-0.02, 1.02))
        axes.set_title(in_words(preset), fontsize=9)
        axes.set_xlabel("times the difference to half the step")
        axes.grid(alpha=0.25)
    panels[0].set_ylabel("part of the errors that are smaller")
    drawing.suptitle(f"Named: the part within {MARKED:g} times the difference", fontsize=10)
    for axes, mine in zip(panels, named, strict=True):
        beside(axes, mine, 8.0)
    return drawing


def _panel(axes: Axes, lines: pd.DataFrame) -> list[Name]:
    """Draw a line for each source; return their names, at what ten estimates bound."""
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
            text = f"{engine_of(str(source))} {part(within)}"
            names.append(Name(text, MARKED, within, colour))
    return names
