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


BEYOND = 10.0
"""Distance of a name from the point that it stands before or after [points]."""


def beyond(axes: Axes, names: Sequence[Name], side: int = 1, size: float = 8.0) -> None:
    """Write names after their points, those of one abscissa moved apart; before them on side -1."""
    axes.set(xlim=axes.get_xlim(), ylim=axes.get_ylim())
    scale = 72.0 / axes.figure.dpi
    for x in dict.fromkeys(name.x for name in names):
        mine = [name for name in names if name.x == x]
        own = scale * axes.transData.transform([(name.x, name.y) for name in mine])[:, 1]
        for name, moved in zip(mine, spread(own.tolist(), LINE_HEIGHT * size) - own, strict=True):
            line = {
                "arrowstyle": "-",
                "color": name.colour,
                "linewidth": 0.5,
                "relpos": (0.0 if side > 0 else 1.0, 0.5),
            }
            axes.annotate(name.text, (name.x, name.y), (side * BEYOND, moved),
                          textcoords="offset points", ha="left" if side > 0 else "right",
                          va="center", color=name.colour, fontsize=size, arrowprops=line,
                          path_effects=[withStroke(linewidth=2.5, foreground="white")])  # fmt: skip


PLACES = (
    *((6, 0, "left", "center"), (-6, 0, "right", "center"), (0, -7, "center", "top")),
    *((0, 7, "center", "bottom"), (6, -7, "left", "top"), (-6, -7, "right", "top")),
    *((6, 7, "left", "bottom"), (-6, 7, "right", "bottom"), (0, -18, "center", "top")),
    *((0, 18, "center", "bottom"), (10, -16, "left", "top"), (-10, -16, "right", "top")),
    *((10, 16, "left", "bottom"), (-10, 16, "right", "bottom"), (22, 0, "left", "center")),
    *((-22, 0, "right", "center"), (24, -12, "left", "top"), (-24, -12, "right", "top")),
    *((24, 12, "left", "bottom"), (-24, 12, "right", "bottom"), (0, 30, "center", "bottom")),
    *((14, 28, "left", "bottom"), (-14, 28, "right", "bottom"), (14, 42, "left", "bottom")),
    *((-14, 42, "right", "bottom"), (14, -28, "left", "top"), (-14, -28, "right", "top")),
)
"""Where a name may stand from its point [points], and how it is aligned there; best first."""
FAR = 10
"""Distance from its point [points] from which on a name is led to it by a line."""
LINE = 12
"""Points by which such a line is known to others."""
PARTS = {"left": 0.0, "bottom": 0.0, "center": 0.5, "right": 1.0, "top": 1.0}
"""Alignment -> part of the name's size at which its place is, and its line ends."""
CLEAR = 4.0
"""Distance that a name keeps from the points of others, and the line that leads to it [points]."""
ROUNDS = 3
"""How often each name looks for a place among those that the others have found."""


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
    frame = scale * np.array(axes.get_window_extent().extents)
    spots = scale * axes.transData.transform(taken)
    anchors = [scale * axes.transData.transform((name.x, name.y)) for name in names]
    boxes = [
        [_box(anchor, place, LETTER * size * len(name.text), size) for place in PLACES]
        for name, anchor in zip(names, anchors, strict=True)
    ]
    lines = [[_line(anchor, place) for place in PLACES] for anchor in anchors]
    alone = [
        [
            _covered(box, spots) + _near(line, spots) + 100 * _leaves(box, frame)
            for box, line in zip(*both, strict=True)
        ]
        for both in zip(boxes, lines, strict=True)
    ]
    best: dict[int, int] = {}
    for i in [*range(len(names))] * ROUNDS:
        others = [(boxes[j][at], lines[j][at]) for j, at in best.items() if j != i]
        costs = [
            cost
            + 100 * sum(_overlap(box, other) for other, _ in others)
            + 10 * sum(_covered(box, there) + _covered(other, line) for other, there in others)
            for cost, box, line in zip(alone[i], boxes[i], lines[i], strict=True)
        ]
        best[i] = int(np.argmin(costs))
    for i, name in enumerate(names):
        x, y, across, along = PLACES[best[i]]
        line = {"arrowstyle": "-", "color": name.colour, "linewidth": 0.5, "shrinkB": 3.0,
                "relpos": (PARTS[across], PARTS[along])}  # fmt: skip
        axes.annotate(name.text, (name.x, name.y), (x, y), textcoords="offset points",
                      ha=across, va=along, color=name.colour, fontsize=size,
                      arrowprops=line if len(lines[i][best[i]]) else None,
                      path_effects=[withStroke(linewidth=2.5, foreground="white")])  # fmt: skip


def _line(anchor: FloatArray, place: tuple[int, int, str, str]) -> FloatArray:
    """Return points along the line that leads to a name at a place; none where there is no line."""
    parts = np.linspace(0.0, 1.0, LINE if max(abs(place[0]), abs(place[1])) >= FAR else 0)
    line: FloatArray = anchor + parts[:, None] * np.array(place[:2])
    return line


def _box(
    anchor: FloatArray, place: tuple[int, int, str, str], width: float, height: float
) -> FloatArray:
    """Return left, foot, right and top [points] of a name at a place from its point."""
    x, y, across, along = place
    left = anchor[0] + x - PARTS[across] * width
    foot = anchor[1] + y - PARTS[along] * height
    return np.array([left, foot, left + width, foot + height])


def _covered(box: FloatArray, spots: FloatArray) -> int:
    inside = (spots >= box[:2] - CLEAR) & (spots <= box[2:] + CLEAR)
    return int(inside.all(axis=1).sum())


def _near(line: FloatArray, spots: FloatArray) -> int:
    """Return how many points lie at a line, those that it leads to apart."""
    if not len(line):
        return 0
    away = np.linalg.norm(spots - line[0], axis=1) > CLEAR
    apart = np.linalg.norm(spots[:, None] - line, axis=2).min(axis=1)
    return int((away & (apart < CLEAR)).sum())


def _leaves(box: FloatArray, frame: FloatArray) -> bool:
    return bool((box[:2] < frame[:2]).any() or (box[2:] > frame[2:]).any())


def _overlap(box: FloatArray, other: FloatArray) -> bool:
    return bool((box[:2] < other[2:]).all() and (other[:2] < box[2:]).all())
