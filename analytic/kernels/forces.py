"""Contact forces of the exact model: where the reference stops being valid, they show it.

A negative normal force means that the pivot lifts off; friction below the ratio of the horizontal
to the normal force means that it slides. Of a block that overturns the forces count until it passes
the critical rotation for good: those of its fall decide nothing.

`limits` holds the smallest normal force over weight and the largest friction ratio so far, and what
the two were when the block last passed the critical rotation; it is empty where nothing is watched.
Symbols and units are those of `analytic.kernels.law`.
"""

import math

from analytic.kernels.closed_form import is_lost, turning_rotation, work_to
from analytic.kernels.law import FloatArray, Law
from analytic.kernels.polynomial import ORDER, highest, next_root, stretch, value
from analytic.kernels.rest import acceleration, strongest_between
from analytic.kernels.taylor import expand_forcing, expand_weight

NOTHING_YET = (1.0, 0.0, 1.0, 0.0)
"""Limits before the first state, of a block at rest on a base at rest."""

SLOWEST = 1e-9
"""Frequency [p] below which a segment is one series, however long."""
MOST_REFINEMENTS = 30
REFINED = 1e-14
"""Part of the friction ratio below which a better one changes nothing."""


def forces(
    law: Law, side: float, a: float, y: float, v: float, weight: float = 1.0
) -> tuple[float, float]:
    """Return (normal, horizontal) force over weight (EQUATIONS.md, "The rocking frame")."""
    z = law.alpha - y
    rate = acceleration(law, side, a, y, weight)
    horizontal = a + 0.75 * side * (v * v * math.sin(z) + rate * math.cos(z))
    normal = weight + 0.75 * (rate * math.sin(z) - v * v * math.cos(z))
    return normal, horizontal


def keep(limits: FloatArray, normal: float, horizontal: float) -> None:
    """Keep the smallest normal force and the largest friction ratio in limits[0], limits[1]."""
    limits[0] = min(limits[0], normal)
    limits[1] = max(limits[1], abs(horizontal) / normal if normal > 0.0 else math.inf)


def watch(
    limits: FloatArray, law: Law, side: float, a: float, y: float, v: float, weight: float = 1.0
) -> None:
    """Watch one state of a block."""
    normal, horizontal = forces(law, side, a, y, v, weight)
    keep(limits, normal, horizontal)


def watch_rest(
    limits: FloatArray, segments: FloatArray, j: int, begin: float, end: float, work: FloatArray
) -> None:
    """Watch a block at rest between two times: it needs the friction that carries it along."""
    if len(limits) > 0 and len(segments[0]) == 7:
        limits[1] = max(limits[1], strongest_between(segments, j, begin, end))
    elif len(limits) > 0:
        for i in range(j, len(segments)):
            t, last = max(begin, segments[i][0]), min(end, segments[i][1])
            while t <= last:
                h = min(last - t, 1.0 / max(segments[i][3], segments[i][10], SLOWEST))
                expand_forcing(segments[i], t, 1.0, ORDER, work[0])
                expand_weight(segments[i], t, ORDER, work[1])
                stretch(work[0], ORDER, h, work[6])
                stretch(work[1], ORDER, h, work[5])
                watch_ratio(limits, ORDER, 1.0, work)
                t = t + h if h > 0.0 else math.inf


def watch_train(
    limits: FloatArray, law: Law, side: float, a: float, v: float, weight: float
) -> None:
    """Watch a train of impacts that is summed, from its begin to rest."""
    if v == 0.0 or len(limits) == 0:
        return
    watch(limits, law, side, a, 0.0, v, weight)
    watch(limits, law, -side, a, 0.0, law.eta * v, weight)
    watch(limits, law, side, a, 0.0, 0.0, weight)
    watch(limits, law, -side, a, 0.0, 0.0, weight)


def watch_step(
    limits: FloatArray, law: Law, order: int, h: float, x: float, work: FloatArray, y: float
) -> None:
    """Watch a step that ends at y; one beyond the critical rotation first until it passes that."""
    if len(limits) == 0:
        return
    passed = passing(law, order, x, work) if y >= law.alpha else -1.0
    if passed > 0.0:
        watch_part(limits, order, h, passed, work)
        limits[2], limits[3] = limits[0], limits[1]
    watch_part(limits, order, h, x, work)


def passing(law: Law, order: int, x: float, work: FloatArray) -> float:
    """Return at which part of a step it passes the critical rotation last, -1 if nowhere."""
    beyond, spare = work[5], work[6:]
    for i in range(order + 1):
        beyond[i] = work[4][i]
    beyond[0] -= law.alpha
    passed = -1.0
    root = next_root(beyond, order, 0.0, spare)
    while root < x:
        passed = root
        root = next_root(beyond, order, root, spare)
    return x if passed < 0.0 and beyond[0] < 0.0 else passed


