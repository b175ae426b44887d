"""The block: its dimensions and what follows from them."""

import math
from dataclasses import dataclass

from analytic.checks import LEAST, measurable, within

GRAVITY = 9.81
"""g [m/s2] of every block, amplitude and record: rounded, not the standard gravity of 9.80665."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Upright:
    """A homogeneous rectangular block that stands on its base, and what its sizes alone say.

    B, H [m] and g [m/s2] must be positive, and floating point must hold their squares and that of
    alpha; a ValueError says what is not.
    """

    width: float
    height: float
    gravity: float = GRAVITY

    def __post_init__(self) -> None:
        for name in ("width", "height", "gravity"):
            object.__setattr__(self, name, measurable(name, getattr(self, name)))
        if not LEAST <= self.alpha < 0.5 * math.pi:
            raise ValueError(
                f"width is {self.width!r} and height {self.height!r}; alpha, which follows as"
                f" {self.alpha!r}, must be from {LEAST:g} to below pi/2"
            )

    @property
    def alpha(self) -> float:
        """Slenderness angle atan(B/H) [rad]; also the critical rotation."""
        return math.atan2(self.width, self.height)

    @property
    def R(self) -> float:  # noqa: N802
        """Half of the diagonal [m]."""
        return 0.5 * math.hypot(self.width, self.height)

    @property
    def p(self) -> float:
        """Frequency parameter sqrt(3g / 4R) [rad/s] of the block alone."""
        return math.sqrt(0.75 * self.gravity / self.R)


@dataclass(frozen=True, slots=True, kw_only=True)
class RigidBlock(Upright):
    """A homogeneous rectangular rigid block, free-standing on a rigid base.

    Parameters
    ----------
    width, height : float
        Full dimensions B and H [m].
    gravity : float, optional
        g [m/s2].
    restitution : float, optional
        Ratio of the angular velocities after and before an impact, in [0, 1]. The default is
        Housner's value for an ideally inelastic impact, 1 - 3/2 sin(alpha)^2, or 0 where that is
        not positive: such a squat block comes to rest at its first impact.

    Raises
    ------
    ValueError
        If a dimension or gravity is not positive and finite, or the restitution is outside [0, 1];
        also if a dimension, gravity or alpha is not of a size whose square floating point holds.

    Examples
    --------
    >>> block = RigidBlock(width=0.5, height=1.5)
    >>> round(block.alpha, 4), round(block.p, 4), block.restitution
    (0.3218, 3.0507, 0.85)
    """

    restitution: float = None  # type: ignore[assignment]  # a number once it is made

    def __post_init__(self) -> None:
        Upright.__post_init__(self)
        usual = housner_restitution(self.alpha)
        object.__setattr__(self, "restitution", restitution_or(self.restitution, usual))


def restitution_or(given: float | None, usual: float) -> float:
    """Return a velocity ratio as it is given, or the usual one, 0 if that is negative, for None."""
    return max(usual, 0.0) if given is None else within("restitution", given, 0.0, 1.0)


def housner_restitution(alpha: float) -> float:
    """Velocity ratio of an ideally inelastic impact, 1 - 3/2 sin(alpha)^2 (Housner 1963).

    Angular momentum about the new corner is conserved (EQUATIONS.md, "Impact"). Not clipped: it is
    negative where sin(alpha)^2 > 2/3.

    Examples
    --------
    >>> round(housner_restitution(0.25), 4)
    0.9082
    """
    return 1.0 - 1.5 * math.sin(alpha) ** 2
