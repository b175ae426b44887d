"""The block on a cart: a base that feels the block."""

import math
from dataclasses import dataclass

from analytic.block import Upright
from analytic.checks import finite


@dataclass(frozen=True, slots=True, kw_only=True)
class CartBlock(Upright):
    """A free-standing block on a cart that rolls freely, or is held by a spring.

    The cart is pushed by the force (m + M) u'', u'' being the acceleration of the motion: a heavy
    cart then moves as the base of a block does.

    Parameters
    ----------
    width, height : float
        Full dimensions B and H of the block [m].
    mass_ratio : float
        m/(m + M), the block's part of the whole mass, between 0 and 1.
    stiffness : float, optional
        That of the spring over the whole mass, k/(m + M) [1/s2]; 0 for a cart that rolls freely.
    gravity : float, optional
        g [m/s2].

    Raises
    ------
    ValueError
        If the ratio is not between 0 and 1, the stiffness negative or not finite, or a number not
        what `RigidBlock` takes.

    Examples
    --------
    >>> block = CartBlock(width=0.5, height=1.5, mass_ratio=0.1)
    >>> pulse = SinePulse.in_g(0.5, omega=9.0)
    >>> float(round(simulate(block, pulse).peak_ratio, 4))
    0.1082
    """

    mass_ratio: float
    stiffness: float = 0.0

    def __post_init__(self) -> None:
        Upright.__post_init__(self)
        object.__setattr__(self, "mass_ratio", finite("mass_ratio", self.mass_ratio))
        object.__setattr__(self, "stiffness", finite("stiffness", self.stiffness))
        if not 0.0 < self.mass_ratio < 1.0:
            raise ValueError(f"mass_ratio is {self.mass_ratio!r}; it must be between 0 and 1")
        if self.stiffness < 0.0:
            raise ValueError(f"stiffness is {self.stiffness!r}; it must not be negative")

    @property
    def restitution(self) -> float:
        """Ratio of the angular velocities after and before an impact, 0 where it is negative.

        (1/3 + cos(2 alpha) - m~ cos(alpha)^2)/(4/3 - m~ cos(alpha)^2), ideally inelastic
        (EQUATIONS.md, "The block on a cart").
        """
        given = self.mass_ratio * math.cos(self.alpha) ** 2
        kept = 1.0 / 3.0 + math.cos(2.0 * self.alpha) - given
        return max(kept / (4.0 / 3.0 - given), 0.0)
