"""The rocking frame: a beam on two or more free-standing columns."""

import math
from dataclasses import dataclass

from analytic.block import RigidBlock, Side, Upright, restitution_or
from analytic.checks import finite, measurable

MOST_COLUMNS = 100
"""Columns of a frame: an engine holds a body for each."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RockingFrame(Upright):
    """Equal free-standing columns that carry a free beam; every contact can only press.

    The columns turn together and the beam moves without turning, whatever their distance; theta is
    the rotation of the columns. What takes a block takes a frame.

    Parameters
    ----------
    width, height : float
        Full dimensions B and H of a column [m].
    columns : int, optional
        N, from 2 to 100. The motion does not depend on it; of 3 or more columns other motions are
        possible too, in which one runs ahead of the beam.
    load : float
        gamma, the mass of the beam over that of all columns.
    gravity : float, optional
        g [m/s2].
    restitution : float, optional
        Ratio of the angular velocities after and before an impact, in [0, 1]. The default is that
        of an ideally inelastic one, or 0 where that is negative (`frame_restitution`).

    Raises
    ------
    ValueError
        If columns is not a whole number from 2 to 100, the load not positive and finite, or a
        number is not what `RigidBlock` takes.

    References
    ----------
    Makris and Vassiliou (2013), Earthquake Engineering and Structural Dynamics 42; EQUATIONS.md,
    "The rocking frame".

    Examples
    --------
    >>> frame = RockingFrame(width=0.5, height=1.5, columns=2, load=2.0)
    >>> round(frame.p, 4), round(frame.restitution, 4)
    (2.5783, 0.8071)
    """

    columns: int = 2
    load: float
    restitution: float = None  # type: ignore[assignment]  # a number once it is made

    def __post_init__(self) -> None:
        count = finite("columns", self.columns)
        if not 2 <= count <= MOST_COLUMNS or count != int(count):
            allowed = f"a whole number from 2 to {MOST_COLUMNS} (the beam of a single column turns)"
            raise ValueError(f"columns is {self.columns!r}; it must be {allowed}")
        object.__setattr__(self, "columns", int(count))
        object.__setattr__(self, "load", measurable("load", self.load))
        Upright.__post_init__(self)
        usual = frame_restitution(self.alpha, self.load)
        object.__setattr__(self, "restitution", restitution_or(self.restitution, usual))

    @property
    def p(self) -> float:
        """Frequency parameter [rad/s]: sqrt(3g/4R (1 + 2 gamma)/(1 + 3 gamma))."""
        growth = (1.0 + 3.0 * self.load) / (1.0 + 2.0 * self.load)
        return math.sqrt(0.75 * self.gravity / (self.R * growth))

    @property
    def sides(self) -> tuple[Side, Side]:
        """Both sides, which are alike."""
        return (Side(self.alpha, self.p, self.restitution),) * 2


Rocker = RigidBlock | RockingFrame
"""What rocks as a block does: alpha, p and the restitution say all of its motion."""


def frame_restitution(alpha: float, load: float) -> float:
    """Velocity ratio of an ideally inelastic impact of a frame, at the bases and tops at once.

    [1 - 3/2 sin(alpha)^2 + 3 gamma cos(2 alpha)]/(1 + 3 gamma); not clipped, as Housner's
    (EQUATIONS.md, "The rocking frame").

    Examples
    --------
    >>> frame_restitution(0.25, load=0.0) == housner_restitution(0.25)
    True
    """
    kept = 1.0 - 1.5 * math.sin(alpha) ** 2 + 3.0 * load * math.cos(2.0 * alpha)
    return kept / (1.0 + 3.0 * load)
