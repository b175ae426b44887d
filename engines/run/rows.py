"""Rows of numbers that compiled code keeps: the ends of steps, and what lies between them."""

from typing import NamedTuple

from engines.world import FloatArray

TIME, RATE_S, THETA, RATE = range(4)
"""Columns of rows, as of `Row`."""


class Row(NamedTuple):
    """The end of a step: time [s], rotation [rad], and rate [rad/s] at the time `rate_s` [s]."""

    time: float
    rate_s: float
    theta: float
    rate: float


def put(rows: FloatArray, number: int, row: tuple[float, float, float, float]) -> None:
    """Write a row."""
    rows[number, 0], rows[number, 1], rows[number, 2], rows[number, 3] = row


def row_of(rows: FloatArray, number: int) -> Row:
    """Read a row."""
    return Row(rows[number, TIME], rows[number, RATE_S], rows[number, THETA], rows[number, RATE])


def copy(rows: FloatArray, source: int, to: int) -> None:
    """Write a row again in another place; a slice would compile for much longer."""
    for column in range(rows.shape[1]):
        rows[to, column] = rows[source, column]


def extrapolated(rows: FloatArray, first: int, stop: int, time: float) -> float:
    """Return the velocity [rad/s] at a time [s] by the polynomial through some rows."""
    total = 0.0
    for i in range(first, stop):
        weight = 1.0
        for j in range(first, stop):
            if j != i:
                weight *= (time - rows[j, RATE_S]) / (rows[i, RATE_S] - rows[j, RATE_S])
        total += weight * rows[i, RATE]
    return total
