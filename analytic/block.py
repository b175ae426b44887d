"""The block: its dimensions and what follows from them."""

import math
from dataclasses import dataclass
from typing import NamedTuple

from analytic.checks import LEAST, finite, measurable, positive, within

GRAVITY = 9.81
"""g [m/s2] of every block, amplitude and record: rounded, not the standard gravity of 9.80665."""


class Side(NamedTuple):
    """A side of a body: alpha [rad], p [rad/s], and the velocity ratio at impacts that leave it."""

    alpha: float
    p: float
    restitution: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Upright:
    """What the sizes B, H [m] and g [m/s2] of a block say; ValueError if one is out of range."""

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
    offset : float, optional
        How far [m] the mass stands to the right of the middle, at half height, less than B/2.
        alpha, R and p are then those of the side with the smaller alpha, which overturns first, and
        the restitution is the root of the product of both sides' (`sides` has each).
    inertia : float, optional
        Central moment of inertia over mass [m2]; by default that of a homogeneous block, (B^2 +
        H^2)/12.

    Raises
    ------
    ValueError
        If a dimension or gravity is not positive and finite, or the restitution is outside [0, 1];
        also if a dimension, gravity or alpha is not of a size whose square floating point holds, if
        the offset is not below B/2, or a restitution is given for a block of unlike sides.

    Examples
    --------
    >>> block = RigidBlock(width=0.5, height=1.5)
    >>> round(block.alpha, 4), round(block.p, 4), block.restitution
    (0.3218, 3.0507, 0.85)
    """

    restitution: float = None  # type: ignore[assignment]  # a number once it is made
    offset: float = 0.0
    inertia: float | None = None

    def __post_init__(self) -> None:
        half = 0.5 * measurable("width", self.width)
        object.__setattr__(self, "offset", finite("offset", self.offset))
        if not abs(self.offset) < half:
            raise ValueError(f"offset is {self.offset!r}; it must be between -{half} and {half}")
        if self.inertia is not None:
            object.__setattr__(self, "inertia", positive("inertia", self.inertia))
        Upright.__post_init__(self)
        if self.restitution is not None and not self.is_even:
            words = "it must not be given for a block with an offset, which has two"
            raise ValueError(f"restitution is {self.restitution!r}; {words}")
        usual = housner_restitution(self.alpha)
        if not self.is_homogeneous:
            usual = math.sqrt(self._side(1.0).restitution * self._side(-1.0).restitution)
        object.__setattr__(self, "restitution", restitution_or(self.restitution, usual))

    @property
    def alpha(self) -> float:
        """Slenderness angle [rad], the smaller one of two; also the critical rotation."""
        return math.atan2(self.width - 2.0 * abs(self.offset), self.height)

    @property
    def R(self) -> float:  # noqa: N802
        """Distance [m] from the corner with the smaller slenderness to the centre of mass."""
        return 0.5 * math.hypot(self.width - 2.0 * abs(self.offset), self.height)

    @property
    def p(self) -> float:
        """Frequency parameter [rad/s] about that corner: sqrt(3g / 4R) of a homogeneous block."""
        if self.is_homogeneous:
            return math.sqrt(0.75 * self.gravity / self.R)
        return self._side(math.copysign(1.0, self.offset)).p

    @property
    def is_even(self) -> bool:
        """Whether both sides are alike."""
        return self.offset == 0.0

    @property
    def is_homogeneous(self) -> bool:
        """Whether its mass is spread evenly."""
        return self.is_even and self.inertia is None

    @property
    def sides(self) -> tuple[Side, Side]:
        """The right side, theta > 0, and the left one."""
        if self.is_even:
            return (Side(self.alpha, self.p, self.restitution),) * 2
        return self._side(1.0), self._side(-1.0)

    def _side(self, sign: float) -> Side:
        """Return a side by the momentum about its corner and, at an impact, about the other one."""
        here, up = 0.5 * self.width - sign * self.offset, 0.5 * self.height
        there = self.width - here
        square = self.inertia or (self.width**2 + self.height**2) / 12.0
        lever = math.hypot(here, up)
        p = math.sqrt(self.gravity * lever / (square + lever * lever))
        kept = (square + up * up - here * there) / (square + up * up + there * there)
        return Side(math.atan2(here, up), p, max(kept, 0.0))


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
