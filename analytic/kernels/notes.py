"""What is written down of a response on its way: samples, events and contact forces.

Symbols and units are those of `analytic.kernels.law`.
"""

from typing import NamedTuple

from analytic.kernels.compiled import inner
from analytic.kernels.law import FloatArray

UPLIFT, IMPACT, RESTED, START = 0.0, 1.0, 2.0, 3.0
"""Kinds of events."""


class Notes(NamedTuple):
    """What to write down on the way; each array may be empty.

    times (n,) and samples (2, n): where to sample theta and its rate, and the samples. log
    (capacity, 4): kind, time, velocity before, velocity after; of an uplift the lead, and of a
    start off rest the rotation, in place of the velocity before. limits (4,): the contact
    forces, as in `analytic.kernels.forces`.
    """

    times: FloatArray
    samples: FloatArray
    log: FloatArray
    limits: FloatArray


@inner
def note(log: FloatArray, n: int, kind: float, tau: float, before: float, after: float) -> int:
    """Write an event into the log if it has room; return the number of events so far.

    Parameters
    ----------
    log : ndarray (capacity, 4), columns as in `Notes`
    n : int, number of events before this one
    kind : float, UPLIFT, IMPACT, RESTED or START
    tau : float, its time [1/p]
    before, after : float, velocities s v [rad p], or what `Notes` says
    """
    if n < log.shape[0]:
        log[n, 0] = kind
        log[n, 1] = tau
        log[n, 2] = before
        log[n, 3] = after
    return n + 1


@inner
def sample_rest(notes: Notes, until: float, n: int) -> int:
    """Sample a rest up to a time; return the number of samples so far.

    Parameters
    ----------
    notes : Notes, whose samples are written
    until : float, end of the rest [1/p]
    n : int, number of samples before
    """
    while n < len(notes.times) and notes.times[n] <= until:
        notes.samples[0, n] = notes.samples[1, n] = 0.0
        n += 1
    return n
