"""The sliding block: so squat, or on a base so smooth, that it slides and never tips."""

from dataclasses import dataclass

from analytic.block import Upright
from analytic.checks import measurable


@dataclass(frozen=True, slots=True, kw_only=True)
class SlidingBlock(Upright):
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

    Examples
    --------
    >>> box = SlidingBlock(width=1.0, height=0.5, friction=0.2)
    >>> pulse = SinePulse(amplitude=3.924, omega=6.2832, half_cycles=2)
    >>> [round(slip, 4) for slip in simulate(box, pulse).slips]
    [-0.1258, 0.1321]
    """

    friction: float

    def __post_init__(self) -> None:
        Upright.__post_init__(self)
        object.__setattr__(self, "friction", measurable("friction", self.friction))
        slender = self.width / self.height
        if not self.friction < slender:
            allowed = f"below width/height, {slender!r}, from which on the block tips"
            raise ValueError(f"friction is {self.friction!r}; it must be {allowed}")

    @property
    def limit(self) -> float:
        """The acceleration mu g [m/s2] beyond which the base leaves the block behind."""
        return self.friction * self.gravity
