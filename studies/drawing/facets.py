"""Facets that figures share: panels in rows, dots in rows, scales of errors, keys."""

import math
from collections.abc import Iterable, Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from matplotlib.typing import ColorType

from studies.kit.say import power
from studies.measures.presets import in_order, look_of

HALO = [withStroke(linewidth=2.5, foreground="white")]


def sheet(
    size: tuple[float, float], down: int = 1, across: int = 1, **shared: Any
) -> tuple[Figure, list[Axes]]:
    """Return a figure of a size [in], and its panels row by row."""
    drawing = Figure(figsize=size, layout="constrained")
    return drawing, list(drawing.subplots(down, across, squeeze=False, **shared).flat)


def panels(
    count: int, across: int, each: tuple[float, float], extra: float, **shared: Any
) -> tuple[Figure, list[Axes]]:
    """Return a figure of panels, so many side by side, of a size [in] with `extra` above them."""
    across = max(min(across, count), 1)
    down = max(math.ceil(count / across), 1)
    # title and key of one panel need some width
    size = (max(each[0] * across, 7.6), each[1] * down + extra)
    drawing, grid = sheet(size, down, across, **shared)
    for axes in grid[count:]:
        axes.remove()
    for axes in grid[max(count - across, 0) : count]:
        axes.tick_params(labelbottom=True)
    return drawing, grid[:count]


def error_scale(axis: Axis, low: float, high: float, every: int = 2) -> None:
    """Mark a logarithmic axis of relative errors, in per cent or, with tiny ones, in powers."""
    errors = [10.0**k for k in range(0, -17, -every) if low <= 10.0**k <= high]
    percent = min(errors, default=1.0) > 0.9e-6
    marks = [f"{100.0 * it:g} %" if percent else power(it) for it in errors]
    axis.set_ticks(errors, marks)
    axis.set_ticks([], minor=True)


def rows(axes: Axes, names: Sequence[str], size: float = 9.0) -> None:
    """Name the rows of a panel from above, at y = 0, 1, ..., and draw a line along each."""
    axes.set_yticks(range(len(names)), names, fontsize=size)
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.tick_params(axis="y", length=0)
    axes.grid(axis="y", color="#e4e4e4", linewidth=0.8)
    axes.grid(axis="x", alpha=0.25)
    axes.spines[["top", "right", "left"]].set_visible(False)
    axes.set_axisbelow(True)


def dot(name: str, marker: str, color: ColorType = "#555555", **look: Any) -> Line2D:
    """Return what stands in a key for a marker."""
    return Line2D([], [], linestyle="none", marker=marker, color=color, label=name, **look)


def preset_dots(presets: Iterable[str]) -> list[Line2D]:
    """Return what stands in a key for presets, in their order."""
    return [dot(look_of(name).short, "o", look_of(name).colour) for name in in_order(presets)]


def key(
    drawing: Figure, handles: Sequence[Any], across: int = 6, fontsize: float = 9.0, **look: Any
) -> None:
    """Write a key of labelled artists below all panels, so many side by side."""
    drawing.legend(handles=handles, loc="outside lower center", ncols=across, frameon=False,
                   fontsize=fontsize, **look)  # fmt: skip
