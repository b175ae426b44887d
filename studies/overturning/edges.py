"""Where overturning begins and ends: every edge of a map's columns, by bisection.

In a column the outcome is a set of intervals of the amplitude. Three things are looked for, each
by a search that ends at WIDTH:

- neighbours on the grid of which one survives: the edge between them;
- neighbours that overturn after different numbers of impacts: an island of survival between them,
  for a block on the separatrix has lost velocity at the next impact and cannot overturn there, so
  that one mode does not pass into another. An island narrower than WIDTH is reported as an edge
  from one mode to the other;
- a local extremum of the margin towards zero over three neighbours: an island if it crosses zero.
  The margin is continuous, so an island between two neighbours has one. Islands crowd, so the
  cells beside an edge are looked at again on a grid of SAMPLES points, FINE_ROUNDS times.

The first two are certain. What the third can miss is an island far from any edge whose extremum
does not show on the grid, or one of several between the same two points of the finest grid.
"""

from __future__ import annotations

from typing import Any, NamedTuple, Protocol

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analytic.maps import Modes
from analytic.motion import FloatArray

SAMPLES = 17
"""Points at which a cell beside an edge is looked at, and looked at again."""
FINE_ROUNDS = 6
WIDTH = 1e-10
"""Amplitude, over g tan(alpha), to which an edge is known."""
ISLAND_WIDTH = 1e-8
"""Amplitude to which an extremum of the margin is followed."""
ROUNDS = 100
"""Of searches between modes, each of which may show more of them."""

IntArray = NDArray[np.intp]


class Solve(Protocol):
    """Modes at amplitudes over g tan(alpha), each in the column of that number; both (n,)."""

    def __call__(self, column: IntArray, amplitude: FloatArray) -> Modes:
        """Solve."""


class Points(NamedTuple):
    """Amplitudes over g tan(alpha) of columns, their modes as of `Modes`, how found; each (n,)."""

    column: IntArray
    amplitude: FloatArray
    mode: NDArray[np.int32]
    found: NDArray[np.str_]


def points_of(
    column: IntArray, amplitude: FloatArray, mode: NDArray[np.int32], found: str
) -> Points:
    """Return points that were all found in one way."""
    return Points(column, amplitude, mode, np.full(len(mode), found))


NONE = points_of(np.empty(0, np.intp), np.empty(0), np.empty(0, np.int32), "")


def join(*parts: Points) -> Points:
    """Return the points of all parts."""
    return Points(*map(np.concatenate, zip(*parts, strict=True)))


def ordered(*parts: Points) -> Points:
    """Return the points of all parts, by column and amplitude."""
    points = join(*parts)
    order = np.lexsort((points.amplitude, points.column))
    columns: list[Any] = [values[order] for values in points]
    return Points(*columns)


def find_edges(solve: Solve, columns: int, amplitudes: FloatArray) -> pd.DataFrame:
    """Return the edges of a map: where the outcome changes along each of its columns.

    How, and what can be missed, stands at the head of this module.

    Parameters
    ----------
    solve : callable
        A `Solve`.
    columns : int
        Their number; they are 0, 1, ...
    amplitudes : ndarray (m,)
        The grid of each column over g tan(alpha), increasing.

    Returns
    -------
    DataFrame
        With `column`, `low` and `high`, the amplitudes that bracket the edge, `below` and `above`,
        the modes there, and `found`: "grid", or "mode" or "margin" for those of an island that
        lies between two neighbours of the grid. Ordered by column and amplitude.

    Raises
    ------
    RuntimeError
        If islands are still found within islands after ROUNDS searches.
    """
    grid = np.broadcast_to(amplitudes, (columns, len(amplitudes)))
    number = np.broadcast_to(np.arange(columns)[:, None], grid.shape)
    found = solve(number.ravel(), grid.ravel())
    mode, margin = found.mode.reshape(grid.shape), found.margin.reshape(grid.shape)
    points = ordered(
        points_of(number.ravel(), grid.ravel(), found.mode, "grid"),
        extrema(solve, grid, mode, margin),
    )
    fine = 0
    for _ in range(ROUNDS):
        edges = bisect(solve, points)
        # both sides of edges may show modes that the grid does not
        sides = ("column", "low", "below", "found"), ("column", "high", "above", "found")
        ends = [Points(*(edges[name].to_numpy() for name in side)) for side in sides]
        points = ordered(points, *ends)
        new = mode_changes(solve, points)
        if len(new.mode) == 0 and fine < FINE_ROUNDS:
            new, fine = beside_edges(solve, points, edges), fine + 1
        if len(new.mode) == 0:
            return edges
        points = ordered(points, new)
    raise RuntimeError(f"islands within islands after {ROUNDS} rounds")


