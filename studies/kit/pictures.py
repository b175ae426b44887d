"""Figures as files: each written in one piece."""

import warnings
from pathlib import Path
from typing import BinaryIO

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from studies.kit.tables import draft

DPI, COLOURS = 130, 256
"""Points of a picture to the inch, and its colours, the nearest to those that it was drawn in."""


def lay_out(drawing: Figure) -> None:
    """Give the panels their places for good; else matplotlib draws it twice to write it once."""
    if layout := drawing.get_layout_engine():
        layout.execute(drawing)
        drawing.set_layout_engine(None)


def save(drawing: Figure, path: Path) -> None:
    """Write a figure in one piece, in the format of the file's suffix; its layout is then fixed."""
    drawing.set_dpi(DPI)
    with draft(path) as part, part.open("wb") as file, warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph")  # a letter that no font has is a box
        lay_out(drawing)
        if path.suffix == ".png":
            write_points(drawing, file)
        else:
            drawing.savefig(file, format=path.suffix[1:], dpi=DPI)


def write_points(drawing: Figure, file: BinaryIO) -> None:
    """Write a figure that has its layout as a PNG with COLOURS colours."""
    drawing.set_dpi(DPI)
    canvas = FigureCanvasAgg(drawing)
    canvas.draw()
    # a palette of its own makes a picture a third as large
    whole = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")
    few = whole.quantize(COLOURS, Image.Quantize.MAXCOVERAGE, kmeans=1, dither=Image.Dither.NONE)
    few.save(file, "png", optimize=True, dpi=(DPI, DPI))
