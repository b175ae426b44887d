"""Names written beside the lines they name, moved apart where they would cover each other."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes

from analytic.motion import FloatArray

LINE_HEIGHT = 1.25
"""Distance of two names over the size of their letters."""


@dataclass(frozen=True, slots=True)
class Name:
    """A name, its colour, and the point in the units of the axes that it belongs to."""

    text: str
    x: float
    y: float
    colour: str


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

    To be called when all is drawn: the limits of the axes stay what they are then.
    """
    if not names:
        return
    axes.set(xlim=axes.get_xlim(), ylim=axes.get_ylim())  # what the data ask for, from now on kept
    to_axes = axes.transScale + axes.transLimits
    places = to_axes.transform([(name.x, name.y) for name in names])
    points = 72.0 * axes.get_window_extent().height / axes.figure.dpi
    levels = spread(np.clip(places[:, 1], 0.0, 1.0).tolist(), LINE_HEIGHT * size / points)
    levels -= max(float(levels.max()) - 1.0, 0.0)
    for name, (x, y), level in zip(names, places, levels, strict=True):
        axes.annotate(
            name.text,
            xy=(min(x, 1.0), min(max(y, 0.0), 1.0)),
            xycoords="axes fraction",
            xytext=(1.03, level),
            textcoords="axes fraction",
            color=name.colour,
            fontsize=size,
            va="center",
            annotation_clip=False,
            arrowprops={
                "arrowstyle": "-",
                "color": name.colour,
                "linewidth": 0.5,
                "shrinkB": 1.5,
                "relpos": (0.0, 0.5),
            },
        )