def beside_edges(solve: Solve, points: Points, edges: pd.DataFrame) -> Points:
    """Sample the cells beside edges, where islands crowd, and follow the extrema there.

    Return the points that have another outcome than the cell in which they lie.
    """
    known = np.sort(_keys(edges["column"].to_numpy(), edges["low"].to_numpy()))
    ends = np.sort(_keys(edges["column"].to_numpy(), edges["high"].to_numpy()))
    key = _keys(points.column, points.amplitude)
    touches = np.isin(key[:-1], ends) | np.isin(key[1:], known)
    wide = np.diff(points.amplitude) > SAMPLES * ISLAND_WIDTH
    alike = (points.mode[:-1] >= 0) == (points.mode[1:] >= 0)
    at = neighbours(points, touches & wide & alike)
    owner, low, high = points.column[at], points.amplitude[at], points.amplitude[at + 1]
    grid = low[:, None] + (high - low)[:, None] * np.linspace(0.0, 1.0, SAMPLES)
    number = np.broadcast_to(owner[:, None], grid.shape)
    found = solve(number.ravel(), grid.ravel())
    mode, margin = found.mode.reshape(grid.shape), found.margin.reshape(grid.shape)
    other = (mode >= 0) != (points.mode[at] >= 0)[:, None]
    seen = points_of(number[other], grid[other], mode[other], "margin")
    beyond = extrema(lambda i, amplitude: solve(owner[i], amplitude), grid, mode, margin)
    return join(seen, beyond._replace(column=owner[beyond.column]))


def _keys(column: IntArray, amplitude: FloatArray) -> NDArray[np.complex128]:
    return column + 1j * amplitude


def neighbours(points: Points, wanted: NDArray[np.bool_]) -> IntArray:
    """Return where a point and the next one in its column are wanted."""
    return np.flatnonzero(wanted & (points.column[1:] == points.column[:-1]))


def bisect(solve: Solve, points: Points) -> pd.DataFrame:
    """Bisect every change of the outcome between ordered points."""
    first, second = points.mode[:-1], points.mode[1:]
    changes = (first >= 0) != (second >= 0)
    direct = (first >= 0) & (second >= 0) & (first != second) & _close(points)
    at = neighbours(points, changes | direct)
    column = points.column[at]
    low, high = points.amplitude[at], points.amplitude[at + 1]
    below, above = points.mode[at], points.mode[at + 1]
    while len(wide := np.flatnonzero(high - low > WIDTH)):
        middle = 0.5 * (low[wide] + high[wide])
        mode = solve(column[wide], middle).mode
        rises = (mode >= 0) == (above[wide] >= 0)
        up, down = wide[~rises], wide[rises]
        low[up], below[up] = middle[~rises], mode[~rises]
        high[down], above[down] = middle[rises], mode[rises]
    found = points.found
    beside = np.where(found[at] == "grid", found[at + 1], found[at])
    table = {"column": column, "low": low, "high": high, "below": below, "above": above}
    return pd.DataFrame({**table, "found": beside})


def _close(points: Points) -> NDArray[np.bool_]:
    return np.diff(points.amplitude) <= WIDTH


