"""Printed problems: who printed what about which block, to how many digits.

A printed number is kept as it was printed, so that its digits are known. Half-widths are doubled
here; amplitudes of pulses are in g, angles in radians but where a unit is named.
"""

import math
from dataclasses import dataclass, field, replace

from analytic.block import STANDARD_GRAVITY, RigidBlock
from analytic.motion import SinePulse

HOGAN = "Hogan, 10th World Conference on Earthquake Engineering, 1992, pp. 3973-3977"
ZHANG = "Zhang and Makris, Rocking response of free-standing blocks under cycloidal pulses, 2001"
ROUSSOS = "Makris and Roussos, Géotechnique 50(3), 2000, pp. 243-262"
PEER = "PEER report 2001/07"

COSINE = 0.5 * math.pi
"""Phase [rad] of a cosine."""


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
    pulse : SinePulse
    printed : tuple of Printed
        One number, or one for either side of the block.
    measured : tuple of str
        What an experiment beside it measured, as printed.
    start : tuple of float
        theta [rad] and its rate [rad/s].
    """

    name: str
    work: str
    where: str
    quantity: str
    model: str
    block: RigidBlock
    pulse: SinePulse
    printed: tuple[Printed, ...]
    measured: tuple[str, ...] = ()
    start: tuple[float, float] = field(default=(0.0, 0.0))

    @property
    def ideal(self) -> bool:
        """Whether the velocity ratio is that of an ideally inelastic impact, as in an engine."""
        plain = replace(self.block, restitution=math.nan)
        return math.isclose(self.block.restitution, plain.restitution, rel_tol=1e-12)


class SteadyState(Problem):
    """Largest rotations to either side [deg], the larger first, once the response repeats."""


class Cascade(Problem):
    """Number of forcing periods after which the response repeats; none within reach is chaos."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Threshold(Problem):
    """Amplitude at which the outcome changes, near the printed one.

    Attributes
    ----------
    unit_g : float
        The unit of the printed amplitude [g].
    """

    unit_g: float = 1.0

    def at(self, amplitude: float) -> SinePulse:
        """Return the pulse of an amplitude in the printed unit."""
        return replace(self.pulse, amplitude=amplitude * self.unit_g * self.block.gravity)


class ModeEnd(Problem):
    """Frequency ω/p beyond which no amplitude overturns the block after one impact."""


def block_of(alpha: float, p: float, restitution: float = math.nan) -> RigidBlock:
    """Return the block of a slenderness [rad] and a frequency parameter [rad/s]."""
    diagonal = 1.5 * STANDARD_GRAVITY / p**2
    return RigidBlock(
        width=diagonal * math.sin(alpha),
        height=diagonal * math.cos(alpha),
        restitution=restitution,
    )


def shaken(block: RigidBlock, beta: float, omega_over_p: float, periods: int) -> SinePulse:
    """Return the motion β α g cos(ω t) during a number of periods."""
    return SinePulse(
        amplitude=beta * block.alpha * block.gravity,
        omega=omega_over_p * block.p,
        half_cycles=2 * periods,
        phase=COSINE,
    )


def number(*words: str) -> Printed:
    """Return a printed number, or the bracket of two."""
    return Printed(words=words)


STEADY_PERIODS = 400
"""Forcing periods after which a steady state is read."""

CASCADE_PERIODS = 4000
"""Forcing periods after which the period of an orbit is read."""

HOGAN_BLOCK = block_of(0.18, 2.0, 0.88)
CASCADE_BLOCK = block_of(math.atan(0.5), 2.0, 0.5)
ZHANG_BLOCK = block_of(0.25, 2.14, 0.9)
SQUAT_BLOCK = block_of(0.349, 2.14, 0.825)


def _steady(
    point: str, w: float, theory: str, experiment: str, start: tuple[float, float]
) -> SteadyState:
    block = HOGAN_BLOCK
    return SteadyState(
        name=f"steady state {point}",
        work=HOGAN,
        where=f"Table 1, point {point}",
        quantity="largest rotations to either side [deg]",
        model="exact",
        block=block,
        pulse=shaken(block, 2.0, w, STEADY_PERIODS),
        printed=tuple(number(word) for word in theory.split(" / ")),
        measured=tuple(experiment.split(" / ")),
        start=(start[0] * block.alpha, start[1] * block.alpha * block.p),
    )


def _cascade(beta: float, period: str) -> Cascade:
    block = CASCADE_BLOCK
    return Cascade(
        name=f"cascade, β = {beta:g}",
        work=HOGAN,
        where="period-doubling cascade",
        quantity="period of the orbit [forcing periods]",
        model="exact",
        block=block,
        pulse=shaken(block, beta, 2.0 * math.pi / 3.0, CASCADE_PERIODS),
        printed=(number(period),),
        start=(0.3 * block.alpha, 0.0),
    )


