"""Printed problems: who printed what about which block, to how many digits.

Half-widths are doubled here; amplitudes of pulses are in g, angles in radians but where a unit is
named.
"""

import math

from analytic.block import GRAVITY, RigidBlock
from analytic.motion import SinePulse, Still
from studies.literature.problems import (
    Cascade,
    Drop,
    ModeEnd,
    OrbitLimit,
    Problem,
    Restitution,
    SteadyState,
    Threshold,
    number,
)

HOGAN = "Hogan, 10th World Conference on Earthquake Engineering, 1992, pp. 3973-3977"
ZHANG = "Zhang and Makris, Rocking response of free-standing blocks under cycloidal pulses, 2001"
ROUSSOS = "Makris and Roussos, Géotechnique 50(3), 2000, pp. 243-262"
PEER = "PEER report 2001/07"
SICONOS = "Siconos tutorials, RockingBlock, reference file of the integrator LsodarOSI"
ELGAWADY = "ElGawady and others, Earthquake Engineering and Structural Dynamics 40, 2011"

COSINE = 0.5 * math.pi
"""Phase [rad] of a cosine."""


def block_of(alpha: float, p: float, restitution: float | None = None) -> RigidBlock:
    """Return the block of a slenderness [rad] and a frequency parameter [rad/s]."""
    diagonal = 1.5 * GRAVITY / p**2
    return RigidBlock(
        width=diagonal * math.sin(alpha),
        height=diagonal * math.cos(alpha),
        restitution=restitution,  # type: ignore[arg-type]
    )


def shaken(block: RigidBlock, beta: float, omega_over_p: float, periods: int) -> SinePulse:
    """Return the motion β α g cos(ω t) during a number of periods."""
    return SinePulse(
        amplitude=beta * block.alpha * block.gravity,
        omega=omega_over_p * block.p,
        half_cycles=2 * periods,
        phase=COSINE,
    )


STEADY_PERIODS = 400
"""Forcing periods after which a steady state is read."""

CASCADE_PERIODS = 4000
"""Forcing periods after which the period of an orbit is read."""

HOGAN_BLOCK = block_of(0.18, 2.0, 0.88)
CASCADE_BLOCK = block_of(math.atan(0.5), 2.0, 0.5)
ZHANG_BLOCK = block_of(0.25, 2.14, 0.9)
AT_FIVE = 5.0 * ZHANG_BLOCK.p
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


def _orbit_limit(n: int, birth: bool, words: str) -> OrbitLimit:
    block = block_of(0.18, 2.0, 0.925)
    return OrbitLimit(
        name=f"orbit (1, {n}) {'is born' if birth else 'loses its stability'}",
        work=HOGAN,
        where=f"eqs. (11)-(19), r = 0.925, ω/p = 4, n = {n}",
        quantity="amplitude over α g [-]",
        model="housner",
        block=block,
        pulse=shaken(block, 1.0, 4.0, 1),
        printed=(number(words),),
        half_periods=n,
        birth=birth,
    )


def _restitution(aspect: float, surface: str, words: str) -> Restitution:
    block = RigidBlock(width=0.2, height=0.2 * aspect)
    return Restitution(
        name=f"measured on {surface}, H/B = {aspect:g}",
        work=ELGAWADY,
        where=f"free rocking on {surface}",
        quantity="velocity ratio over Housner's [-]",
        model="exact",
        block=block,
        pulse=Still(),
        printed=(number(words),),
        start=(0.5 * block.alpha, 0.0),
        why=f"a test, no theory: {surface} yields and dissipates where a rigid base does not",
    )


def _zhang(
    name: str,
    words: tuple[str, ...],
    model: str,
    omega: float,
    unit: str,
    shift: float = 0.0,
) -> Threshold:
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
        shift=shift,
        why=_rounded(shift, "; p, printed to three digits, is up to 0.23 % off"),
    )


