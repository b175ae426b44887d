"""The map of validity drawn, with the engines' verdicts on it and their slips under it."""

import math

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from studies.drawing.styles import style_of

VERDICTS = {
    "held": "#ffffff",
    "lifted off": "#F0E442",
    "slid": "#56B4E9",
    "slid and lifted off": "#E69F00",
    "slid away": "#D55E00",
    "flew off": "#CC79A7",
    "failed": "#000000",
}
"""Verdict -> colour of its marker."""

LEAST = -2.0
"""Normal force over weight at the foot of the colours."""

SMALLEST_SLIP = 1e-9


def draw_validity(table: pd.DataFrame, beside: pd.DataFrame) -> Figure:
    """Draw the smallest normal force over amplitude and frequency, a panel for each H/B.

    Parameters
    ----------
    table, beside : DataFrame
        map.csv and compared.csv.
    """
    aspects = sorted(table["aspect"].unique())
    sources = list(beside["source"].unique())
    drawing = Figure(figsize=(3.7 * len(aspects), 8.2), layout="constrained")
    top, foot = drawing.subplots(2, len(aspects), squeeze=False, height_ratios=(1.25, 1.0))
    for column, (aspect, upper, lower) in enumerate(zip(aspects, top, foot, strict=True)):
        here = beside[beside["aspect"] == aspect]
        shades = _map(upper, table[table["aspect"] == aspect])
        _verdicts(upper, here[here["friction_factor"].isna()], sources)
        upper.set_title(f"H/B = {aspect:g}", fontsize=11)
        _slips(lower, here[here["friction_factor"].notna()], sources)
        if column == 0:
            upper.set_ylabel("amplitude  a_p / (g tan α)  [–]")
            lower.set_ylabel("slide of the pivot over B  [–]")
    drawing.colorbar(shades, ax=list(top), label="smallest normal force  N/mg  [–]", shrink=0.9)
    drawing.suptitle(
        "Full-sine pulses. Above: the reference lifts off beyond the black line; dashed: it "
        "overturns; markers: what engines do.\nBelow: engines with a part of the friction that the "
        "reference needs.",
        fontsize=11,
    )
    drawing.legend(
        handles=_handles(sources, list(beside["verdict"].unique())),
        loc="outside lower center",
        ncols=5,
        frameon=False,
    )
    return drawing


def _map(axes: Axes, table: pd.DataFrame) -> QuadMesh:
    normal = table.pivot(index="onsets", columns="omega_over_p", values="min_normal")
    overturned = table.assign(over=(table["outcome"] == "overturned").astype(float)).pivot(
        index="onsets", columns="omega_over_p", values="over"
    )
    x, y = normal.columns.to_numpy(float), normal.index.to_numpy(float)
    shades = axes.pcolormesh(
        x, y, normal.to_numpy(), cmap="RdBu", vmin=LEAST, vmax=-LEAST, shading="nearest"
    )
    axes.contour(x, y, normal.to_numpy(), levels=[0.0], colors="black", linewidths=2.0)
    axes.contour(
        x, y, overturned.to_numpy(), levels=[0.5], colors="#444444", linewidths=1, linestyles="--"
    )
    axes.set(xscale="log", yscale="log", xlabel="frequency  ω/p  [–]")
    axes.xaxis.set_ticks([0.5, 1, 2, 4, 8], ["0.5", "1", "2", "4", "8"])
    axes.yaxis.set_ticks([1.2, 1.6, 2.4, 3.6, 5.4], ["1.2", "1.6", "2.4", "3.6", "5.4"])
    for scale in (axes.xaxis, axes.yaxis):
        scale.set_ticks([], minor=True)
    return shades


def _verdicts(axes: Axes, rows: pd.DataFrame, sources: list[str]) -> None:
    for number, source in enumerate(sources):
        beside = 1.0 + 0.11 * (number - 0.5 * (len(sources) - 1))
        for verdict, group in rows[rows["source"] == source].groupby("verdict"):
            axes.plot(
                beside * group["omega_over_p"],
                group["onsets"],
                linestyle="none",
                marker=style_of(source).marker or "D",
                markersize=6.5,
                markerfacecolor=VERDICTS[str(verdict)],
                markeredgecolor="black",
                markeredgewidth=0.8,
            )


def _slips(axes: Axes, rows: pd.DataFrame, sources: list[str]) -> None:
    for number, source in enumerate(sources):
        group = rows[rows["source"] == source]
        beside = 1.0 + 0.012 * (number - 0.5 * (len(sources) - 1))
        gone = group["verdict"].isin(["slid away", "flew off"])
        slip = group["slip_widths"].clip(lower=SMALLEST_SLIP).mask(gone, 0.2)
        axes.plot(
            beside * group["friction_factor"],
            slip,
            linestyle="none",
            marker=style_of(source).marker or "D",
            markersize=4.5,
            markerfacecolor="none",
            color=style_of(source).colour,
        )
    axes.axvline(1.0, color="#999999", linewidth=1.0)
    axes.set(yscale="log", xlabel="friction / friction needed  [–]")
    axes.set_ylim(0.5 * SMALLEST_SLIP, 0.5)
    ticks = 10.0 ** np.arange(round(math.log10(SMALLEST_SLIP)), -2, 2)
    axes.yaxis.set_ticks([*ticks, 0.2], [f"$10^{{{math.log10(t):.0f}}}$" for t in ticks] + ["away"])
    axes.yaxis.set_ticks([], minor=True)
    axes.grid(alpha=0.25)


def _handles(sources: list[str], verdicts: list[str]) -> list[Line2D]:
    engines = [
        Line2D([], [], linestyle="none", marker=style_of(source).marker or "D", label=source,
               color=style_of(source).colour, markerfacecolor="none")
        for source in sources
    ]  # fmt: skip
    seen = [
        Line2D([], [], linestyle="none", marker="s", label=verdict, markersize=8,
               markerfacecolor=VERDICTS[verdict], markeredgecolor="black")
        for verdict in VERDICTS
        if verdict in verdicts
    ]  # fmt: skip
    return engines + seen
