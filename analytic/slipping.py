"""The slips of a block on a base that moves, in closed form leg by leg (Newmark 1965).

Relative to the base x'' = -u'' - mu g sgn x' while the block slides (EQUATIONS.md, "The sliding
block"). It starts where abs(u'') exceeds mu g, and a slip ends where x' vanishes. On a segment of
the motion x and x' are elementary; between two crests of u'' the rate x' has one stationary point
at most, so that every root is bracketed.
"""

import math
import time
from collections.abc import Callable, Iterator
from itertools import groupby
from typing import NamedTuple

import numpy as np

from analytic.checks import PLACE, start_of
from analytic.kernels.rest import EQUAL
from analytic.motion import FloatArray, Motion
from analytic.response import History, Outcome, Reason, Response
from analytic.slide import SlidingBlock

MOST_SLIPS = 5_000
"""Slips, beside one a segment, after which a response counts as endless."""
LAST_DIGIT = float(np.finfo(np.float64).eps)


class Leg(NamedTuple):
    """A part of a slip or a stick, on one segment, from a place x [m] at a rate v [m/s].

    side is the sign of the rate, 0 while it sticks; phase and offset are those at the begin; brake
    is mu g.
    """

    begin: float
    x: float
    v: float
    side: float
    amplitude: float
    omega: float
    phase: float
    offset: float
    slope: float
    brake: float

    def ground(self, t: float) -> float:
        """Acceleration of the base [m/s2], t seconds after the begin."""
        wave = self.amplitude * math.sin(self.phase + self.omega * t)
        return wave + self.offset + self.slope * t

    def rate(self, t: float) -> float:
        """Rate x' [m/s], t seconds after the begin."""
        if self.side == 0.0:
            return 0.0
        gained = t * (self.offset + 0.5 * self.slope * t)
        if self.amplitude != 0.0:
            half = 0.5 * self.omega * t
            wave = math.sin(self.phase + half) * math.sin(half)
            gained += 2.0 * self.amplitude / self.omega * wave
        return self.v - gained - self.side * self.brake * t

    def place(self, t: float) -> float:
        """Place x [m], t seconds after the begin."""
        if self.side == 0.0:
            return self.x
        moved = t * t * (0.5 * self.offset + self.slope * t / 6.0)
        if self.amplitude != 0.0:
            turned = self.omega * t
            ahead = math.cos(self.phase) * (turned - math.sin(turned))
            across = 2.0 * math.sin(self.phase) * math.sin(0.5 * turned) ** 2
            moved += self.amplitude / self.omega**2 * (ahead + across)
        return self.x + t * (self.v - 0.5 * self.side * self.brake * t) - moved

    def crests(self, length: float) -> Iterator[float]:
        """Yield the times after the begin at which u'' is stationary, then the length [s]."""
        if abs(self.slope) < abs(self.amplitude * self.omega):
            level = math.acos(-self.slope / (self.amplitude * self.omega))
            turn = math.floor(self.phase / (2.0 * math.pi))
            while True:
                for angle in (level, 2.0 * math.pi - level):
                    t = (angle + 2.0 * math.pi * turn - self.phase) / self.omega
                    if t >= length:
                        yield length
                        return
                    if t > 0.0:
                        yield t
                turn += 1
        yield length


def slid(
    block: SlidingBlock,
    motion: Motion,
    start: tuple[float, float],
    until: float | None,
    sampled: FloatArray | None,
) -> Response:
    """Return the response from a place [m] and rate [m/s], to a time [s] or, for None, to rest."""
    began = time.perf_counter()
    x, v = start_of(start, PLACE)
    legs: list[Leg] = []
    end = _follow(block, motion.segments(), x, v, math.inf if until is None else until, legs)
    if end is None:
        message = "the block slips too often"
        return Response.failure(message, reason=Reason.UNDECIDED, steps=len(legs))
    slips, slip_times = _slips(legs, end)
    wall_s = time.perf_counter() - began
    return Response(
        outcome=Outcome.SLID if slips else Outcome.AT_REST,
        peak_ratio=0.0,
        slips=slips,
        slip_times=slip_times,
        steps=len(legs),
        wall_s=wall_s,
        history=None if sampled is None else _history(legs, sampled),
    )