def _rounded(shift: float, allowed: str) -> str:
    if not shift:
        return ""
    change = f"{100.0 * abs(shift):.2g} % {'higher' if shift > 0.0 else 'lower'}"
    return f"comes out with a frequency {change}{allowed}"


def _mode_end(block: RigidBlock, model: str, words: tuple[str, ...], why: str = "") -> ModeEnd:
    return ModeEnd(
        name=f"end of overturning after one impact, {model}, α = {block.alpha:.3g}",
        work=ZHANG,
        where=f"one sine, η = {block.restitution:g}",
        quantity="frequency over p [-]",
        model=model,
        block=block,
        pulse=SinePulse(amplitude=1.0, omega=block.p, half_cycles=2),
        printed=(number(*words),),
        why=why,
    )


def _roussos(
    name: str,
    size: tuple[float, float],
    seconds: float,
    words: tuple[str, str],
    model: str,
    shift: float,
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
        shift=shift,
        why=_rounded(shift, "; p, if used to two decimals, is up to 0.2 % off"),
    )


def _peer(p: float, words: tuple[str, str], shift: float = 0.0) -> Threshold:
    return Threshold(
        name=f"one cosine of 2 s, p = {p:g} rad/s",
        work=PEER,
        where=f"α = 15°, p = {p:g} rad/s",
        quantity="least amplitude that overturns [g]",
        model="exact",
        block=block_of(math.radians(15.0), p),
        pulse=SinePulse(amplitude=1.0, omega=math.pi, half_cycles=2, phase=COSINE),
        printed=(number(*words),),
        shift=shift,
        why=_rounded(shift, ", which no rounding explains"),
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
    _orbit_limit(1, False, "9.63982"),
    _orbit_limit(3, False, "1.640448"),
    _orbit_limit(3, True, "0.449115"),
    _zhang("overturning begins", ("3.00", "3.01"), "housner", AT_FIVE, "α g", -2e-3),
    _zhang("overturning ends", ("6.32", "6.33"), "housner", AT_FIVE, "α g", 1e-3),
    _zhang("overturning begins again", ("7.17", "7.18"), "housner", AT_FIVE, "α g", 1e-3),
    _zhang("with one impact", ("2.22",), "exact", 15.7, "g"),
    _zhang("without impact", ("3.24",), "housner", 15.7, "g", 1e-3),
    _mode_end(ZHANG_BLOCK, "housner", ("6.59",), "read off a map, ours bisected"),
    _mode_end(ZHANG_BLOCK, "exact", ("7.58",), "read off a map, ours bisected"),
    _mode_end(SQUAT_BLOCK, "housner", ("4.7",)),
    _mode_end(SQUAT_BLOCK, "exact", ("5.5", "5.8"), "5.8 in the text, about 5.5 in the figure"),
    _roussos("half-sine", (0.4, 1.2), 0.5, ("0.5535", "0.5545"), "housner", -1e-3),
    _roussos("one sine", (1.0, 3.0), 1.0, ("0.4513", "0.4514"), "housner", -8e-4),
    _roussos("one cosine", (1.0, 3.0), 1.0, ("0.6245", "0.6255"), "exact", -1e-3),
    _peer(2.0, ("0.315", "0.316")),
    _peer(1.0, ("0.531", "0.532"), 1e-3),
    Drop(
        name="drop without friction",
        work=SICONOS,
        where="block of 1 m by 0.5 m, from 60°; of 16 printed digits 12 decimals",
        quantity="time [s] and rate [rad/s] of the first strike",
        model="exact",
        block=RigidBlock(width=1.0, height=0.5),
        pulse=Still(),
        printed=(number("0.587477974574"), number("4.130760093380")),
        start=(math.pi / 3.0, 0.0),
        friction=0.0,
    ),
    _restitution(5.0, "concrete", "0.95"),
    _restitution(5.0, "rubber", "0.67"),
    _restitution(3.0, "concrete", "0.97"),
)
"""In the order of the tables. Left out: thresholds printed so close to a response that either
answer is right (Yim, Chopra and Penzien 1980, Fig. 15), and regression files without a source."""
