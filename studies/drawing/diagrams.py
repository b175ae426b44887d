"""Diagrams of errors: against conditioning, their distribution, of free rocking, of omissions."""

from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from studies.drawing.figures import LOWEST, style_of
from studies.measures.differences import conditioning_of


def draw_conditioning(compared: pd.DataFrame) -> Figure:
    """Draw the error of every case against the condition number of its peak.

    Parameters
    ----------
    compared : DataFrame
        The columns of errors.csv.
    """
    drawing = Figure(figsize=(7.6, 5.2), layout="constrained")
    axes = drawing.subplots()
    kappa = conditioning_of(compared)
    for source, rows in compared.groupby("source", sort=False):
        style = style_of(str(source))
        axes.plot(
            kappa[rows.index],
            rows["error"].abs().clip(lower=LOWEST),
            linestyle="none",
            marker=style.marker or ".",
            markersize=4,
            markerfacecolor="none",
            color=style.colour,
            label=str(source),
        )
    axes.set(xscale="log", yscale="log")
    axes.set_xlabel("κ, the larger of |∂ln θmax/∂ln a_p| and |∂ln θmax/∂ln η|  [–]")
    axes.set_ylabel("relative error of the peak  [–]")
    slope = np.array([1.0, np.fmax(kappa.max(), 10.0)])
    for level in (1e-6, 1e-4):
        axes.plot(slope, level * slope, color="#999999", linewidth=0.8, zorder=-1)
        middle = float(np.sqrt(slope[1]))
        axes.annotate(
            f"{level:.0e} κ",
            (middle, 1.4 * level * middle),
            fontsize=8,
            color="#666666",
            ha="right",
        )
    errors = compared["error"].abs().dropna()
    if len(errors):
        axes.set_ylim(top=10.0 * max(float(errors.max()), LOWEST))
    else:
        axes.set_title("no case that both survive")
    axes.legend(loc="upper left", frameon=False)
    axes.grid(alpha=0.25)
    return drawing


def draw_distributions(quantiles: pd.DataFrame, titles: Mapping[str, str]) -> Figure:
    """Draw which part of the cases errs by less than what, a panel for each grid.

    Parameters
    ----------
    quantiles : DataFrame
        Columns grid, changed, quantile, error.
    titles : mapping
        Names of the lines by `changed`.
    """
    known = {"000": "housner", "100": "onset-matched", "111": "modified"}
    grids = list(quantiles["grid"].unique())
    drawing = Figure(figsize=(10.0, 5.6), layout="constrained")
    panels = drawing.subplots(1, len(grids), sharex=True, sharey=True, squeeze=False)[0]
    for axes, name in zip(panels, grids, strict=True):
        for changed, rows in quantiles[quantiles["grid"] == name].groupby("changed", sort=False):
            style = style_of(known.get(str(changed), ""))
            axes.plot(
                rows["error"],
                rows["quantile"],
                color=style.colour,
                linestyle=style.line or (0, (1 + int(str(changed)[1]) * 4, 2)),
                linewidth=2.0 if changed in known else 0.9,
                label=titles[str(changed)],
            )
        axes.set(xscale="log", xlim=(1e-4, 1e1), title=f"{name} grid")
        axes.set_xlabel("relative error of the peak  [–]")
        axes.grid(alpha=0.25)
    panels[0].set_ylabel("part of the surviving cases that errs by less  [–]")
    drawing.legend(
        *panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=2, frameon=False
    )
    return drawing


def draw_free(rows: pd.DataFrame) -> Figure:
    """Draw the errors of period and decay and the drift over the tilt, a line for each source.

    Parameters
    ----------
    rows : DataFrame
        The columns of free.csv.
    """
    drawing = Figure(figsize=(12.0, 4.6), layout="constrained")
    panels = drawing.subplots(1, 3, sharex=True, sharey=True)
    titles = {
        "period_error": "time between two impacts",
        "decay_error": "rotation after an impact",
        "drift_p": "drift over 20 impacts  [1/p]",
    }
    for axes, (column, title) in zip(panels, titles.items(), strict=True):
        for source, part in rows.groupby("source", sort=False):
            style = style_of(str(source))
            worst = part[column].abs().groupby(part["tilt"]).max().clip(lower=LOWEST)
            axes.plot(
                worst.index,
                worst,
                style.line or "-",
                color=style.colour,
                marker=style.marker or ".",
                linewidth=style.width if style.line else 0.8,
                markerfacecolor="none",
                label=str(source),
            )
        axes.set(yscale="log", title=title)
        axes.set_xlabel("rotation from which the block falls  θ0/α  [–]")
        axes.grid(alpha=0.25)
    panels[0].set_ylabel("largest error over H/B, relative but for the drift")
    drawing.legend(
        *panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=6, frameon=False
    )
    return drawing


def draw_scenes(scenes: pd.DataFrame) -> Figure:
    """Draw what each thing put back into a scene costs and changes, a colour for each engine.

    Parameters
    ----------
    scenes : DataFrame
        The columns of scenes.csv.
    """
    names = list(scenes["scene"].unique())
    engines = list(scenes["engine"].unique())
    drawing = Figure(figsize=(9.6, 1.4 + 0.45 * len(names)), layout="constrained")
    costs, errors = drawing.subplots(1, 2, sharey=True)
    thick = 0.8 / len(engines)
    for number, engine in enumerate(engines):
        rows = scenes[scenes["engine"] == engine].set_index("scene").loc[names]
        places = np.arange(len(names)) + (number - 0.5 * (len(engines) - 1)) * thick
        colour = style_of(engine).colour
        costs.barh(places, rows["wall_s"] / rows["wall_s"].iloc[0], thick, color=colour)
        errors.barh(places, rows["error"].abs(), thick, color=colour, label=engine)
    costs.set_yticks(range(len(names)), names)
    costs.invert_yaxis()
    costs.set_xscale("log")
    costs.axvline(1.0, color="#555555", linewidth=0.8)
    costs.set_xlabel("run time over the scene as it is  [–]")
    errors.set_xscale("log")
    errors.set_xlabel("relative error of the peak  [–]")
    drawing.legend(loc="outside lower center", ncols=len(engines), frameon=False)
    return drawing
