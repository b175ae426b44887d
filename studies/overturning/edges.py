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

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analytic.maps import Modes
from analytic.motion import FloatArray

SAMPLES, FINE_ROUNDS, ROUNDS = 17, 6, 100
"""Points of a cell beside an edge, how often such are looked at, and rounds of searches at most."""
WIDTH, ISLAND_WIDTH = 1e-10, 1e-8
"""Amplitude over g tan(alpha) to which an edge is known, and an extremum of the margin followed."""

IntArray = NDArray[np.intp]
Solve = Callable[[IntArray, FloatArray], Modes]
"""Columns and amplitudes over g tan(alpha) -> modes; all (n,)."""


class Points(NamedTuple):
    """Amplitudes over g tan(alpha) of columns, and their modes as of `Modes`; each (n,)."""

    column: IntArray
    amplitude: FloatArray
    mode: NDArray[np.int32]


class Edges(NamedTuple):
    """Amplitudes that bracket edges of columns, and the modes there; each (n,)."""

    column: IntArray
    low: FloatArray
    high: FloatArray
    below: NDArray[np.int32]
    above: NDArray[np.int32]


def find_edges(solve: Solve, columns: int, amplitudes: FloatArray) -> pd.DataFrame:
    """Return the edges of columns 0, 1, ... with an increasing grid of amplitudes, as of `Edges`.

    RuntimeError if islands are still found within islands after ROUNDS searches.
    """
    number, fine = np.arange(columns), 0
    grid = np.broadcast_to(amplitudes, (columns, len(amplitudes)))
    mode, new = sample(solve, number, grid)
    points = Points(number.repeat(len(amplitudes)), grid.ravel(), mode.ravel())
    for _ in range(ROUNDS):
        points = ordered(points, *new)
        edges = bisect(solve, points)
        # both sides of edges may show modes that the grid does not
        column, low, high, below, above = edges
        points = ordered(points, Points(column, low, below), Points(column, high, above))
        new = mode_changes(solve, points)
        if not any(len(each.mode) for each in new) and fine < FINE_ROUNDS:
            new, fine = beside_edges(solve, points, edges), fine + 1
        if not any(len(each.mode) for each in new):
            return pd.DataFrame(edges._asdict())
    raise RuntimeError(f"islands within islands after {ROUNDS} rounds")


def ordered(*parts: Points) -> Points:
    """Return the points of all parts, by column and amplitude."""
    column, amplitude, mode = map(np.concatenate, zip(*parts, strict=True))
    order = np.lexsort((amplitude, column))
    return Points(column[order], amplitude[order], mode[order])


def between(points: Points, wanted: NDArray[np.bool_]) -> Edges:
    """Return the cells between a point and the next one of its column that are wanted."""
    at = np.flatnonzero(wanted & (points.column[1:] == points.column[:-1]))
    ends = (points.amplitude[at], points.amplitude[at + 1], points.mode[at], points.mode[at + 1])
    return Edges(points.column[at], *ends)


def beside_edges(solve: Solve, points: Points, edges: Edges) -> list[Points]:
    """Sample the cells beside edges, and return points of another outcome than their cell's."""
    key = points.column + 1j * points.amplitude
    touches = np.isin(key[:-1], edges.column + 1j * edges.high)
    touches |= np.isin(key[1:], edges.column + 1j * edges.low)
    wide = np.diff(points.amplitude) > SAMPLES * ISLAND_WIDTH
    alike = (points.mode[:-1] >= 0) == (points.mode[1:] >= 0)
    cell = between(points, touches & wide & alike)
    grid = cell.low[:, None] + (cell.high - cell.low)[:, None] * np.linspace(0.0, 1.0, SAMPLES)
    mode, beyond = sample(solve, cell.column, grid)
    other = (mode >= 0) != (cell.below >= 0)[:, None]
    number = np.broadcast_to(cell.column[:, None], grid.shape)
    return [Points(number[other], grid[other], mode[other]), *beyond]


def bisect(solve: Solve, points: Points) -> Edges:
    """Bisect every change of the outcome between ordered points."""
    first, second = points.mode[:-1], points.mode[1:]
    direct = (first != second) & (np.diff(points.amplitude) <= WIDTH)
    edges = between(points, ((first >= 0) != (second >= 0)) | ((first >= 0) & direct))
    column, low, high, below, above = edges
    while len(wide := np.flatnonzero(high - low > WIDTH)):
        middle = 0.5 * (low[wide] + high[wide])
        mode = solve(column[wide], middle).mode
        rises = (mode >= 0) == (above[wide] >= 0)
        up, down = wide[~rises], wide[rises]
        low[up], below[up] = middle[~rises], mode[~rises]
        high[down], above[down] = middle[rises], mode[rises]
    return edges


def mode_changes(solve: Solve, points: Points) -> list[Points]:
    """Return points that survive between neighbours that overturn after other numbers of impacts.

    Where there is none to WIDTH, the two points on either side of the change.
    """
    first, second = points.mode[:-1], points.mode[1:]
    differ = (first >= 0) & (second >= 0) & (first != second)
    wide = np.diff(points.amplitude) > WIDTH
    column, low, high, below, above = between(points, differ & wide)
    search, found = np.arange(len(column)), []
    while len(search):
        middle = 0.5 * (low[search] + high[search])
        mode = solve(column[search], middle).mode
        survives, like_below = mode < 0, mode == below[search]
        found.append(Points(column[search[survives]], middle[survives], mode[survives]))
        up, down = ~survives & like_below, ~survives & ~like_below
        low[search[up]] = middle[up]
        high[search[down]], above[search[down]] = middle[down], mode[down]
        search = search[~survives]
        done = high[search] - low[search] <= WIDTH
        ended, search = search[done], search[~done]
        found.append(Points(column[ended], low[ended], below[ended]))
        found.append(Points(column[ended], high[ended], above[ended]))
    return found


def sample(
    solve: Solve, column: IntArray, grid: FloatArray
) -> tuple[NDArray[np.int32], list[Points]]:
    """Return the modes on a grid of columns, a row each, and points that differ between two of it.

    These are beyond zero on the way to a local extremum of the margin towards zero.
    """
    found = solve(column.repeat(grid.shape[1]), grid.ravel())
    mode, margin = found.mode.reshape(grid.shape), found.margin.reshape(grid.shape)
    over = mode >= 0
    alike = (over[:, 1:-1] == over[:, :-2]) & (over[:, 1:-1] == over[:, 2:])
    # a surviving maximum, or an overturning minimum, is a least distance from the edge
    distance = np.where(np.isfinite(margin), np.abs(margin), np.inf)
    here = distance[:, 1:-1]
    least = (here <= distance[:, :-2]) & (here < distance[:, 2:])
    line, at = np.nonzero(alike & least & np.isfinite(here))
    low, middle, high = (grid[line, at + k] for k in range(3))
    best, side, column = distance[line, at + 1], over[line, at + 1], column[line]
    search, beyond = np.arange(len(column)), []
    while len(search):
        right = high[search] - middle[search] > middle[search] - low[search]
        trial = 0.5 * (middle[search] + np.where(right, high[search], low[search]))
        found = solve(column[search], trial)
        crossed = (found.mode >= 0) != side[search]
        beyond.append(Points(column[search[crossed]], trial[crossed], found.mode[crossed]))
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
    return mode, beyond
