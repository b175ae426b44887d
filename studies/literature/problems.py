"""What a printed problem is, by the kind of quantity that was printed.

A printed number is kept as it was printed, so that its digits are known.
"""

import math
from dataclasses import dataclass, field, replace

from analytic.block import RigidBlock
from analytic.motion import Motion, SinePulse


@dataclass(frozen=True, slots=True, kw_only=True)
class Printed:
    """A printed number, or a bracket of two.

    Attributes
    ----------
    words : tuple of str
        As printed; two if the print says "not at the first, but at the second".
    """

    words: tuple[str, ...]

    @property
    def bounds(self) -> tuple[float, float]:
        """The interval that the print allows: the bracket, or what rounds to the digits."""
        low, high = float(self.words[0]), float(self.words[-1])
        if len(self.words) == 2:
            return low, high
        half = 0.5 * 10.0 ** -len(self.words[0].partition(".")[2])
        return low - half, high + half

    def miss(self, value: float) -> float:
        """Return how far outside the bounds a value is, relative to the bound; 0 if inside."""
        low, high = self.bounds
        return max(low / value - 1.0, value / high - 1.0, 0.0) if value > 0.0 else math.nan

    def __str__(self) -> str:
        return " to ".join(self.words)


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """A printed problem.

    Attributes
    ----------
    name : str
    work, where : str
        Who printed it, and the place in it.
    quantity : str
        What was printed, with its unit.
    model : str
        The model that the print is about.
    block : RigidBlock
        With the printed velocity ratio at impacts.
    pulse : Motion
    printed : tuple of Printed
        One number, or two: for either side of the block, or a time and a rate.
    measured : tuple of str
        What an experiment beside it measured, as printed.
    start : tuple of float
        theta [rad] and its rate [rad/s].
    friction : float or None
        For an engine, where it is not its own.
    why : str
        Why the print and the model of the print disagree, where they do.
    """

    name: str
    work: str
    where: str
    quantity: str
    model: str
    block: RigidBlock
    pulse: Motion
    printed: tuple[Printed, ...]
    measured: tuple[str, ...] = ()
    start: tuple[float, float] = field(default=(0.0, 0.0))
    friction: float | None = None
    why: str = ""

    @property
    def ideal(self) -> bool:
        """Whether the velocity ratio is that of an ideally inelastic impact, as in an engine."""
        plain = replace(self.block, restitution=None)  # type: ignore[arg-type]
        return math.isclose(self.block.restitution, plain.restitution, rel_tol=1e-12)


@dataclass(frozen=True, slots=True, kw_only=True)
class Shaken(Problem):
    """A problem whose motion is a sine."""

    pulse: SinePulse


class SteadyState(Shaken):
    """Largest rotations to either side [deg], the larger first, once the response repeats."""


class Cascade(Shaken):
    """Number of forcing periods after which the response repeats; none within reach is chaos."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Threshold(Shaken):
    """Amplitude at which the outcome changes, near the printed one.

    Attributes
    ----------
    unit_g : float
        The unit of the printed amplitude [g].
    shift : float
        Relative change of the frequency with which the print comes out, where it does not as it is.
    """

    unit_g: float = 1.0
    shift: float = 0.0

    def at(self, amplitude: float) -> SinePulse:
        """Return the pulse of an amplitude in the printed unit."""
        return replace(self.pulse, amplitude=amplitude * self.unit_g * self.block.gravity)


class ModeEnd(Problem):
    """Frequency ω/p beyond which no amplitude overturns the block after one impact."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OrbitLimit(Shaken):
    """Amplitude over α g at which a symmetric orbit is born, or loses its stability.

    Attributes
    ----------
    half_periods : int
        Of the shaking, in a swing.
    birth : bool
    """

    half_periods: int
    birth: bool


class Drop(Problem):
    """Time [s] and rate [rad/s] at which a released block without friction strikes its base."""


class Restitution(Problem):
    """Velocity ratio of the first impact after a release, over Housner's value, in a test."""


def number(*words: str) -> Printed:
    """Return a printed number, or the bracket of two."""
    return Printed(words=words)
