"""The map of validity drawn, with the engines' verdicts on it."""

from __future__ import annotations

from typing import Any

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


def draw_validity(table: pd.DataFrame, beside: pd.DataFrame) -> Figure:
    """Draw over amplitude and frequency where the reference holds, and what engines do there."""
    sources = list(beside["source"].unique())
    own = beside[beside["friction_factor"].isna()]
    aspects = sorted(table["aspect"].unique())
    drawing, grid = panels(len(aspects), 2, (4.3, 3.8), sharex=True, sharey=True)
    for aspect, axes in zip(aspects, grid, strict=True):
        axes.set_title(f"H/B = {aspect:g}", fontsize=11)
        axes.set(xlabel="frequency  ω/p  [–]", ylabel="amplitude  $a_p$ / (g tan α)  [–]")
        axes.label_outer()
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


def _whose(sources: list[str]) -> str:
    if len(sources) == 1:
        return f"symbols: {name_of(sources[0])}"
    names = ", ".join(map(name_of, sources))
    return f"black symbols: all alike; where they differ, from the left {names}"


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
