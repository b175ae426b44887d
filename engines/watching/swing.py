"""The times and velocities at both ends of a swing, from the steps in between."""

import math
from typing import Annotated, NamedTuple

from engines.parts.compiled import FloatArray, State, shared

RESOLVED_ROWS = 3
"""An impact counts when the swing that it ends was seen aloft at the ends of this many steps."""

EDGE_ROWS = 3
"""Ends of steps from which the velocity at either end of a swing is read."""

EDGE = EDGE_ROWS + 1
"""Rows kept of either end of a swing."""

SHORTENED = 0.7
"""A step shorter than this part of the one before is one of an approach, which halves what is left;
even steps up to the next corner of the motion differ by less."""

TIME, RATE_S, THETA, RATE = range(4)
"""Columns of rows: the end of a step [s], the moment of its velocity [s], rotation, velocity."""


class Row(NamedTuple):
    """The end of a step: time [s], rotation [rad], and the angular velocity [rad/s].

    The velocity belongs to the time `rate_s` [s], in the middle of the step or at its end, as the
    engine integrates.
    """

    time: float
    rate_s: float
    theta: float
    rate: float


class Swing(State):
    """The rows during which the block is aloft on one side.

    Attributes
    ----------
    side : float
        -1 or 1; 0 where there is no swing.
    from_rest : bool
        Whether it began with an uplift.
    rows : int
        Rows until now.
    first, last : array
        Rows at both ends, without the shorter steps of an approach at the last.
    kept : int
        How many there are in `last`.
    end, end_theta, dt : float
        Time [s] and rotation [rad] at the last row of all, and the length [s] of its step.
    """

    side: float
    from_rest: bool
    rows: int
    first: Annotated[FloatArray, (EDGE, len(Row._fields))]
    last: Annotated[FloatArray, (EDGE, len(Row._fields))]
    kept: int
    end: float
    end_theta: float
    dt: float


@shared
def begin_swing(swing: Swing, side: float, from_rest: bool) -> None:
    """Forget the last swing for another one, or for none.

    Parameters
    ----------
    swing : Swing, updated
    side : float, -1 or 1, or 0 for none
    from_rest : bool, whether an uplift begins it
    """
    swing.side, swing.from_rest = side, from_rest
    swing.rows = swing.kept = 0
    swing.dt = 0.0


@shared
def begun(swing: Swing) -> bool:
    """Return whether the last row is the one that completes what is known of the beginning."""
    return swing.rows == EDGE


@shared
def resolved(swing: Swing) -> bool:
    """Return whether enough rows were seen to speak of an impact at the end."""
    return swing.rows >= RESOLVED_ROWS


@shared
def put(rows: FloatArray, number: int, row: Row) -> None:
    """Write a row.

    Parameters
    ----------
    rows : ndarray (k, 4), columns `TIME` [s], `RATE_S` [s], `THETA` [rad] and `RATE` [rad/s]
    number : int, of the row that is written
    row : Row
    """
    rows[number, TIME], rows[number, RATE_S] = row.time, row.rate_s
    rows[number, THETA], rows[number, RATE] = row.theta, row.rate


@shared
def row_of(rows: FloatArray, number: int) -> Row:
    """Read a row.

    Parameters
    ----------
    rows, number
        As for `put`.
    """
    return Row(rows[number, TIME], rows[number, RATE_S], rows[number, THETA], rows[number, RATE])


@shared
def copy(rows: FloatArray, source: int, to: int) -> None:
    """Write a row again in another place; a slice would compile for much longer.

    Parameters
    ----------
    rows : ndarray (k, n), written
    source, to : int, numbers of the row that is read, and of the one that is written
    """
    for column in range(rows.shape[1]):
        rows[to, column] = rows[source, column]


@shared
def add(swing: Swing, row: Row, dt_s: float) -> None:
    """Take in the next row.

    Parameters
    ----------
    swing : Swing, updated
    row : Row, at the end of a step
    dt_s : float, length of the step [s]
    """
    if swing.rows < EDGE:
        put(swing.first, swing.rows, row)
    swing.rows += 1
    if dt_s > SHORTENED * swing.dt:
        if swing.kept == EDGE:
            swing.kept -= 1
            for i in range(swing.kept):
                copy(swing.last, i + 1, i)
        put(swing.last, swing.kept, row)
        swing.kept += 1
    swing.end, swing.end_theta, swing.dt = row.time, row.theta, dt_s


@shared
def landing(swing: Swing) -> tuple[float, float]:
    """Return the time [s] at which the swing meets theta = 0, and the velocity [rad/s] then."""
    # in the shorter steps before an impact, and in the one that leads to them, the contact's
    # force may come later than the other forces
    count = max(swing.kept - 1, 1)
    rate = extrapolated(swing.last, 0, count, swing.end)
    if rate * swing.side >= 0.0:
        return swing.end, rate
    time = swing.end - swing.end_theta / rate
    return time, extrapolated(swing.last, 0, count, time)


@shared
def lift_off(swing: Swing, earliest: float) -> float:
    """Return the time [s] at which the swing left the rest.

    The base's acceleration passes the onset steadily, so that theta'' grows in proportion to time
    (EQUATIONS.md, "From (1) and (2)") and so does the square root of the angular velocity.

    Parameters
    ----------
    swing : Swing, of which the first rows are used
    earliest : float, it left no earlier [s]
    """
    a, b = row_of(swing.first, 1), row_of(swing.first, 2)
    root = math.sqrt(max(b.rate / a.rate, 0.0)) if a.rate != 0.0 else 0.0
    if root <= 1.0:
        return earliest
    return max((root * a.rate_s - b.rate_s) / (root - 1.0), earliest)


@shared
def launch(swing: Swing, time: float) -> float:
    """Return the velocity [rad/s] with which the swing left theta = 0.

    Parameters
    ----------
    swing : Swing, of which the first rows are used
    time : float, when it did [s]
    """
    rows = min(swing.rows, EDGE)
    # the step to the first row may contain the impact
    return extrapolated(swing.first, min(1, rows - 1), rows, time)


@shared
def extrapolated(rows: FloatArray, first: int, stop: int, time: float) -> float:
    """Return the angular velocity [rad/s] at a time by the polynomial through some rows.

    Parameters
    ----------
    rows : ndarray (k, 4), a `Row` each
    first, stop : int, numbers of the first row and of the one after the last
    time : float, [s]
    """
    total = 0.0
    for i in range(first, stop):
        weight = 1.0
        for j in range(first, stop):
            if j != i:
                weight *= (time - rows[j, RATE_S]) / (rows[i, RATE_S] - rows[j, RATE_S])
        total += weight * rows[i, RATE]
    return total