def mode_changes(solve: Solve, points: Points) -> Points:
    """Return points that survive between neighbours that overturn after other numbers of impacts.

    Where there is none to WIDTH, the two points on either side of the change.
    """
    first, second = points.mode[:-1], points.mode[1:]
    at = neighbours(points, (first >= 0) & (second >= 0) & (first != second) & ~_close(points))
    column = points.column[at]
    low, high = points.amplitude[at], points.amplitude[at + 1]
    below, above = points.mode[at], points.mode[at + 1]
    search = np.arange(len(at))
    found = [NONE]
    while len(search):
        middle = 0.5 * (low[search] + high[search])
        mode = solve(column[search], middle).mode
        survives = mode < 0
        surviving = (column[search[survives]], middle[survives], mode[survives])
        found.append(points_of(*surviving, "mode"))
        like_below = mode == below[search]
        up, down = search[~survives & like_below], search[~survives & ~like_below]
        low[up] = middle[~survives & like_below]
        high[down], above[down] = middle[~survives & ~like_below], mode[~survives & ~like_below]
        search = search[~survives]
        done = high[search] - low[search] <= WIDTH
        ended = search[done]
        found += [
            points_of(column[ended], low[ended], below[ended], "mode"),
            points_of(column[ended], high[ended], above[ended], "mode"),
        ]
        search = search[~done]
    return join(*found)


def extrema(solve: Solve, grid: FloatArray, mode: NDArray[np.int32], margin: FloatArray) -> Points:
    """Follow every local extremum of the margin towards zero; return the points beyond zero."""
    over = mode >= 0
    alike = (over[:, 1:-1] == over[:, :-2]) & (over[:, 1:-1] == over[:, 2:])
    # a surviving maximum, or an overturning minimum, is a least distance from the edge
    distance = np.where(np.isfinite(margin), np.abs(margin), np.inf)
    here = distance[:, 1:-1]
    least = (here <= distance[:, :-2]) & (here < distance[:, 2:])
    column, row = np.nonzero(alike & least & np.isfinite(here))
    row += 1
    low, middle, high = grid[column, row - 1], grid[column, row], grid[column, row + 1]
    best, side = distance[column, row], over[column, row]
    search = np.arange(len(column))
    beyond = [NONE]
    while len(search):
        right = high[search] - middle[search] > middle[search] - low[search]
        end = np.where(right, high[search], low[search])
        trial = 0.5 * (middle[search] + end)
        found = solve(column[search], trial)
        crossed = (found.mode >= 0) != side[search]
        crossing = (column[search[crossed]], trial[crossed], found.mode[crossed])
        beyond.append(points_of(*crossing, "margin"))
        size = np.where(np.isfinite(found.margin), np.abs(found.margin), np.inf)
        better = size < best[search]
        # the new point is the middle, and the old one bounds the interval; or it bounds it itself
        for bound, moves in ((low, right), (high, ~right)):
            inwards, outwards = better & moves, ~better & ~moves
            bound[search[inwards]] = middle[search[inwards]]
            bound[search[outwards]] = trial[outwards]
        middle[search[better]], best[search[better]] = trial[better], size[better]
        search = search[~crossed]
        search = search[high[search] - low[search] > ISLAND_WIDTH]
    return join(*beyond)


def intervals(
    edges: pd.DataFrame, first: NDArray[np.int32], low: float, high: float
) -> pd.DataFrame:
    """Return the intervals of the amplitude between the edges of each column.

    Parameters
    ----------
    edges : DataFrame
        From `find_edges`.
    first : ndarray of int32 (columns,)
        The mode of each column at its lower end.
    low, high : float
        Ends of every column over g tan(alpha).

    Returns
    -------
    DataFrame
        column, low, high and mode, ordered by column and amplitude; of a column without an edge one
        from end to end. They meet in the middle of an edge's bracket.
    """
    columns = len(first)
    middle = 0.5 * (edges["low"].to_numpy() + edges["high"].to_numpy())
    column = np.concatenate([np.arange(columns), edges["column"].to_numpy()])
    start = np.concatenate([np.full(columns, low), middle])
    mode = np.concatenate([first, edges["above"].to_numpy()])
    order = np.lexsort((start, column))
    column, start, mode = column[order], start[order], mode[order]
    end = np.append(start[1:], high)
    end[np.append(column[1:] != column[:-1], True)] = high
    return pd.DataFrame({"column": column, "low": start, "high": end, "mode": mode})
