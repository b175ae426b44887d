"""Blocks as outlines, and the picture of the front page."""

import math
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle

from analytic.block import RigidBlock
from analytic.motion import FloatArray
from engines.scene import System, layout_of
from studies.drawing.styles import full_name, style_of
from studies.kit.say import signed
from studies.measures.presets import is_engine, look_of, preset_of

INK, SOFT, GROUND, GHOST = "#1b1b1b", "#666666", "#d9d9d4", "#c9c9c9"
MAGNIFIED = 2.5
"""How many times their size the rotations of the outlines are drawn."""


def outlines(system: System, at: float) -> FloatArray:
    """Return the corners of every body of a system, shape (bodies, 4, 2) [m].

    `at` is its rotation [rad], or its place along the base [m] where nothing rocks.
    """
    corners = []
    for body in layout_of(system, 1.0, None, (at, 0.0)).bodies:
        x, z = 0.5 * body.width, 0.5 * body.height
        sine, cosine = math.sin(body.at.theta), math.cos(body.at.theta)
        box = np.array([[-x, -z], [x, -z], [x, z], [-x, z]])
        turned = box @ np.array([[cosine, -sine], [sine, cosine]])
        corners.append(turned + np.array([body.at.x, body.at.z]))
    return np.array(corners)


def draw_hero(block: RigidBlock, samples: pd.DataFrame, lines: pd.DataFrame) -> Figure:
    """Draw the outlines at the exact solution's largest rotation, above all histories."""
    drawing = Figure(figsize=(10.0, 6.0), layout="constrained")
    upper, lower = drawing.subfigures(2, 1, squeeze=False, height_ratios=(1.0, 1.25))[:, 0]
    wide = samples.pivot(index="time_s", columns="source", values="theta_ratio")
    instant = wide.index[int(wide["exact"].abs().to_numpy().argmax())]
    at: dict[str, float] = wide.ffill().loc[instant].to_dict()
    others = lines[lines["source"] != "exact"].to_dict("records")
    for axes, line in zip(upper.subplots(1, len(others), sharey=True), others, strict=True):
        source, colour = line["source"], style_of(line["source"]).colour
        axes.set(xlim=(-1.15, 1.15), ylim=(-0.12, 1.75), aspect="equal")
        axes.set_axis_off()
        axes.add_patch(Rectangle((-1.15, -0.1), 2.3, 0.1, color=GROUND, linewidth=0))
        looks: list[tuple[float, dict[str, Any]]] = [
            (at["exact"], {"facecolor": GHOST, "edgecolor": "#8a8a8a", "linewidth": 0.8}),
            (at[source], {"fill": False, "edgecolor": colour, "linewidth": 2.2}),
        ]
        for ratio, look in looks:
            theta = np.clip(MAGNIFIED * ratio * block.alpha, -0.5 * math.pi, 0.5 * math.pi)
            axes.add_patch(Polygon(outlines(block, float(theta))[0], **look))
        axes.set_title(_title(source), fontsize=10, fontweight="bold")
        axes.text(0.5, -0.03, _verdict(line), transform=axes.transAxes, ha="center", va="top",
                  fontsize=11)  # fmt: skip
    axes = lower.subplots()
    for source in samples["source"].unique():
        axes.plot(wide.index, wide[source], **_look(source))
    top = max(1.15 * float(wide["exact"].abs().max()), 0.62)
    axes.set(xlim=(0.0, wide.index.max()), ylim=(-top, top), xlabel="time  [s]",
             ylabel="rotation  θ/θcr  [–]")  # fmt: skip
    axes.axvline(instant, color=SOFT, linewidth=0.8, linestyle=(0, (2, 3)))
    words = f" outlines above: rotations drawn {MAGNIFIED:g} times as large; exact in grey"
    axes.text(instant, -0.95 * top, words, fontsize=8.5, color=SOFT)
    axes.axhline(0.0, color=INK, linewidth=0.6)
    axes.grid(alpha=0.2)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(loc="upper right", fontsize=9, frameon=False, ncols=3)
    return drawing


def _verdict(line: dict[Any, Any]) -> str:
    return f"peak {signed(line['error'])}" if line["outcome"] == "rocked" else str(line["outcome"])


def _title(source: str) -> str:
    """Return the name of a source on this picture, whose floors are all at rest."""
    if source == "housner":
        return "Housner's linearization"
    return full_name(source).removesuffix(", floor at rest")


def _look(source: str) -> dict[str, Any]:
    """Return how a history is drawn: the exact one as a band on which tuned ones lie."""
    look = {"color": style_of(source).colour, "linewidth": 1.7, "label": _title(source)}
    if source == "exact":
        return look | {"color": GHOST, "linewidth": 7.0, "label": "exact", "zorder": 1}
    if not is_engine(source):
        return look | {"linestyle": "--"}
    return look | {"linestyle": look_of(preset_of(source)).line}
