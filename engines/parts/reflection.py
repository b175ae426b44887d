"""How much of its velocity a pivot is given back, so that its mean over a step is zero.

A pivot is back where it was at the end of a step h if it leaves with -c h/2, c being its
centripetal acceleration, in proportion to the square of the angular velocity; it comes into the
next step with c h/2, or with c h if it was held and not returned before. Through an impact, and in
the first step after it, nothing is given back.
"""

from engines.scene import Scene
from engines.world import Grip, Step

MOST_REFLECTION = 25.0
"""No more than this part of the velocity with which a contact comes into a step is returned: after
a far shorter step that is noise."""

MOST_GROWTH = 20.0
"""Where the block hardly turns, by how much faster it will turn is noise: a contact's velocity is
returned as if it grew by no more than this many p dt in a step."""

RELEASED_GROWTH = 80.0
"""A released block gains speed steadily, so that it is known from earlier on how fast: nothing is
returned until it grows by no more than this many p dt in a step. Any later, and the time until then
is one without return, an error of first order."""

MOST_RETURNED = 2.0
"""Where the base's own velocity gives the pivot's back, a step that is much longer than the one
before returns no more than this part."""


def returned(step: Step, before: float) -> float:
    """Return the part of a pivot's velocity to give back, after a step of `before` [s].

    For a contact that has taken in all other velocities by the end of each step: what the pivot
    then has, it got by the turn of the last one.
    """
    if not (before and step.side and step.grip in (Grip.SWING, Grip.APPROACH)):
        return 0.0
    return min(step.dt_s / before, MOST_RETURNED)


class Reflection:
    """Part of a pivot's velocity that is returned with a change of sign, step by step.

    Parameters
    ----------
    scene : Scene
        What is being simulated.
    dt_s : float
        Ordinary step [s].
    """

    def __init__(self, scene: Scene, dt_s: float) -> None:
        self._rate, self._gained = scene.beginning.rate, 0.0
        self._aloft, self._released = False, bool(scene.side)
        self._part = self._last_dt = 0.0
        self._growth = 1.0 + MOST_GROWTH * scene.block.p * dt_s
        self._steady = 1.0 + RELEASED_GROWTH * scene.block.p * dt_s

    def part(self, step: Step) -> float:
        """Return the part of the velocity with which the pivot comes into a step."""
        before, self._last_dt = self._last_dt, step.dt_s
        was_aloft, self._aloft = self._aloft, step.grip in (Grip.SWING, Grip.APPROACH)
        self._released = self._released and self._aloft
        self._part = self._returned(step, before) if was_aloft and self._aloft else 0.0
        return self._part

    def see(self, step: Step, rate: float) -> None:
        """Take in the angular velocity [rad/s] of a step."""
        before, self._rate = self._rate, rate
        self._gained = (rate - before) / step.kick_s

    def _returned(self, step: Step, before: float) -> float:
        if not self._rate:
            return 0.0
        faster = 1.0 + self._gained * step.kick_s / self._rate
        growth = faster * faster
        if self._released and growth > self._steady:
            # what is returned too soon would stay in it
            return 0.0
        part = min(growth, self._steady if self._released else self._growth) * step.dt_s / before
        return min(part if self._part else 0.5 * part, MOST_REFLECTION)
