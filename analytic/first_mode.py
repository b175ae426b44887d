"""What a block at rest does first when its base is accelerated suddenly (Shenton 1996)."""

import enum

from analytic.checks import finite, positive


class FirstMode(enum.Enum):
    """What a block at rest does in the first instants of a sudden acceleration."""

    REST = "rest"
    SLIDE = "slide"
    ROCK = "rock"
    SLIDE_AND_ROCK = "slide and rock"


def rocking_friction(amplitude_g: float, aspect: float) -> float:
    """Return the friction with which a block rocks without sliding from its first instant.

    [a (4 + lambda^2) + 3 lambda]/[1 + 4 lambda^2 + 3 a lambda]: horizontal over normal force at the
    corner of a block that lifts under the acceleration a (EQUATIONS.md, "The first mode").

    Parameters
    ----------
    amplitude_g : float
        a, above 1/lambda [g].
    aspect : float
        lambda = H/B.

    Examples
    --------
    >>> round(rocking_friction(0.4, aspect=3.0), 4)
    0.3498
    """
    needed = amplitude_g * (4.0 + aspect * aspect) + 3.0 * aspect
    return needed / (1.0 + aspect * (4.0 * aspect + 3.0 * amplitude_g))


def first_mode(amplitude_g: float, friction: float, aspect: float) -> FirstMode:
    """Return the first mode of a block at rest.

    Parameters
    ----------
    amplitude_g : float
        Sudden acceleration of the base [g], of either sign.
    friction : float
        Coefficient mu, static and kinetic.
    aspect : float
        H/B.

    Raises
    ------
    ValueError
        If the amplitude is not finite, or friction or aspect not positive and finite.

    Examples
    --------
    >>> first_mode(0.4, friction=0.3, aspect=3.0).value
    'slide'
    """
    a, mu = abs(finite("amplitude_g", amplitude_g)), positive("friction", friction)
    slender = 1.0 / positive("aspect", aspect)
    if a <= min(mu, slender):
        return FirstMode.REST
    if mu < slender:
        return FirstMode.SLIDE
    if mu >= rocking_friction(a, aspect):
        return FirstMode.ROCK
    return FirstMode.SLIDE_AND_ROCK
