"""Names written at the lines they name, moved apart where they would cover each other."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from matplotlib.typing import ColorType

from analytic.motion import FloatArray

LINE_HEIGHT = 1.25
"""Distance of two names over the size of their letters."""
LETTER = 0.62
"""Width of a letter over the size of letters, about."""
BEGINNING = 1.03
"""Where names beside axes begin, over the width of these."""


@dataclass(frozen=True, slots=True)
class Name:
    """A name, its colour, and the point in the units of the axes that it belongs to."""

    text: str
    x: float
    y: float
    colour: ColorType


def spread(levels: Sequence[float], gap: float) -> FloatArray:
    """Return levels moved by as little as puts each at least `gap` from the next; order is kept.

    The least squares of the moves, by pooling neighbours that are too near.
    """
    order = np.argsort(levels, kind="stable")
    pools: list[tuple[float, int]] = []  # mean of level less its share of gaps, and how many
    gaps = gap * np.arange(len(order))
    for level in np.asarray(levels, np.float64)[order] - gaps:
        mean, count = float(level), 1
        while pools and pools[-1][0] >= mean:
            before, size = pools.pop()
            mean, count = (before * size + mean * count) / (size + count), size + count
        pools.append((mean, count))
    moved = np.empty(len(order))
    moved[order] = np.concatenate([np.full(count, mean) for mean, count in pools]) + gaps
    return moved


def beside(axes: Axes, names: Sequence[Name], size: float = 8.0) -> None:
    """Write names at the right of the axes, each level with its point or led to it by a line.

    To be called when all is drawn: the limits of the axes stay what they are then. What has no
    point, of a source that failed, has no name.
    """
    names = [name for name in names if math.isfinite(name.x) and math.isfinite(name.y)]
    if not names:
        return
    axes.set(xlim=axes.get_xlim(), ylim=axes.get_ylim())  # what the data ask for, from now on kept
    to_axes = axes.transScale + axes.transLimits
    places = to_axes.transform([(name.x, name.y) for name in names])
    points = 72.0 * axes.get_window_extent().height / axes.figure.dpi
    levels = spread(np.clip(places[:, 1], 0.0, 1.0).tolist(), LINE_HEIGHT * size / points)
    levels -= max(float(levels.max()) - 1.0, 0.0)
    for name, (x, y), level in zip(names, places, levels, strict=True):
        line = [(min(x, 1.0), BEGINNING - 0.01), (min(max(y, 0.0), 1.0), level)]
        axes.add_artist(Line2D(*line, color=name.colour, linewidth=0.5, transform=axes.transAxes,
                               clip_on=False))  # fmt: skip
        axes.text(BEGINNING, level, name.text, color=name.colour, fontsize=size, va="center",
                  transform=axes.transAxes)  # fmt: skip


def breadth(names: Sequence[str], size: float = 8.0) -> float:
    """Return about how much room [in] names need beside axes of a few inches."""
    return 0.12 + LETTER * size * max(map(len, names)) / 72.0


PLACES = (
    *((6, 0, "left", "center"), (-6, 0, "right", "center"), (0, -7, "center", "top")),
    *((0, 7, "center", "bottom"), (6, -7, "left", "top"), (-6, -7, "right", "top")),
    *((6, 7, "left", "bottom"), (-6, 7, "right", "bottom"), (0, -18, "center", "top")),
    *((10, -16, "left", "top"), (-10, -16, "right", "top"), (10, 16, "left", "bottom")),
    *((28, 0, "left", "center"), (24, -12, "left", "top"), (-24, -12, "right", "top")),
)
"""Where a name may stand from its point [points], and how it is aligned there; best first."""
FAR = 10
"""Distance from its point [points] from which on a name is led to it by a line."""


def around(axes: Axes, names: Sequence[Name], taken: FloatArray, size: float = 8.0) -> None:
    """Write names at their points, each where it covers the fewest of what is there.

    Parameters
    ----------
    axes : Axes
        With all lines drawn.
    names : sequence of Name
    taken : ndarray, shape (n, 2)
        Points in the units of the axes that names keep clear of.
    size : float
        Of the letters [points].
    """
    axes.set(xlim=axes.get_xlim(), ylim=axes.get_ylim())
    scale = 72.0 / axes.figure.dpi
    left, foot, right, top = scale * np.array(axes.get_window_extent().extents)
    spots = scale * axes.transData.transform(taken)
    boxes: list[FloatArray] = []
    for name in names:
        anchor = scale * axes.transData.transform((name.x, name.y))
        found = [_box(anchor, place, LETTER * size * len(name.text), size) for place in PLACES]
        costs = [
            _covered(box, spots)
            + 100 * sum(_overlap(box, other) for other in boxes)
            + 100 * (box[0] < left or box[1] < foot or box[2] > right or box[3] > top)
            for box in found
        ]
        best = int(np.argmin(costs))
        boxes.append(found[best])
        x, y, across, along = PLACES[best]
        line = {"arrowstyle": "-", "color": name.colour, "linewidth": 0.5, "shrinkB": 3.0}
        axes.annotate(name.text, (name.x, name.y), (x, y), textcoords="offset points",
                      ha=across, va=along, color=name.colour, fontsize=size,
                      arrowprops=line if max(abs(x), abs(y)) >= FAR else None,
                      path_effects=[withStroke(linewidth=2.5, foreground="white")])  # fmt: skip


def _box(
    anchor: FloatArray, place: tuple[int, int, str, str], width: float, height: float
) -> FloatArray:
    """Return left, foot, right and top [points] of a name at a place from its point."""
    x, y, across, along = place
    left = anchor[0] + x - {"left": 0.0, "center": 0.5, "right": 1.0}[across] * width
    foot = anchor[1] + y - {"bottom": 0.0, "center": 0.5, "top": 1.0}[along] * height
    return np.array([left, foot, left + width, foot + height])


def _covered(box: FloatArray, spots: FloatArray) -> int:
    inside = (spots >= box[:2] - 2.0) & (spots <= box[2:] + 2.0)
    return int(inside.all(axis=1).sum())


def _overlap(box: FloatArray, other: FloatArray) -> bool:
    return bool((box[:2] < other[2:]).all() and (other[:2] < box[2:]).all())
