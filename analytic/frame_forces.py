"""The forces of a rocking frame, and what its reference asks of contacts, friction and beam.

The motion of a frame takes for granted that nothing slides, that every contact presses, and that
the beam stays on all columns. With z = alpha - abs(theta) and s = sgn(theta) the beam moves with
the corners that it rests on, 2R from the pivots, and a column's centre R from its pivot. Along
gravity's direction and the base's they need, over weight (EQUATIONS.md, "The rocking frame"),

    V = 1 + (l/g) [abs(theta)'' sin z - theta'^2 cos z],
    U = u''/g + s (l/g) [abs(theta)'' cos z + theta'^2 sin z],     l = 2R (beam), R (column).

The columns, at x_i from the middle, balance the moment of V and U about the beam's centre. Beside
an equal share each bears a force c x_i along its diagonal, which does not turn it. For N = 2 there
is no other balance; for more columns it is the one that spreads least. At rest, on two
corners each, equal shares will do.
At an impact the same holds of impulses, whose U/V is cot(alpha) (1 - eta)/(1 + eta), at the bases
and at the tops.
"""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from analytic.checks import positive
from analytic.frame import RockingFrame
from analytic.motion import FloatArray, Motion
from analytic.response import Outcome, Response
from analytic.simulate import simulate
from analytic.start import REST

SAMPLES = 4000
"""States looked at between begin and end of a response, beside those of its impacts."""
FREE_TIME = 8.0
"""Time [1/p] of free rocking that is looked at, beside the last and least swing."""
TINY = 1e-12
"""Rotation over alpha that stands for one side of an upright column."""


class Demands(NamedTuple):
    """Largest horizontal/vertical of feet and heads, least vertical/weight, least spacing [m]."""

    base: float
    top: float
    pressing: float
    spacing: float


NOTHING_ASKED = Demands(base=0.0, top=0.0, pressing=1.0, spacing=0.0)


def frame_demands(
    frame: RockingFrame,
    motion: Motion,
    start: tuple[float, float] = REST,
    *,
    spacing: float,
    depth: float,
) -> Demands:
    """Return what the exact response of a frame, as of `simulate`, asks of its contacts.

    Parameters
    ----------
    spacing, depth : float
        Distance of the columns' middles, and depth of the beam [m].

    Notes
    -----
    From SAMPLES states up to FREE_TIME after the motion, all impacts and, of a frame that survives,
    its last swing. Of one that overturns the forces count while abs(theta) is below alpha; one that
    starts beyond asks for nothing.

    Examples
    --------
    >>> frame = RockingFrame(width=0.5, height=1.5, load=2.0)
    >>> pulse = SinePulse.in_g(0.5, omega=9.0)
    >>> round(frame_demands(frame, pulse, spacing=2.0, depth=0.2).base, 3)
    0.353
    """
    spacing, depth = positive("spacing", spacing), positive("depth", depth)
    until = motion.duration + FREE_TIME / frame.p
    times = np.linspace(0.0, until, SAMPLES)
    response = simulate(frame, motion, start=start, duration=until, times=times)
    needs = [_demands(frame, *push, spacing, depth) for push in _pushes(frame, motion, response)]
    base, top, pressing, wide = zip(*needs or [NOTHING_ASKED], strict=True)
    return Demands(max(base), max(top), min(pressing), max(wide))


class Push(NamedTuple):
    """Forces over m_c g, or impulses, of a column and its share of the beam (see above)."""

    side: FloatArray
    z: FloatArray
    column: FloatArray
    column_across: FloatArray
    beam: FloatArray
    beam_across: FloatArray


def _pushes(frame: RockingFrame, motion: Motion, response: Response) -> Iterator[tuple[Push, bool]]:
    """Yield the forces of a response and False; where it has impacts, their impulses and True."""
    if response.outcome is Outcome.FAILED or response.history is None:
        raise ValueError(f"the response of the frame failed: {response.message}")
    history = response.history
    time, theta, rate = history.time, history.theta, history.velocity
    struck, before, after = np.array(response.impacts).reshape(-1, 3).T
    last = np.full(int(response.outcome is Outcome.ROCKED), TINY * frame.alpha)
    sides = TINY * frame.alpha * np.sign(np.concatenate((-before, after)))
    shaken = motion.acceleration(np.concatenate((time, struck, struck)))
    states = (
        np.concatenate((theta, sides, last)),
        np.concatenate((rate, before, after, 0.0 * last)),
        np.concatenate((shaken, 0.0 * last)),
    )
    kept = np.abs(states[0]) < frame.alpha
    if kept.any():
        yield _forces(frame, *(part[kept] for part in states)), False
    if struck.size:
        yield _impulses(frame, np.sign(before[:1])), True


def _forces(frame: RockingFrame, theta: FloatArray, rate: FloatArray, ground: FloatArray) -> Push:
    g, side, z = frame.gravity, np.sign(theta), frame.alpha - np.abs(theta)
    a = ground / g
    sine, cosine = np.sin(z), np.cos(z)
    speed = np.where(side == 0.0, 0.0, -(frame.p**2) * (sine + side * a * cosine))

    def over_weight(lever: float) -> tuple[FloatArray, FloatArray]:
        scale = lever / g
        vertical = 1.0 + scale * (speed * sine - rate**2 * cosine)
        return vertical, a + side * scale * (speed * cosine + rate**2 * sine)

    column, across = over_weight(frame.R)
    beam, beam_across = over_weight(2.0 * frame.R)
    return Push(side, z, column, across, frame.load * beam, frame.load * beam_across)


def _impulses(frame: RockingFrame, side: FloatArray) -> Push:
    """Return the impulses, at its new pivots, of an impact of unit rate onto a side."""
    alpha, eta = frame.alpha, frame.restitution
    vertical = np.full(1, math.sin(alpha) * (1.0 + eta))
    across = -side * math.cos(alpha) * (1.0 - eta)
    beam = 2.0 * frame.load
    return Push(side, np.full(1, alpha), vertical, across, beam * vertical, beam * across)


def _demands(
    frame: RockingFrame, push: Push, impulses: bool, spacing: float, depth: float
) -> Demands:
    n, half = frame.columns, 0.5 * (frame.columns - 1)
    places = (np.arange(n)[:, None] - half) * spacing
    overhang = -0.5 * push.side * frame.width
    leaned = 0.5 * depth * push.beam_across * np.abs(push.side)
    moment = n * (push.beam * overhang + leaned)
    along = -moment / (np.cos(push.z) * np.sum(places**2)) * places
    top, top_across = push.beam + along * np.cos(push.z), -push.side * np.sin(push.z) * along
    top_across = top_across + push.beam_across
    base, base_across = top + push.column, top_across + push.column_across
    with np.errstate(all="ignore"):
        lean = np.max(np.abs(push.beam_across / push.beam))
    share = push.beam if impulses else np.full(1, frame.load)
    pressing = min(np.min(top / share), np.min(base / (share * (1.0 + 1.0 / frame.load))))
    return Demands(
        base=_ratio(base_across, base),
        top=_ratio(top_across, top),
        pressing=math.inf if impulses and pressing > 0.0 else float(pressing),
        spacing=float((frame.width + lean * depth) / (2.0 * half)),
    )


def _ratio(across: FloatArray, vertical: FloatArray) -> float:
    """Return the largest abs(across)/vertical; inf where a vertical one does not press."""
    with np.errstate(all="ignore"):
        return float(np.max(np.where(vertical > 0.0, np.abs(across) / vertical, math.inf)))
