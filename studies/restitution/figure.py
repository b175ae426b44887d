"""What comes out of a coefficient of restitution against what is wanted."""

import math

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from studies.drawing.labels import Name, beside
from studies.drawing.styles import engine_style

ACROSS = 3
"""Panels in a row."""
TOP = 1.35
"""Upper end of the scale; what is beyond, or broken, stands there as a cross."""


def draw_restitution(rows: pd.DataFrame) -> Figure:
    """Draw what is found against what is wanted, a panel for each way to ask for it.

    Parameters
    ----------
    rows : DataFrame
        The columns of restitution.csv.
    """
    engines = list(rows["engine"].unique())
    ways = [list(rows.loc[rows["engine"] == engine, "way"].unique()) for engine in engines]
    downs = [math.ceil(len(mine) / ACROSS) for mine in ways]
    drawing = Figure(figsize=(8.8, 2.7 * sum(downs) + 0.5), layout="constrained")
    grid = drawing.subplots(sum(downs), ACROSS, sharex=True, sharey=True, squeeze=False)
    for axes in grid.flat:
        axes.set_axis_off()
    for first, engine, mine in zip(np.cumsum([0, *downs[:-1]]), engines, ways, strict=True):
        panels = list(grid[first:].flat)[: len(mine)]
        for axes, way in zip(panels, mine, strict=True):
            axes.set_axis_on()
            group = rows[(rows["engine"] == engine) & (rows["way"] == way)]
            names = _panel(axes, group, engine_style(engine, "").colour)
            axes.set_title(way, fontsize=9)
            axes.tick_params(labelbottom=True)
        for axes in panels[::ACROSS]:
            axes.set_ylabel(f"{engine}\nspeed after over before")
        for axes in panels[-ACROSS:]:
            axes.set_xlabel("coefficient that is wanted")
        beside(panels[-1], names, 8.5)
    return drawing


def _panel(axes: Axes, group: pd.DataFrame, colour: str) -> list[Name]:
    """Draw the band over where an impact falls in a step, and lines of what is varied."""
    axes.plot([0.0, 1.0], [0.0, 1.0], color="#777777", linewidth=0.8)
    base = group[group["varied"] == ""].groupby("wanted")["speed_ratio"]
    axes.fill_between(
        base.min().index, base.min(), base.max(), color=colour, alpha=0.35, linewidth=0.0
    )
    ended = base.median().dropna()
    names = [Name("1 ms, 1 m/s", float(ended.index[-1]), float(ended.iloc[-1]), colour)]
    varied = {"dt_s": ("dt_s", "s", "--"), "speed": ("speed_m_s", "m/s", ":")}
    shades = colormaps["Greys"]
    for name, (column, unit, line) in varied.items():
        for place, (value, rows) in enumerate(group[group["varied"] == name].groupby(column)):
            found = rows.groupby("wanted")["speed_ratio"].median()
            shown = found.where(found < TOP)
            shade = to_hex(shades(0.55 + 0.35 * place))
            axes.plot(shown.index, shown, color=shade, linestyle=line, linewidth=1.1)
            lost = found[~(found < TOP)]
            axes.plot(lost.index, [TOP - 0.05] * len(lost), "x", color=shade, markersize=5)
            last = shown.dropna()
            if len(last):
                text = f"{float(str(value)):.2g} {unit}"
                names.append(Name(text, float(last.index[-1]), float(last.iloc[-1]), shade))
    axes.set(xlim=(-0.03, 1.03), ylim=(-0.05, TOP))
    axes.grid(alpha=0.25)
    return names
