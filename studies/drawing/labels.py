"""Names written at the lines they name, moved apart where they would cover each other."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.typing import ColorType
from numpy.typing import ArrayLike
from scipy.optimize import isotonic_regression
from textalloc import allocate

from analytic.motion import FloatArray
from studies.drawing.facets import HALO
from studies.kit.pictures import lay_out


@dataclass(frozen=True, slots=True)
class Name:
    """A name, its colour, and the point in the units of the axes that it belongs to."""

    text: str
    x: float
    y: float
    colour: ColorType


def spread(levels: ArrayLike, gap: float) -> FloatArray:
    """Return levels moved by as little as puts each at least `gap` from the next; order is kept.

    The least squares of the moves.
    """
    found = np.asarray(levels, np.float64)
    order = np.argsort(found, kind="stable")
    gaps = gap * np.arange(len(order))
    moved = np.empty(len(order))
    moved[order] = isotonic_regression(found[order] - gaps).x + gaps
    return moved


def beside(axes: Axes, names: Sequence[Name], size: float = 8.0) -> None:
    """Write names at the right of the axes, each level with its point or led to it by a line.

    To be called when all is drawn: the limits of the axes stay what they are then. A name whose
    point is not finite is left out; the size of the letters is in points.
    """
    names = [name for name in names if math.isfinite(name.x) and math.isfinite(name.y)]
    if not names:
        return
    axes.set(xlim=axes.get_xlim(), ylim=axes.get_ylim())  # what the data ask for, from now on kept
    to_axes = axes.transScale + axes.transLimits
    places = to_axes.transform([(name.x, name.y) for name in names])
    points = 72.0 * axes.get_window_extent().height / axes.figure.dpi
    levels = spread(np.clip(places[:, 1], 0.0, 1.0), 1.25 * size / points)
    levels -= max(float(levels.max()) - 1.0, 0.0)
    for name, (x, y), level in zip(names, places, levels, strict=True):
        line = [(min(x, 1.0), 1.02), (min(max(y, 0.0), 1.0), level)]
        axes.add_artist(Line2D(*line, color=name.colour, linewidth=0.5, transform=axes.transAxes,
                               clip_on=False))  # fmt: skip
        axes.text(1.03, level, name.text, color=name.colour, fontsize=size, va="center",
                  transform=axes.transAxes)  # fmt: skip


def around(axes: Axes, names: Sequence[Name]) -> None:
    """Write names near their points, clear of each other and of the lines and words there.

    To be called when all is drawn.
    """
    if not names:
        return
    lay_out(cast(Figure, axes.figure))  # now the axes are where they will be
    lines = [line.get_transform().transform(np.array(line.get_xydata())) for line in axes.lines]
    words = [text.get_window_extent().corners() for text in axes.texts]
    taken = [axes.transData.inverted().transform(line) for line in (*lines, *words) if len(line)]
    colours = [to_hex(name.colour) for name in names]
    others = [it for it in axes.figure.axes if it is not axes and it.get_visible()]
    for other in others:  # it draws the whole figure first
        other.set_visible(False)
    allocate(
        axes,
        x=[name.x for name in names],
        y=[name.y for name in names],
        text_list=[name.text for name in names],
        x_lines=[line[:, 0] for line in taken],
        y_lines=[line[:, 1] for line in taken],
        textsize=8.0,
        textcolor=colours,
        linecolor=colours,
        linewidth=0.5,
        margin=8.0 / 1200.0,  # both in parts of the axes: a few points
        min_distance=8.0 / 720.0,
        avoid_label_lines_overlap=True,
        avoid_crossing_label_lines=True,
        va="bottom",
        path_effects=HALO,
    )
    for other in others:
        other.set_visible(True)
