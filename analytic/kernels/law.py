"""What kernels are told of a model and a start, and what they write down on the way.

In all kernels the rotation is folded to the side s = sign(theta) on which the block stands, -1 or
1, so that y = s theta > 0. With z = alpha - y and the ground acceleration a (EQUATIONS.md,
"From (1) and (2)"; names as in `analytic.models`),

    y'' = -k^2 [sin z + s a cos z],    of a linear model  y'' = -k^2 [c - y + s q a].

Each side has a law of its own; the two are equal unless the mass stands off the middle.

Units are those of p and g: rotations in rad, times (tau, h) in 1/p, the rate v of y in rad p,
energies ("work") v^2/2 in p^2, accelerations a and f = s a in g. A segment, shape (7,), is a row
of `motion.SEGMENT_COLUMNS` in them: start, end [1/p], amplitude [g], omega [p], phase [rad], offset
[g], slope [g p]; where the base moves vertically too, seven more are of its acceleration upwards. A
ground motion is segments, of which j is the number of one. A series is an array of coefficients
c[i] of sum c[i] t^i, of a degree `order`.

A step of length h goes from a state `begin`, where the first `lead` coefficients of y are zero. Its
part x is in [0, 1], and d[i] are the coefficients of y in x. The rows of `work`, of order + 1
numbers or more, are the series of y, f, sin z and cos z, then d, and in the last one that of the
weight over m g; from 5 on they are spare, and MAX_DEPTH + 3 rows or more suffice for any `work`
that is not a step's.
"""

from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

UPLIFT, IMPACT, RESTED = 0.0, 1.0, 2.0
"""Kinds of events."""


class Law(NamedTuple):
    """A model of a block on one of its sides, named as in `analytic.models`; factor is q.

    The onset [g] lifts the block onto this side; eta is the ratio of the impact that leaves it.
    """

    linear: bool
    k: float
    saddle: float
    factor: float
    alpha: float
    onset: float
    eta: float


Laws: TypeAlias = tuple[Law, Law]
"""Those of the right side, theta > 0, and of the left one."""


def law_of(laws: Laws, side: float) -> Law:
    """Return the law of a side; of a block at rest, the right one's."""
    return laws[1] if side < 0.0 else laws[0]


class Start(NamedTuple):
    """The side that a block is on, or turns to from upright, 0 at rest; y = s theta; its rate."""

    side: float
    y: float
    v: float


UPRIGHT = Start(0.0, 0.0, 0.0)
"""A block at rest on its base."""


class State(NamedTuple):
    """Where a block is; y grows as t^lead: 1 out of an impact, 2 or 3 out of an uplift, else 0."""

    side: float
    tau: float
    lead: int
    y: float
    v: float


class Notes(NamedTuple):
    """What to write down: theta and rate (2, n) at times (n,), events, limits; each may be empty.

    A row of the log (capacity, 4) is an event's kind, time, and velocities before and after.
    """

    times: FloatArray
    samples: FloatArray
    log: FloatArray
    limits: FloatArray


def note(log: FloatArray, n: int, kind: float, tau: float, before: float, after: float) -> int:
    """Write an event into the log if it has room; return the number of events so far."""
    if n < log.shape[0]:
        log[n, 0], log[n, 1], log[n, 2], log[n, 3] = kind, tau, before, after
    return n + 1


def sample_still(notes: Notes, until: float, n: int, theta: float, rate: float) -> int:
    """Sample a state that lasts up to a time; return the number of samples so far."""
    while n < len(notes.times) and notes.times[n] <= until:
        notes.samples[0, n], notes.samples[1, n] = theta, rate
        n += 1
    return n
