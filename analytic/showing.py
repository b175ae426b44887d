"""A few values and a curve as HTML, for a notebook: without a table or a plot's library."""

from collections.abc import Mapping
from html import escape

import numpy as np

from analytic.kernels.law import FloatArray

WIDE, HIGH = 480, 120
"""Size of a curve [px]."""
MOST_POINTS = 1000
"""Points of a curve that are drawn."""


def as_table(values: Mapping[str, str]) -> str:
    """Return names and values as the rows of a table."""
    rows = "".join(
        f"<tr><th style='text-align:left'>{escape(name)}</th><td>{escape(value)}</td></tr>"
        for name, value in values.items()
    )
    return f"<table>{rows}</table>"


def as_curve(x: FloatArray, y: FloatArray, words: str) -> str:
    """Return a curve as an image, its axis y = 0 in grey; nothing of fewer than two points.

    Parameters
    ----------
    x, y : ndarray, shape (n,)
        Finite, x increasing.
    words : str
        What it says to those who are read to.
    """
    if x.size < 2:
        return ""
    kept = np.unique(np.linspace(0, x.size - 1, MOST_POINTS).astype(int))
    x, y = x[kept], y[kept]
    largest = float(np.abs(y).max()) or 1.0
    across = WIDE * (x - x[0]) / (x[-1] - x[0])
    down = 0.5 * HIGH * (1.0 - 0.95 * y / largest)
    points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(across, down, strict=True))
    middle = HIGH // 2
    return (
        f"<svg viewBox='0 0 {WIDE} {HIGH}' width='{WIDE}' role='img' aria-label='{escape(words)}'>"
        f"<path d='M0 {middle}H{WIDE}' stroke='#999'/>"
        f"<polyline points='{points}' fill='none' stroke='#0b6e99' stroke-width='1.5'/></svg>"
    )