def forget_fall(limits: FloatArray) -> None:
    """Go back to the limits when the block last passed the critical rotation."""
    if len(limits) > 0:
        limits[0], limits[1] = limits[2], limits[3]


def watch_part(limits: FloatArray, order: int, h: float, x: float, work: FloatArray) -> None:
    """Watch a part of a step."""
    expand_forces(order - 2, h, work, work[5], work[6], work[7])
    watch_ratio(limits, order - 2, x, work)


def watch_ratio(limits: FloatArray, degree: int, x: float, work: FloatArray) -> None:
    """Watch forces whose series, of a step on [0, 1], are in work[5] and work[6].

    At the largest ratio mu, abs(T) - mu N has no positive maximum; else one gives a better mu
    (Dinkelbach 1967).
    """
    normal, tangential, excess, spare = work[5], work[6], work[7], work[8:]
    for i in range(degree + 1):
        excess[i] = -normal[i]
    least, _ = highest(excess, degree, 0, x, max(-normal[0], -float(limits[0])), spare)
    limits[0] = min(limits[0], -least)
    if limits[0] <= 0.0:
        limits[1] = math.inf
        return
    most = max(float(limits[1]), abs(tangential[0]) / normal[0])
    for sign in (1.0, -1.0):
        for _ in range(MOST_REFINEMENTS):
            for i in range(degree + 1):
                excess[i] = sign * tangential[i] - most * normal[i]
            _, where = highest(excess, degree, 0, x, 0.0, spare)
            if where < 0.0:
                break
            ratio = sign * value(tangential, degree, where) / value(normal, degree, where)
            if ratio <= most * (1.0 + REFINED):
                break
            most = ratio
    limits[1] = most


def expand_forces(
    degree: int,
    h: float,
    series: FloatArray,
    normal: FloatArray,
    tangential: FloatArray,
    square: FloatArray,
) -> None:
    """Write the series of the contact forces over m g, on [0, 1] for a step, from its work."""
    y, f, sine, cosine = series[0], series[1], series[2], series[3]
    scale = 1.0
    for n in range(degree + 1):
        square[n] = turned = pressed = 0.0
        for i in range(n + 1):
            square[n] += (i + 1) * y[i + 1] * (n - i + 1) * y[n - i + 1]
        for i in range(n + 1):
            gained = (i + 1) * (i + 2) * y[i + 2]
            pressed += gained * sine[n - i] - square[i] * cosine[n - i]
            turned += gained * cosine[n - i] + square[i] * sine[n - i]
        normal[n] = scale * (series[-1][n] + 0.75 * pressed)
        tangential[n] = scale * (f[n] + 0.75 * turned)
        scale *= h


def watch_free(limits: FloatArray, law: Law, y: float, v: float) -> None:
    """Watch free rocking to the rest, or until the block passes alpha for good."""
    if len(limits) == 0:
        return
    if is_lost(law, y, v):
        forget_fall(limits)
        return
    energy, foot = 0.5 * v * v + work_to(law, y), y
    if v < 0.0:
        watch_swing(limits, law, energy, 0.0, y)
        energy, foot = energy * law.eta * law.eta, 0.0
    top = turning_rotation(law, energy)
    if top == math.inf:
        watch_swing(limits, law, energy, foot, law.alpha)
        return
    if energy > 0.0:
        watch_swing(limits, law, energy, 0.0, top)
    # in smaller swings N is larger, and so is T/N where T < 0: largest in the last and least one
    if energy * law.eta > 0.0:
        watch(limits, law, 1.0, 0.0, 0.0, 0.0)


def watch_swing(limits: FloatArray, law: Law, energy: float, foot: float, top: float) -> None:
    """Watch a free block between the rotations `foot` and `top`; at 0 it has kinetic `energy`.

    With c = cos z, s = sin z and E = c where the block turns, v^2 = 2 (E - c), so that
    N = 1/4 - 3/2 E c + 9/4 c^2 and T = 3/4 s (2 E - 3 c). N is least at c = E/3, T/N extreme at
    the roots of 33 c^2 - 38 E c + 12 E^2 - 3, or at an end.
    """
    first, last = math.cos(law.alpha - foot), math.cos(law.alpha - top)
    low, high = min(first, last), 1.0 if foot < law.alpha < top else max(first, last)
    turn = math.cos(law.alpha) + energy
    spread = math.sqrt(max(99.0 - 35.0 * turn * turn, 0.0))
    roots = (19.0 * turn - spread) / 33.0, (19.0 * turn + spread) / 33.0
    for place in (low, high, turn / 3.0, roots[0], roots[1]):
        c = min(max(place, low), high)
        normal = 0.25 + c * (2.25 * c - 1.5 * turn)
        tangential = 0.75 * math.sqrt(1.0 - c * c) * (2.0 * turn - 3.0 * c)
        keep(limits, normal, tangential)
