"""The block with the names of its parts, blocks as outlines, and the picture of the front page."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, FancyArrowPatch, Polygon, Rectangle

from analytic.block import RigidBlock
from analytic.motion import FloatArray
from engines.layouts import System, layout_of
from studies.drawing.styles import engine_title, style_of, title_of
from studies.measures.presets import is_engine, preset_of, told
from studies.measures.words import signed

INK, SOFT, BLOCK, GROUND = "#1b1b1b", "#666666", "#cfe0ee", "#d9d9d4"


def outline(width: float, height: float, theta: float) -> FloatArray:
    """Return the corners of a block turned by `theta` [rad] about the corner that it stands on.

    The first row is that corner, at ±width/2 on the base. Positive rotations are clockwise.
    """
    side = 1.0 if theta >= 0.0 else -1.0
    pivot = np.array([side * 0.5 * width, 0.0])
    corners = np.array([[0.0, 0.0], [-side * width, 0.0], [-side * width, height], [0.0, height]])
    sine, cosine = math.sin(theta), math.cos(theta)
    turned: FloatArray = corners @ np.array([[cosine, -sine], [sine, cosine]]) + pivot
    return turned


def outlines(system: System, at: float) -> FloatArray:
    """Return the corners of every body of a system, shape (bodies, 4, 2) [m].

    Parameters
    ----------
    system : System
        One of those in `engines.layouts.LAYOUTS`.
    at : float
        Its rotation [rad], or its place along the base [m] where nothing rocks.
    """
    corners = []
    for body in layout_of(system, 1.0, None, (at, 0.0)).bodies:
        x, z = 0.5 * body.width, 0.5 * body.height
        sine, cosine = math.sin(body.at.theta), math.cos(body.at.theta)
        box = np.array([[-x, -z], [x, -z], [x, z], [-x, z]])
        turned = box @ np.array([[cosine, -sine], [sine, cosine]])
        corners.append(turned + np.array([body.at.x, body.at.z]))
    return np.array(corners)


def draw_block() -> Figure:
    """Draw a block that rocks to the right, with the names of its parts."""
    width, height, theta = 1.0, 2.2, 0.22  # in units of the drawing, and in rad
    drawing = Figure(figsize=(4.4, 4.6), layout="constrained")
    axes = drawing.subplots()
    axes.set(xlim=(-1.2, 1.75), ylim=(-0.5, 2.6), aspect="equal")
    axes.set_axis_off()
    axes.add_patch(Rectangle((-1.2, -0.16), 2.95, 0.16, color=GROUND, linewidth=0))
    at_rest = outline(width, height, 1e-12)
    axes.add_patch(Polygon(at_rest, fill=False, linestyle=(0, (4, 3)), edgecolor=SOFT))
    corners = outline(width, height, theta)
    axes.add_patch(Polygon(corners, facecolor=BLOCK, edgecolor=INK, linewidth=1.8))
    _dimensions(axes, corners)
    _angles(axes, corners, width, height, theta)
    axes.add_patch(_arrow((0.35, -0.36), (-0.55, -0.36), "-|>", INK, 2.0))
    axes.text(0.45, -0.36, "ü$_g$", va="center", fontsize=15)
    return drawing


def draw_scene(system: System, at: float) -> Figure:
    """Draw the bodies of a system where they are, and dashed where they are at rest.

    Parameters
    ----------
    system : System
    at : float
        As for `outlines`: rotation [rad], or place along the base [m] where nothing rocks.
    """
    rest, moved = outlines(system, 0.0), outlines(system, at)
    every = np.concatenate((rest, moved))
    (left, _), (right, top) = every.min(axis=(0, 1)), every.max(axis=(0, 1))
    spare = 0.12 * max(right - left, top)
    across, high = right - left + 2.0 * spare, top + 2.0 * spare
    inch = min(4.4 / across, 3.4 / high)
    drawing = Figure(figsize=(across * inch, 0.3 + high * inch), layout="constrained")
    axes = drawing.subplots()
    axes.set(xlim=(left - spare, right + spare), ylim=(-spare, top + spare), aspect="equal")
    axes.set_axis_off()
    ground = (left - spare, -0.5 * spare), across, 0.5 * spare
    axes.add_patch(Rectangle(*ground, color=GROUND, linewidth=0))
    for corners in moved:
        axes.add_patch(Polygon(corners, facecolor=BLOCK, edgecolor=INK, linewidth=1.8))
    for corners in rest:
        axes.add_patch(Polygon(corners, fill=False, linestyle=(0, (4, 3)), edgecolor=SOFT))
    return drawing


def _dimensions(axes: Axes, corners: FloatArray) -> None:
    pivot, foot, far, _ = corners
    centre = 0.5 * (pivot + far)
    for start, end, name in ((pivot, foot, "B"), (foot, far, "H")):
        middle = 0.5 * (start + end)
        outward = (middle - centre) / np.linalg.norm(middle - centre)
        shift = 0.12 * outward
        axes.add_patch(_arrow(start + shift, end + shift, "<|-|>", SOFT))
        x, y = middle + 0.3 * outward
        axes.text(x, y, name, ha="center", va="center", fontsize=15)


def _angles(axes: Axes, corners: FloatArray, width: float, height: float, theta: float) -> None:
    pivot, _, far, top = corners
    centre = 0.5 * (pivot + far)
    axes.plot(*np.array([pivot, centre]).T, color=INK, linewidth=1.4)
    axes.plot(*centre, "o", color=INK, markersize=5)
    x, y = 0.62 * centre + 0.38 * pivot
    axes.text(x - 0.15, y, "R", fontsize=15, va="center")
    along = math.degrees(math.atan2(*(top - pivot)[::-1]))
    alpha = math.degrees(math.atan2(width, height))
    axes.add_patch(Arc(tuple(pivot), 1.3, 1.3, theta1=along, theta2=along + alpha, color=INK))
    _at(axes, pivot, 0.78, along + 0.5 * alpha, "α")
    degrees = math.degrees(theta)
    axes.add_patch(Arc(tuple(pivot), 2.3, 2.3, theta1=180.0 - degrees, theta2=180.0, color=INK))
    _at(axes, pivot, 1.3, 180.0 - 0.5 * degrees, "θ")


def _at(axes: Axes, origin: FloatArray, distance: float, degrees: float, name: str) -> None:
    angle = math.radians(degrees)
    x, y = origin + distance * np.array([math.cos(angle), math.sin(angle)])
    axes.text(x, y, name, ha="center", va="center", fontsize=15)


def _arrow(
    start: FloatArray | tuple[float, float],
    end: FloatArray | tuple[float, float],
    style: str,
    colour: str,
    width: float = 1.0,
) -> FancyArrowPatch:
    return FancyArrowPatch(
        tuple(start),
        tuple(end),
        arrowstyle=style,
        mutation_scale=12,
        color=colour,
        linewidth=width,
        shrinkA=0,
        shrinkB=0,
    )


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
        right, found = (
            float(np.interp(instant, points["time_s"], points["theta_ratio"]))  # or the last one
            for points in (exact, samples[samples["source"] == source])
        )
        _outlines(axes, block, right, found, style_of(source).colour)
        axes.set_title(_title(line), fontsize=10, fontweight="bold")
        axes.text(
            0.5, -0.03, _verdict(line), transform=axes.transAxes, ha="center", va="top", fontsize=11
        )
    _histories(lower.subplots(), samples, lines, instant)
    return drawing


def _title(line: pd.Series[Any]) -> str:
    source = str(line["source"])
    if not is_engine(source):
        return "Housner's linearization" if source == "housner" else source
    return f"{engine_title(source)}, {told(preset_of(source)).short}"


def _verdict(line: pd.Series[Any]) -> str:
    if line["outcome"] != "rocked":
        return str(line["outcome"])
    error = float(line["error"])
    return f"peak {'within ' * (abs(error) < 1e-3)}{signed(error)}"


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
