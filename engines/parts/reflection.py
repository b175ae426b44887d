"""How much of its velocity a pivot is given back, so that its mean over a step is zero.

The centripetal acceleration c of a pivot is in proportion to the square of the angular velocity. A
pivot that leaves with -c h/2 is back where it was at the end of a step h. It comes into the next
step with c h/2, or with c h if it was held and not returned before. Through an impact, and in the
first step after it, nothing is given back.
"""

from engines.parts.compiled import State, fill, shared
from engines.scene import Scene
from engines.world import ContactPhase, Step

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
    """Return the part of a pivot's velocity to give back.

    For a contact that has taken in all other velocities by the end of each step: what the pivot
    then has, it got by the turn of the last one.

    Parameters
    ----------
    step : Step, that follows
    before : float, length of the step before it [s]; 0 where there was none
    """
    if not (before and step.side and step.phase in (ContactPhase.SWING, ContactPhase.APPROACH)):
        return 0.0
    return min(step.dt_s / before, MOST_RETURNED)


class Reflection(State):
    """Part of a pivot's velocity that is returned with a change of sign, step by step.

    Attributes
    ----------
    growth, steady : float
        By how much the velocity may grow in a step, and where the block was released.
    aloft, released : bool
        Whether the last step was of a swing, and whether every step since a release was.
    rate, gained : float
        The last angular velocity [rad/s], and what it gained [rad/s2].
    last_dt, part : float
        Of the last step: its length [s], and the part that it returned.
    """

    growth: float
    steady: float
    aloft: bool
    released: bool
    rate: float
    gained: float
    last_dt: float
    part: float


def begin_reflection(state: Reflection, scene: Scene, dt_s: float) -> None:
    """Prepare for a scene.

    Parameters
    ----------
    state : Reflection, to be filled
    scene : Scene
    dt_s : float, ordinary step [s]
    """
    fill(
        state,
        growth=1.0 + MOST_GROWTH * scene.system.p * dt_s,
        steady=1.0 + RELEASED_GROWTH * scene.system.p * dt_s,
        released=bool(scene.side),
        rate=scene.bodies[0].at.rate,
    )


@shared
def part_of(state: Reflection, step: Step) -> float:
    """Return the part to give back of the velocity with which the pivot comes into a step.

    Parameters
    ----------
    state : Reflection, updated
    step : Step, that follows
    """
    before, state.last_dt = state.last_dt, step.dt_s
    was_aloft = state.aloft
    state.aloft = step.phase == ContactPhase.SWING or step.phase == ContactPhase.APPROACH
    state.released = state.released and state.aloft
    state.part = part_returned(state, step, before) if was_aloft and state.aloft else 0.0
    return state.part


@shared
def part_returned(state: Reflection, step: Step, before: float) -> float:
    """Return that part in a swing, after a step of `before` [s]."""
    if state.rate == 0.0:
        return 0.0
    faster = 1.0 + state.gained * step.kick_s / state.rate
    growth = faster * faster
    if state.released and growth > state.steady:
        # what is returned too soon would stay in it
        return 0.0
    most = state.steady if state.released else state.growth
    part = min(growth, most) * step.dt_s / before
    return min(part if state.part != 0.0 else 0.5 * part, MOST_REFLECTION)


@shared
def take_in(state: Reflection, step: Step, rate: float) -> None:
    """Take in how fast the block turns after a step.

    Parameters
    ----------
    state : Reflection, updated
    step : Step, that was taken
    rate : float, angular velocity after it [rad/s]
    """
    before, state.rate = state.rate, rate
    state.gained = (rate - before) / step.kick_s
