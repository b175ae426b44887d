"""One block and one pulse: who is on the exact solution, and who is not."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle

from analytic.block import RigidBlock
from studies.drawing.block import GROUND, INK, SOFT, outline
from studies.drawing.styles import engine_title, style_of, title_of
from studies.measures.presets import is_engine, preset_of, told
from studies.measures.words import power

MAGNIFIED = 2.5
"""How many times their size the rotations of the outlines are drawn."""

GHOST = "#c9c9c9"


def draw_hero(block: RigidBlock, samples: pd.DataFrame, lines: pd.DataFrame) -> Figure:
    """Draw the outlines at the exact solution's largest rotation, above all histories.

    Parameters
    ----------
    block : RigidBlock
    samples : DataFrame
        source, time_s, theta_ratio; one of the sources is "exact".
    lines : DataFrame
        source, outcome and error (relative, of the peak), one line each.
    """
    drawing = Figure(figsize=(10.0, 6.0), layout="constrained")
    upper, lower = drawing.subfigures(2, 1, squeeze=False, height_ratios=(1.0, 1.25))[:, 0]
    others = lines[lines["source"] != "exact"]
    exact = samples[samples["source"] == "exact"]
    instant = float(exact["time_s"].to_numpy()[np.argmax(exact["theta_ratio"].abs())])
    panels = upper.subplots(1, len(others), sharey=True)
    for axes, (_, line) in zip(panels, others.iterrows(), strict=True):
        source = str(line["source"])
        right, found = (_at(samples, name, instant) for name in ("exact", source))
        _outlines(axes, block, right, found, style_of(source).colour)
        axes.set_title(_title(line), fontsize=10, fontweight="bold")
        axes.text(
            0.5, -0.03, _verdict(line), transform=axes.transAxes, ha="center", va="top", fontsize=11
        )
    _histories(lower.subplots(), samples, lines, instant)
    return drawing


def _at(samples: pd.DataFrame, source: str, instant: float) -> float:
    """Return the rotation of a source over θcr at a time, the last one it has if that is before."""
    points = samples[samples["source"] == source]
    return float(np.interp(instant, points["time_s"], points["theta_ratio"]))


def _title(line: pd.Series[Any]) -> str:
    source = str(line["source"])
    if not is_engine(source):
        return "Housner's linearization" if source == "housner" else source
    return f"{engine_title(source)}, {told(preset_of(source)).short}"


def _verdict(line: pd.Series[Any]) -> str:
    if line["outcome"] != "rocked":
        return str(line["outcome"])
    error = float(line["error"])
    if abs(error) < 1e-3:
        return f"peak to {power(abs(error))}"
    return f"peak {error:+.0%}".replace("-", "−").replace("%", " %")


def _outlines(axes: Axes, block: RigidBlock, exact: float, found: float, colour: str) -> None:
    axes.set(xlim=(-1.15, 1.15), ylim=(-0.12, 1.75), aspect="equal")
    axes.set_axis_off()
    axes.add_patch(Rectangle((-1.15, -0.1), 2.3, 0.1, color=GROUND, linewidth=0))
    looks: list[tuple[float, dict[str, Any]]] = [
        (exact, {"facecolor": GHOST, "edgecolor": "#8a8a8a", "linewidth": 0.8}),
        (found, {"fill": False, "edgecolor": colour, "linewidth": 2.2}),
    ]
    for ratio, look in looks:
        theta = min(max(MAGNIFIED * ratio * block.alpha, -0.5 * math.pi), 0.5 * math.pi)
        axes.add_patch(Polygon(outline(block.width, block.height, theta), **look))


def _histories(axes: Axes, samples: pd.DataFrame, lines: pd.DataFrame, instant: float) -> None:
    for source in lines["source"]:
        points = samples[samples["source"] == source]
        axes.plot(points["time_s"], points["theta_ratio"], **_look(str(source)))
    limit = 1.15 * float(samples.loc[samples["source"] == "exact", "theta_ratio"].abs().max())
    top = max(limit, 0.62)
    axes.set(
        xlim=(0.0, float(samples["time_s"].max())),
        ylim=(-top, top),
        xlabel="time  [s]",
        ylabel="rotation  θ/θcr  [–]",
    )
    axes.axvline(instant, color=SOFT, linewidth=0.8, linestyle=(0, (2, 3)))
    words = f" outlines above: rotations drawn {MAGNIFIED:g} times as large; exact in grey"
    axes.text(instant, -0.95 * top, words, fontsize=8.5, color=SOFT)
    axes.axhline(0.0, color=INK, linewidth=0.6)
    axes.grid(alpha=0.2)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(loc="upper right", fontsize=9, frameon=False, ncols=3)


def _look(source: str) -> dict[str, Any]:
    """Return how a history is drawn: the exact one as a band on which landing steps lie."""
    style = style_of(source)
    engine, colon, _ = source.partition(":")
    if source == "exact":
        return {"color": GHOST, "linewidth": 7.0, "label": "exact", "zorder": 1}
    if colon:
        return {
            "color": style.colour,
            "linewidth": 1.6,
            "label": f"{title_of(engine)}, as documented",
        }
    if style.marker:
        return {
            "color": style.colour,
            "linestyle": "none",
            "marker": style.marker,
            "markersize": 5.0,
            "markerfacecolor": "none",
            "markevery": (0 if style.marker == "o" else 8, 16),
            "label": f"{title_of(engine)}, landing steps",
        }
    return {"color": style.colour, "linestyle": "--", "linewidth": 1.8, "label": "Housner"}
