"""The derivatives of a response by ln(a_p) and by ln(eta), beside the response itself.

They obey the equation of motion linearized about it (EQUATIONS.md, "Condition numbers"). They start
from zero, as they do again at each uplift, where the block is at rest. At an impact, whose time
moves too, they jump with the velocity. They end in the derivative of the peak. Units are those of
`analytic.kernels.law`.
"""

import math
from typing import NamedTuple

import numpy as np

from analytic.kernels.closed_form import free_peak, work_to
from analytic.kernels.compiled import inner, kernel, listed, maker
from analytic.kernels.excursions import ROCKED, expand, march
from analytic.kernels.law import FloatArray, Law, Start, State
from analytic.kernels.notes import RESTED, START, UPLIFT, Notes
from analytic.kernels.polynomial import ORDER, highest, slope, stretch, value
from analytic.kernels.rest import acceleration, ground, segment_at
from analytic.kernels.taylor import Accuracy

AMPLITUDE, RESTITUTION = 0, 1
"""Rows of the derivatives: by ln(a_p), by ln(eta)."""
RATE = 1
"""Column of the derivative of the velocity, beside that of the rotation."""


@kernel
def condition(
    law: Law, accuracy: Accuracy, segments: FloatArray, start: Start, work: FloatArray
) -> tuple[float, float]:
    """Return both condition numbers of one response; nan unless it rocks and survives.

    Parameters
    ----------
    law, accuracy, segments, start, work
        As for `excursions.march`.

    Returns
    -------
    by_amplitude, by_eta : float
        d ln(peak)/d ln(a_p) and d ln(peak)/d ln(eta), in the order of AMPLITUDE and RESTITUTION.
    """
    log = np.empty((64, 4))
    nothing = np.empty(0)
    while True:
        notes = Notes(nothing, np.empty((2, 0)), log, nothing)
        end = march(law, accuracy, segments, start, 0.0, notes, work)
        if end.events <= log.shape[0]:
            break
        log = np.empty((end.events, 4))
    if end.outcome != ROCKED:
        return math.nan, math.nan
    return follow(law, accuracy, listed(segments), listed(log[: end.events]), listed(work))


class Slopes(NamedTuple):
    """Derivatives by ln(a_p) and by ln(eta), a row each.

    now (2, 2): of the rotation and of its rate; peak (2,): of the largest rotation so far.
    """

    now: FloatArray
    peak: FloatArray


@maker
def follow(
    law: Law, accuracy: Accuracy, segments: FloatArray, log: FloatArray, work: FloatArray
) -> tuple[float, float]:
    """Follow the derivatives through the excursions between the events of a march's log."""
    slopes = Slopes(listed(np.zeros((2, 2))), listed(np.zeros(2)))
    last = segments[-1][1]
    peak = y = v = 0.0
    j = 0
    for n in range(len(log)):
        kind, tau, before, after = log[n]
        if kind == RESTED:
            continue
        j = segment_at(segments, j, tau)
        a, y = ground(segments, j, tau), 0.0
        if kind == START:
            side = math.copysign(1.0, before if before != 0.0 else after)
            y, v = abs(before), side * after
            lead, peak = 0 if y > 0.0 else 1, y
        elif kind == UPLIFT:
            side = -math.copysign(1.0, a)
            lead, v = int(before), 0.0
            for i in range(2):
                slopes.now[i][0] = slopes.now[i][RATE] = 0.0
        else:
            side, v, lead = math.copysign(1.0, after), abs(after), 1
            strike(law, side, a, -abs(before), slopes.now)
            if v == 0.0:
                side, lead = -math.copysign(1.0, a), 2
        until = log[n + 1][1] if n + 1 < len(log) else last
        begin = State(side, tau, lead, y, v)
        y, v, peak = fly(law, accuracy, segments[j:], begin, until, peak, slopes, work)
    if log[-1][0] != RESTED:
        peak = peak_to_come(law, y, v, peak, slopes)
    return slopes.peak[AMPLITUDE] / peak, slopes.peak[RESTITUTION] / peak