def _zhang(name: str, words: tuple[str, ...], model: str, omega: float, unit: str) -> Threshold:
    return Threshold(
        name=f"one sine, {model}, {name}",
        work=ZHANG,
        where="p = 2.14 rad/s, α = 0.25, η = 0.9",
        quantity=f"amplitude at an edge of overturning [{unit}]",
        model=model,
        block=ZHANG_BLOCK,
        pulse=SinePulse(amplitude=1.0, omega=omega, half_cycles=2),
        printed=(number(*words),),
        unit_g=ZHANG_BLOCK.alpha if unit == "α g" else 1.0,
    )


def _mode_end(block: RigidBlock, model: str, words: tuple[str, ...]) -> ModeEnd:
    return ModeEnd(
        name=f"end of overturning after one impact, {model}, α = {block.alpha:.3g}",
        work=ZHANG,
        where=f"one sine, η = {block.restitution:g}",
        quantity="frequency over p [-]",
        model=model,
        block=block,
        pulse=SinePulse(amplitude=1.0, omega=block.p, half_cycles=2),
        printed=(number(*words),),
    )


def _roussos(
    name: str, size: tuple[float, float], seconds: float, words: tuple[str, str], model: str
) -> Threshold:
    half = name == "half-sine"
    return Threshold(
        name=f"{name} of {seconds:g} s, {model}",
        work=ROUSSOS,
        where=f"block of {size[0]:g} m by {size[1]:g} m",
        quantity="least amplitude that overturns [g]",
        model=model,
        block=RigidBlock(width=size[0], height=size[1]),
        pulse=SinePulse(
            amplitude=1.0,
            omega=(math.pi if half else 2.0 * math.pi) / seconds,
            half_cycles=1 if half else 2,
            phase=COSINE if name == "one cosine" else 0.0,
        ),
        printed=(number(*words),),
    )


def _peer(p: float, words: tuple[str, str]) -> Threshold:
    return Threshold(
        name=f"one cosine of 2 s, p = {p:g} rad/s",
        work=PEER,
        where=f"α = 15°, p = {p:g} rad/s",
        quantity="least amplitude that overturns [g]",
        model="exact",
        block=block_of(math.radians(15.0), p),
        pulse=SinePulse(amplitude=1.0, omega=math.pi, half_cycles=2, phase=COSINE),
        printed=(number(*words),),
    )


PROBLEMS: tuple[Problem, ...] = (
    _steady("A", 3.07, "3.2 / 3.2", "3.3 / 3.3", (0.3, 0.0)),
    _steady("B", 1.9, "8.2 / 6.0", "7.6 / 6.5", (0.5, 0.0)),
    _steady("C", 4.9, "3.8 / 3.8", "3.9 / 3.9", (0.4, 0.3)),
    _steady("D", 4.14, "5.6 / 4.0", "5.8 / 3.8", (0.5, 0.3)),
    _cascade(3.1, "1"),
    _cascade(3.2, "2"),
    _cascade(3.21, "4"),
    _cascade(3.23, "8"),
    _zhang("overturning begins", ("3.00", "3.01"), "housner", 5.0 * ZHANG_BLOCK.p, "α g"),
    _zhang("overturning ends", ("6.32", "6.33"), "housner", 5.0 * ZHANG_BLOCK.p, "α g"),
    _zhang("overturning begins again", ("7.17", "7.18"), "housner", 5.0 * ZHANG_BLOCK.p, "α g"),
    _zhang("with one impact", ("2.22",), "exact", 15.7, "g"),
    _zhang("without impact", ("3.24",), "housner", 15.7, "g"),
    _mode_end(ZHANG_BLOCK, "housner", ("6.59",)),
    _mode_end(ZHANG_BLOCK, "exact", ("7.58",)),
    _mode_end(SQUAT_BLOCK, "housner", ("4.7",)),
    _mode_end(SQUAT_BLOCK, "exact", ("5.5", "5.8")),
    _roussos("half-sine", (0.4, 1.2), 0.5, ("0.5535", "0.5545"), "housner"),
    _roussos("one sine", (1.0, 3.0), 1.0, ("0.4513", "0.4514"), "housner"),
    _roussos("one cosine", (1.0, 3.0), 1.0, ("0.6245", "0.6255"), "exact"),
    _peer(2.0, ("0.315", "0.316")),
    _peer(1.0, ("0.531", "0.532")),
)
"""In the order of the tables. Left out: thresholds printed so close to a response that either
answer is right (Yim, Chopra and Penzien 1980, Fig. 15), and regression files without a source."""
