"""The map of validity drawn, with the engines' verdicts on it and their slips under it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from studies.drawing.facets import dot, key, panels
from studies.drawing.styles import name_of, style_of

SYMBOLS = {
    "held": "•",
    "lifted off": "↑",
    "slid": "→",
    "slid and lifted off": "↗",
    "slid away": "»",
    "flew off": "⇑",
    "failed": "✕",
}
"""Verdict -> its symbol."""

HOLDS, ENDS = "#e8f0f5", "#f4d3bd"
"""Colours of where the reference is valid, and of where its pivot would need to be pulled."""

SMALLEST_SLIP = 1e-9


def draw_validity(table: pd.DataFrame, beside: pd.DataFrame) -> Figure:
    """Draw over amplitude and frequency where the reference holds, and what engines do there.

    Parameters
    ----------
    table, beside : DataFrame
        map.csv and compared.csv.
    """
    sources = list(beside["source"].unique())
    own = beside[beside["friction_factor"].isna()]
    names = ("frequency  ω/p  [–]", "amplitude  $a_p$ / (g tan α)  [–]")
    drawing, by_aspect = _panels(table["aspect"], 3.8, *names)
    for aspect, axes in by_aspect.items():
        _map(axes, table[table["aspect"] == aspect])
        _verdicts(axes, own[own["aspect"] == aspect], sources)
    drawing.suptitle(
        "Full-sine pulses: where the reference holds, and what engines do", fontsize=11
    )
    handles = [
        Patch(facecolor=HOLDS, edgecolor="#888888", label="the reference holds"),
        Patch(facecolor=ENDS, edgecolor="#888888", label="its pivot would lift off"),
        Line2D([], [], color="#444444", linestyle="--", linewidth=1.0, label="it overturns"),
        *(
            dot(verdict, f"${symbol}$", "black", markersize=9 if verdict != "held" else 5)
            for verdict, symbol in SYMBOLS.items()
            if verdict in set(own["verdict"])
        ),
    ]
    key(drawing, handles, 4, title=_whose(sources), title_fontsize=9)
    return drawing


def _panels(
    aspects: pd.Series[float], height: float, along: str, up: str
) -> tuple[Figure, dict[float, Axes]]:
    """Return a figure with a panel for each H/B, two in a row, of a height [in] and two axes."""
    each = sorted(aspects.unique())
    drawing, grid = panels(len(each), 2, (4.3, height), sharex=True, sharey=True)
    for axes, aspect in zip(grid, each, strict=True):
        axes.set_title(f"H/B = {aspect:g}", fontsize=11)
        axes.set(xlabel=along, ylabel=up)
        axes.label_outer()
    return drawing, dict(zip(each, grid, strict=True))


def _whose(sources: list[str]) -> str:
    if len(sources) == 1:
        return f"symbols: {name_of(sources[0])}"
    names = ", ".join(map(name_of, sources))
    return f"black symbols: all alike; where they differ, from the left {names}"


def draw_friction(beside: pd.DataFrame) -> Figure:
    """Draw how far pivots slide under a part of the friction that the reference needs.

    Parameters
    ----------
    beside : DataFrame
        compared.csv.
    """
    sources = list(beside["source"].unique())
    rows = beside[beside["friction_factor"].notna()]
    names = ("friction / friction needed  [–]", "slide of the pivot over B  [–]")
    drawing, by_aspect = _panels(beside["aspect"], 3.2, *names)
    for aspect, axes in by_aspect.items():
        _slips(axes, rows[rows["aspect"] == aspect], sources)
    drawing.suptitle("Below the friction that the reference needs pivots slide", fontsize=11)
    handles = [
        Line2D([], [], **style_of(name).points(6.0), label=name_of(name)) for name in sources
    ]
    key(drawing, handles, len(sources), fontsize=10)
    return drawing


def _map(axes: Axes, table: pd.DataFrame) -> None:
    normal = table.pivot(index="onsets", columns="omega_over_p", values="min_normal")
    overturned = table.assign(over=(table["outcome"] == "overturned").astype(float)).pivot(
        index="onsets", columns="omega_over_p", values="over"
    )
    x, y = normal.columns.to_numpy(float), normal.index.to_numpy(float)
    values = normal.to_numpy()
    ends = [min(float(values.min()), -1.0), 0.0, max(float(values.max()), 1.0)]
    axes.contourf(x, y, values, levels=ends, colors=[ENDS, HOLDS])
    axes.contour(x, y, values, levels=[0.0], colors="black", linewidths=1.5)
    axes.contour(
        x, y, overturned.to_numpy(), levels=[0.5], colors="#444444", linewidths=1, linestyles="--"
    )
    axes.set(xscale="log", yscale="log")
    axes.xaxis.set_ticks([0.5, 1, 2, 4, 8], ["0.5", "1", "2", "4", "8"])
    axes.yaxis.set_ticks([1.2, 1.6, 2.4, 3.6, 5.4], ["1.2", "1.6", "2.4", "3.6", "5.4"])
    for scale in (axes.xaxis, axes.yaxis):
        scale.set_ticks([], minor=True)


def _verdicts(axes: Axes, rows: pd.DataFrame, sources: list[str]) -> None:
    """Write one symbol where all engines do the same, and one of each side by side elsewhere."""
    style: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": 12}
    for _, here in rows.groupby(["omega_over_p", "onsets"]):
        x, y = (float(here[name].iloc[0]) for name in ("omega_over_p", "onsets"))
        found = here.set_index("source")["verdict"]
        if found.nunique() == 1:
            axes.text(x, y, SYMBOLS[str(found.iloc[0])], color="black", **style)
            continue
        for number, source in enumerate(name for name in sources if name in found):
            place = x * 1.16 ** (number - 0.5 * (len(found) - 1))
            symbol = SYMBOLS[str(found[source])]
            axes.text(place, y, symbol, color=style_of(source).colour, fontweight="bold", **style)


def _slips(axes: Axes, rows: pd.DataFrame, sources: list[str]) -> None:
    for number, source in enumerate(sources):
        group = rows[rows["source"] == source]
        beside = 1.0 + 0.012 * (number - 0.5 * (len(sources) - 1))
        gone = group["verdict"].isin(["slid away", "flew off"])
        slip = group["slip_widths"].clip(lower=SMALLEST_SLIP).mask(gone, 0.2)
        axes.plot(beside * group["friction_factor"], slip, **style_of(source).points())
    axes.axvline(1.0, color="#999999", linewidth=1.0)
    axes.set(yscale="log")
    axes.set_ylim(0.5 * SMALLEST_SLIP, 0.5)
    ticks = 10.0 ** np.arange(round(math.log10(SMALLEST_SLIP)), -2, 2)
    axes.yaxis.set_ticks([*ticks, 0.2], [f"$10^{{{math.log10(t):.0f}}}$" for t in ticks] + ["away"])
    axes.yaxis.set_ticks([], minor=True)
    axes.grid(alpha=0.25)
