"""Names written at the lines they name, moved apart where they would cover each other."""

from collections.abc import Sequence
from typing import NamedTuple, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.typing import ColorType
from textalloc import allocate

from studies.drawing.facets import HALO
from studies.kit.pictures import lay_out


class Name(NamedTuple):
    """A name, its colour, and the point in the units of the axes that it belongs to."""

    text: str
    x: float
    y: float
    colour: ColorType


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