def _follow(
    block: SlidingBlock, segments: FloatArray, x: float, v: float, until: float, legs: list[Leg]
) -> float | None:
    """Write the legs of a response; return the time [s] at which it ends, None if too many."""
    still = [float(segments[-1, 1]), math.inf, 0.0, 1.0, 0.0, 0.0, 0.0]
    side = math.copysign(1.0, v) if v != 0.0 else 0.0
    most = len(segments) + 3 * MOST_SLIPS
    for first, last, amplitude, omega, phase, offset, slope in [*segments.tolist(), still]:
        now, last = first, min(last, until)
        while now < last:
            gone = now - first
            shape = (amplitude, omega, phase + omega * gone, offset + slope * gone, slope)
            leg = Leg(now, x, v, side, *shape, block.limit)
            legs.append(leg)
            length, following = _stop(leg, last - now) if side else _start(leg, last - now)
            if length == math.inf:
                return now
            if len(legs) > most:
                return None
            x, v = leg.place(length), (leg.rate(length) if following == side else 0.0)
            side = following
            now = last if length >= last - now else now + length
    return until


def _start(leg: Leg, length: float) -> tuple[float, float]:
    """Return when a block that stands starts to slide, and to which side; else the length and 0."""
    limit = leg.brake * (1.0 + EQUAL)

    def excess(t: float) -> float:
        return abs(leg.ground(t)) - limit

    if leg.slope == 0.0 and abs(leg.amplitude) + abs(leg.offset) <= limit:
        return length, 0.0
    low = 0.0
    for high in leg.crests(length):
        if excess(low) > 0.0:
            return low, -math.copysign(1.0, leg.ground(low))
        if excess(high) > 0.0:
            return _root(excess, low, high), -math.copysign(1.0, leg.ground(high))
        low = high
    return length, 0.0


def _stop(leg: Leg, length: float) -> tuple[float, float]:
    """Return when a block that slides stops, and 0; else the length and its side."""

    def speed(t: float) -> float:
        return leg.side * leg.rate(t)

    def gain(t: float) -> float:
        return -leg.side * leg.ground(t) - leg.brake

    if length == math.inf:
        return speed(0.0) / leg.brake, 0.0
    low = 0.0
    for high in leg.crests(length):
        middle = _root(gain, low, high) if gain(low) * gain(high) < 0.0 else high
        for begin, end in ((low, middle), (middle, high)):
            if speed(begin) > 0.0 >= speed(end):
                return _root(speed, begin, end), 0.0
        low = high
    return length, leg.side


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    """Return a bracketed root to the last digit of its bracket, from the side of its end."""
    width, above = LAST_DIGIT * (high - low), function(high) > 0.0
    while high - low > width:
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        if (function(middle) > 0.0) == above:
            high = middle
        else:
            low = middle
    return high


def _slips(
    legs: list[Leg], end: float
) -> tuple[tuple[float, ...], tuple[tuple[float, float], ...]]:
    """Return the slips [m] and their times of begin and end [s] from the legs of a response."""
    runs = [(side, next(run)) for side, run in groupby(legs, key=lambda leg: leg.side)]
    stops = [(leg.x, leg.begin) for _, leg in runs[1:]]
    if runs and runs[-1][0] != 0.0:
        stops.append((legs[-1].place(end - legs[-1].begin), end))
    slips = [(leg, *stop) for (side, leg), stop in zip(runs, stops, strict=False) if side != 0.0]
    return tuple(x - leg.x for leg, x, _ in slips), tuple((leg.begin, t) for leg, _, t in slips)


def _history(legs: list[Leg], sampled: FloatArray) -> History:
    """Sample the place [m] and rate [m/s] of a block at times [s]; before its start, at rest."""
    begins = np.array([leg.begin for leg in legs])
    places = np.searchsorted(begins, sampled, side="right") - 1
    x, v = np.zeros(sampled.size), np.zeros(sampled.size)
    for i, (n, t) in enumerate(zip(places.tolist(), sampled.tolist(), strict=True)):
        leg = legs[max(n, 0)]
        since = max(t - leg.begin, 0.0)
        x[i], v[i] = leg.place(since), leg.rate(since)
    return History(sampled, x, v)
