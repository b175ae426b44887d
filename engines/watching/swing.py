"""The times and velocities at both ends of a swing, from the steps in between."""

import math
from collections.abc import Sequence
from typing import NamedTuple

RESOLVED_ROWS = 3
"""An impact counts when the swing that it ends was seen aloft at the ends of this many steps."""

EDGE_ROWS = 3
"""Ends of steps from which the velocity at either end of a swing is read."""

SHORTENED = 0.7
"""A step shorter than this part of the one before is one of an approach, which halves what is left;
even steps up to the next corner of the motion differ by less."""


class Row(NamedTuple):
    """The end of a step: time [s], rotation [rad], and the angular velocity [rad/s].

    The velocity belongs to the time `rate_s` [s], in the middle of the step or at its end, as the
    engine integrates.
    """

    time: float
    rate_s: float
    theta: float
    rate: float


class Swing:
    """The rows during which the block is aloft on one side."""

    __slots__ = ("_dt", "_end", "_first", "_last", "from_rest", "rows", "side")

    def __init__(self, side: float, from_rest: bool) -> None:
        self.side, self.from_rest = side, from_rest
        self.rows = 0
        self._first: list[Row] = []
        self._last: list[Row] = []
        self._end = Row(0.0, 0.0, 0.0, 0.0)
        self._dt = 0.0

    @property
    def begun(self) -> bool:
        """Whether the last row is the one that completes what is known of the beginning."""
        return self.rows == EDGE_ROWS + 1

    @property
    def resolved(self) -> bool:
        """Whether enough rows were seen to speak of an impact at the end."""
        return self.rows >= RESOLVED_ROWS

    def add(self, row: Row, dt_s: float) -> None:
        """Take in the next row, at the end of a step of `dt_s` [s]."""
        self.rows += 1
        if self.rows <= EDGE_ROWS + 1:
            self._first.append(row)
        if dt_s > SHORTENED * self._dt:
            self._last.append(row)
            if len(self._last) > EDGE_ROWS + 1:
                del self._last[0]
        self._end, self._dt = row, dt_s

    def landing(self) -> tuple[float, float]:
        """Time [s] at which the swing meets theta = 0, and the velocity [rad/s] with which."""
        # in the shorter steps before an impact, and in the one that leads to them, the contact's
        # force may come later than the other forces
        end, rows = self._end, self._last[:-1] or self._last
        rate = extrapolated(rows, end.time)
        if rate * self.side >= 0.0:
            return end.time, rate
        time = end.time - end.theta / rate
        return time, extrapolated(rows, time)

    def lift_off(self, earliest: float) -> float:
        """Time [s], no earlier than `earliest`, at which the swing left the rest.

        The base's acceleration passes the onset steadily, so that the square root of the angular
        velocity grows in proportion to time.
        """
        a, b = self._first[1:3]
        root = math.sqrt(max(b.rate / a.rate, 0.0)) if a.rate else 0.0
        if root <= 1.0:
            return earliest
        return max((root * a.rate_s - b.rate_s) / (root - 1.0), earliest)

    def launch(self, time: float) -> float:
        """Velocity [rad/s] with which the swing left theta = 0 at `time` [s]."""
        # the step to the first row may contain the impact
        return extrapolated(self._first[1:] or self._first, time)


def extrapolated(rows: Sequence[Row], time: float) -> float:
    """Angular velocity [rad/s] at `time` [s] by the polynomial through those of some steps."""
    total = 0.0
    for row in rows:
        weight = 1.0
        for other in rows:
            if other is not row:
                weight *= (time - other.rate_s) / (row.rate_s - other.rate_s)
        total += weight * row.rate
    return total