@inner
def strike(law: Law, side: float, a: float, before: float, now: FloatArray) -> None:
    """Take `Slopes.now` through an impact (EQUATIONS.md, "Condition numbers").

    Parameters
    ----------
    law : Law
    side : float, side after the impact
    a : float, ground acceleration [g]
    before : float, velocity of y before the impact [rad p], negative
    now : ndarray (2, 2), changed
    """
    here, there = acceleration(law, -side, a, 0.0), acceleration(law, side, a, 0.0)
    for i in range(2):
        later = -now[i][0] / before
        lost = law.eta * before if i == RESTITUTION else 0.0
        velocity = -law.eta * (now[i][RATE] + here * later) - lost
        now[i][0] = law.eta * before * later
        now[i][RATE] = velocity - there * later


@maker
def fly(
    law: Law,
    accuracy: Accuracy,
    segments: FloatArray,
    begin: State,
    until: float,
    peak: float,
    slopes: Slopes,
    work: FloatArray,
) -> tuple[float, float, float]:
    """Follow one excursion and its derivatives from a state to a time.

    Parameters
    ----------
    law, accuracy, work
        As for `march`.
    segments : ndarray, shape (m, 7)
        The ground motion from the time of the state on.
    begin : State
    until : float
        No later than the end of the motion.
    peak : float
        The largest rotation so far.
    slopes : Slopes
        Moved on to `until`.

    Returns
    -------
    y, v, peak : float
    """
    series, d, spare = work[0], work[4], work[5:]
    delta = listed(np.empty((3, ORDER + 1)))
    order = accuracy.order
    side, tau, lead, y, v = begin
    j = 0
    while tau < until:
        j = segment_at(segments, j, tau)
        h = expand(law, accuracy, segments[j], State(side, tau, lead, y, v), work)
        end = min(segments[j][1], until)
        landed = tau + h >= end
        if landed:
            h = end - tau
        stretch(series, order, h, d)
        peak, where = highest(d, order, lead, 1.0, peak, spare)
        expand_derivatives(law, order, work, slopes.now, delta)
        for i in range(2):
            stretch(delta[i], order, h, delta[i])
            if where >= 0.0:
                slopes.peak[i] = value(delta[i], order, where)
            slopes.now[i][0] = value(delta[i], order, 1.0)
            slopes.now[i][RATE] = slope(delta[i], order, 1.0) / h
        y, v, lead = value(d, order, 1.0), slope(d, order, 1.0) / h, 0
        tau = end if landed else tau + h
    return y, v, peak


@inner
def expand_derivatives(
    law: Law, order: int, work: FloatArray, now: FloatArray, delta: FloatArray
) -> None:
    """Fill delta[:2] with the series of the derivatives, from those that `expand` left in `work`.

    Of the exact model d'' = (cos z - f sin z) d - cos z df, of a linear one d'' = k^2 (d - q df);
    df is f for the amplitude and 0 for eta (EQUATIONS.md, "Condition numbers").
    """
    f, sine, cosine = work[1], work[2], work[3]
    stiff = delta[2]
    for i in range(2):
        delta[i][0], delta[i][1] = now[i][0], now[i][RATE]
    for n in range(order - 1):
        forced = law.k * law.k * law.factor * f[n]
        if not law.linear:
            forced, stiff[n] = 0.0, cosine[n]
            for m in range(n + 1):
                forced += f[m] * cosine[n - m]
                stiff[n] -= f[m] * sine[n - m]
        for i in range(2):
            pulled = law.k * law.k * delta[i][n]
            if not law.linear:
                pulled = 0.0
                for m in range(n + 1):
                    pulled += stiff[m] * delta[i][n - m]
            shaken = forced if i == AMPLITUDE else 0.0
            delta[i][n + 2] = (pulled - shaken) / ((n + 1) * (n + 2))


@inner
def peak_to_come(law: Law, y: float, v: float, peak: float, slopes: Slopes) -> float:
    """Take the derivatives on to the peak of the free rocking after the motion, if it is higher."""
    ahead = free_peak(law, y, v)
    if ahead <= peak:
        return peak
    kept = law.eta * law.eta if v < 0.0 else 1.0
    here, there = -acceleration(law, 1.0, 0.0, y), -acceleration(law, 1.0, 0.0, ahead)
    work = 0.5 * v * v + work_to(law, y)
    for i in range(2):
        change = kept * (v * slopes.now[i][RATE] + here * slopes.now[i][0])
        if i == RESTITUTION and v < 0.0:
            change += 2.0 * kept * work
        slopes.peak[i] = change / there
    return ahead
