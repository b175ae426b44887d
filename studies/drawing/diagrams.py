"""Diagrams of errors: against conditioning, their distribution, of free rocking, of omissions."""

import math
from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.drawing.labels import Name, beside
from studies.drawing.styles import LOWEST, line_of, style_of
from studies.measures.differences import scientific, sensitivity_of

NAMED = {"000": "housner", "100": "onset-matched", "111": "modified"}
"""Variants of a linearization that have a name."""
ONSETS = {"0": ("#D55E00", "lifts at g α"), "1": ("#0072B2", "lifts at g tan α")}
"""What a variant takes as the onset -> its colour, and what that is."""

NAMED_AT = 0.9
"""Part of the cases at which a line is named: at its end, the worst case, lines lie together."""


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


def draw_distributions(quantiles: pd.DataFrame, titles: Mapping[str, str]) -> Figure:
    """Draw by how much a part of the cases errs at most, a panel for each grid.

    The colour of a line is its onset, its dash its frequency, its width its saddle.

    Parameters
    ----------
    quantiles : DataFrame
        Columns grid, changed, quantile, error.
    titles : mapping
        Names of the lines by `changed`.
    """
    grids = list(quantiles["grid"].unique())
    drawing = Figure(figsize=(9.4, 5.2), layout="constrained")
    panels = drawing.subplots(1, len(grids), sharex=True, sharey=True, squeeze=False)[0]
    for axes, name in zip(panels, grids, strict=True):
        part = quantiles[quantiles["grid"] == name]
        ends = [
            _one_variant(axes, str(changed), rows, titles[str(changed)])
            for changed, rows in part.groupby("changed", sort=False)
        ]
        axes.set(yscale="log", xlim=(0.0, 1.0), ylim=(1e-4, 1e1), title=f"{name} grid")
        axes.set_xlabel("part of the surviving cases  [–]")
        axes.grid(alpha=0.25)
    for key, (colour, words) in ONSETS.items():
        panels[0].text(0.97, 0.1 - 0.05 * int(key), words, color=colour, ha="right",
                       transform=panels[0].transAxes)  # fmt: skip
    beside(panels[-1], ends)
    panels[0].set_ylabel("relative error of the peak, at most  [–]")
    return drawing


def _one_variant(axes: Axes, changed: str, rows: pd.DataFrame, title: str) -> Name:
    onset, frequency, saddle = tuple(changed)
    colour = ONSETS[onset][0]
    axes.plot(
        rows["quantile"],
        rows["error"],
        color=colour,
        linestyle=(0, (4, 2)) if frequency == "1" else "-",
        linewidth=0.9 + 0.9 * (changed in NAMED),
        alpha=1.0 if saddle == "0" or changed in NAMED else 0.6,
    )
    # the onset is the colour
    words = title.partition(", ")[2].partition(" (")[0]
    name = f"{NAMED[changed]}: {words}" if changed in NAMED else words
    named = rows[rows["quantile"] <= NAMED_AT].sort_values("quantile").iloc[-1]
    return Name(name, float(named["quantile"]), float(named["error"]), colour)


def draw_free(rows: pd.DataFrame) -> Figure:
    """Draw the errors of period and decay and the drift over the tilt, a line for each source.

    Parameters
    ----------
    rows : DataFrame
        The columns of free.csv.
    """
    drawing = Figure(figsize=(9.2, 4.2), layout="constrained")
    panels = drawing.subplots(1, 3, sharex=True, sharey=True)
    titles = {
        "period_error": "time between two impacts",
        "decay_error": "rotation after an impact",
        "drift_p": "drift over 20 impacts  [1/p]",
    }
    for axes, (column, title) in zip(panels, titles.items(), strict=True):
        ends = []
        for source, part in rows.groupby("source", sort=False):
            style = style_of(str(source))
            worst = part[column].abs().groupby(part["tilt"]).max().clip(lower=LOWEST)
            look = {**style.points(), "linestyle": line_of(str(source)), "linewidth": style.width}
            axes.plot(worst.index, worst, **look)
            ends.append(Name(str(source), worst.index[-1], float(worst.iloc[-1]), style.colour))
        axes.set(yscale="log")
        axes.set_title(title, fontsize=10)
        axes.set_xlabel("released from  θ0/α  [–]")
        axes.grid(alpha=0.25)
    panels[0].set_ylabel("error, relative but for the drift")
    beside(panels[-1], ends)
    drawing.suptitle("Off from the closed form of each one's equations, the largest over all H/B",
                     fontsize=11)  # fmt: skip
    return drawing


def draw_scenes(scenes: pd.DataFrame) -> Figure:
    """Draw what each thing put back into a scene costs and changes, a dot for each engine.

    Parameters
    ----------
    scenes : DataFrame
        The columns of scenes.csv.
    """
    names = list(scenes["scene"].unique())
    engines = list(scenes["engine"].unique())
    drawing = Figure(figsize=(9.6, 1.4 + 0.4 * len(names)), layout="constrained")
    costs, errors = drawing.subplots(1, 2, sharey=True)
    for number, engine in enumerate(engines):
        rows = scenes[scenes["engine"] == engine].set_index("scene").loc[names]
        places = np.arange(len(names)) + 0.7 * ((number + 0.5) / len(engines) - 0.5)
        # what an engine has not takes no time
        taken, look = rows["wall_s"].where(rows["error"].notna()), style_of(engine).points(6.5)
        factor = taken / taken.iloc[0]
        costs.hlines(places, 1.0, factor, color=look["color"], linewidth=1.2)
        costs.plot(factor, places, **look)
        errors.plot(rows["error"].abs().clip(lower=LOWEST), places, **look, label=engine)
    costs.set_yticks(range(len(names)), names)
    costs.invert_yaxis()
    costs.set(xscale="log", xlabel="run time over the scene as it is  [–]")
    costs.axvline(1.0, color="#555555", linewidth=0.8)
    costs.set_xticks([0.5, 1, 2, 5, 10, 20], ["½", "1", "2", "5", "10", "20"])
    costs.set_xticks([], minor=True)
    errors.set(xscale="log", xlabel="relative error of the peak  [–]")
    for axes in (costs, errors):
        axes.grid(alpha=0.25)
    drawing.legend(loc="outside lower center", ncols=len(engines), frameon=False)
    return drawing
