"""The sliding block: so squat, or on a base so smooth, that it slides and never tips."""

import math
from dataclasses import dataclass

from analytic.block import GRAVITY
from analytic.checks import measurable


@dataclass(frozen=True, slots=True, kw_only=True)
class SlidingBlock:
    """A rectangular rigid block that slides flat on its base, by Coulomb's friction.

    Parameters
    ----------
    width, height : float
        Full dimensions B and H [m]; they only say that the block does not tip.
    friction : float
        Coefficient mu, static and kinetic, below B/H.
    gravity : float, optional
        g [m/s2]; on an incline beta, g cos(beta), with g sin(beta) as acceleration of the base.

    Raises
    ------
    ValueError
        If a number is not positive and finite, or the friction is B/H or more: the block would tip.
    """

    width: float
    height: float
    friction: float
    gravity: float = GRAVITY

    def __post_init__(self) -> None:
        for name in ("width", "height", "friction", "gravity"):
            object.__setattr__(self, name, measurable(name, getattr(self, name)))
        slender = self.width / self.height
        if not self.friction < slender:
            allowed = f"below width/height, {slender!r}, from which on the block tips"
            raise ValueError(f"friction is {self.friction!r}; it must be {allowed}")

    @property
    def alpha(self) -> float:
        """Slenderness angle atan(B/H) [rad]."""
        return math.atan2(self.width, self.height)

    @property
    def R(self) -> float:  # noqa: N802
        """Half of the diagonal [m]."""
        return 0.5 * math.hypot(self.width, self.height)

    @property
    def p(self) -> float:
        """Frequency parameter sqrt(3g / 4R) [rad/s] of the block, were it to rock."""
        return math.sqrt(0.75 * self.gravity / self.R)

    @property
    def limit(self) -> float:
        """The acceleration mu g [m/s2] beyond which the base leaves the block behind."""
        return self.friction * self.gravity
