"""How much of its velocity a pivot is given back, so that its mean over a step is zero.

The centripetal acceleration c of a pivot is in proportion to the square of the angular velocity. A
pivot that leaves with -c h/2 is back where it was at the end of a step h. It comes into the next
step with c h/2, or with c h if it was held and not returned before. Through an impact, and in the
first step after it, nothing is given back.
"""

from engines.world import ContactPhase, Step

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
