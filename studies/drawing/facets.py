"""Facets that figures share: panels in rows, dots in rows, cells, scales of errors, keys."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from matplotlib.typing import ColorType
from numpy.typing import ArrayLike

from studies.kit.say import power
from studies.measures.presets import in_order, look_of

STRIP = "#eeeeee"
"""Behind what has no place on a scale: failed or wrong."""
ERRORS = "cividis_r"
"""Colours of errors from small to large, the same in order of lightness for every reader."""
HALO = [withStroke(linewidth=2.5, foreground="white")]
NARROWEST = 7.6
"""Width that title and key of one panel need [in]."""


def panels(
    count: int, across: int, each: tuple[float, float], extra: float = 1.0, **shared: Any
) -> tuple[Figure, list[Axes]]:
    """Return a figure of some panels in rows, without the places that are left over.

    Parameters
    ----------
    count, across : int
        How many panels, and how many of them side by side at most.
    each : tuple
        Width and height of one [in].
    extra : float
        Height of what stands above and below all [in].
    shared : dict
        For `Figure.subplots`.
    """
    across = max(min(across, count), 1)
    down = max(math.ceil(count / across), 1)
    size = (max(each[0] * across, NARROWEST), each[1] * down + extra)
    drawing = Figure(figsize=size, layout="constrained")
    grid = list(drawing.subplots(down, across, squeeze=False, **shared).flat)
    for axes in grid[count:]:
        axes.remove()
    for axes in grid[max(count - across, 0) : count]:
        axes.tick_params(labelbottom=True)
    return drawing, grid[:count]


def error_scale(axis: Axis, low: float, high: float, every: int = 2) -> None:
    """Mark a logarithmic axis of relative errors at every so many powers of ten up to 100 %."""
    errors = [10.0**k for k in range(0, -17, -every) if low <= 10.0**k <= high]
    marks = [f"{100.0 * error:g} %" if error >= 0.999e-3 else power(error) for error in errors]
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


def strip_beyond(axes: Axes, start: float, words: str, *, along: str = "y") -> None:
    """Shade what lies beyond a logarithmic scale, from a value on, and say what stands there.

    The axes must have the limits that they will keep; the strip ends at the larger one.
    """
    end = max(getattr(axes, f"get_{along}lim")())
    look: dict[str, Any] = {"color": STRIP, "zorder": -2, "linewidth": 0.0}
    letters: dict[str, Any] = {"fontsize": 8, "color": "#666666"}
    if along == "y":
        axes.axhspan(start, end, **look)
        axes.text(0.995, math.sqrt(start * end), words, transform=axes.get_yaxis_transform(),
                  ha="right", va="center", **letters)  # fmt: skip
    else:
        axes.axvspan(start, end, **look)
        axes.text(math.sqrt(start * end), 1.0, words, transform=axes.get_xaxis_transform(),
                  ha="center", va="bottom", **letters)  # fmt: skip


def cells(
    axes: Axes, values: ArrayLike, low: float, high: float, columns: Sequence[str] = ()
) -> Any:
    """Paint a matrix of errors of either sign, the first row above; what has none stays white.

    `low` and `high` are the errors at the ends of the colours; the names of the columns are written
    above them. Return the image, for a colour bar.
    """
    found = np.asarray(values, np.float64)
    image = axes.imshow(np.ma.masked_invalid(np.abs(found)), aspect="auto", cmap=ERRORS,
                        interpolation="nearest", norm=LogNorm(low, high, clip=True))  # fmt: skip
    if columns:
        axes.set_xticks(range(len(columns)), columns)
        axes.xaxis.tick_top()
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)
    return image


def dot(name: str, marker: str, color: ColorType = "#555555", **look: Any) -> Line2D:
    """Return what stands in a key for a marker."""
    return Line2D([], [], linestyle="none", marker=marker, color=color, label=name, **look)


def preset_dots(presets: Iterable[str]) -> list[Line2D]:
    """Return what stands in a key for presets, in their order."""
    return [dot(look_of(name).short, "o", look_of(name).colour) for name in in_order(presets)]


def key(drawing: Figure, handles: Sequence[Any], across: int = 6, **look: Any) -> None:
    """Write a key of labelled artists below all panels, so many side by side."""
    drawing.legend(handles=list(handles), loc="outside lower center", ncols=across,
                   **{"frameon": False, "fontsize": 9, **look})  # fmt: skip
