"""What pymunk can be set to: its settings, the tuned ones, and what the studies try of them."""

from dataclasses import dataclass, replace

from engines.declaration import (
    DEFAULT,
    LEFT_OUT,
    OWN_STEP,
    OWN_STEPS,
    Citation,
    Factor,
    Rule,
    factor,
    level,
    moving_base,
)
from engines.parts import NO_JAM, fall, iterations_for
from engines.scene import Scene
from engines.settings import check, setting

LEVEL = 1e-9
"""A block that leans by less [rad] stands on both corners: held to the margin while it falls, the
free corner would come to rest above the base."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PymunkSettings:
    """Settings of pymunk; None leaves the library's default.

    Attributes
    ----------
    geometry : str
        "box": one polygon on one segment, or "corners": points at the corners, each on a polygon of
        its own.
    friction : float
        Coefficient between block and base.
    iterations, slop, bias : optional
        `Space.iterations`, `collision_slop` [units of length] and `collision_bias`.
    sweeps : float or None
        Iterations over 1/sin^2(alpha), where `iterations` are None.
    positions : bool
        Move the positions after the velocities, by the adapter.
    margin : float or None
        Gap over (alpha p dt)^2 H up to which the corner about which the block turns is kept in
        contact; slop is then beyond it.
    reflection : bool
        Give the pivot's velocity back while the block turns about it, by elasticity and surface
        velocity.
    floor : str
        How a base that moves is moved: by its "velocity", by "both" its place and its velocity, or
        by "position" alone.
    unit : float
        Units of length in a metre.
    restitution : float
        Coefficient of the corners, which have it as their `elasticity`; a box has none.
    base_restitution : float
        That of the base, with which the library multiplies it.
    """

    geometry: str = setting("box", names=("box", "corners"))
    friction: float = setting(1.0, least=0.0)
    iterations: int | None = setting(None, least=1)
    slop: float | None = setting(None, least=0.0)
    bias: float | None = setting(None, least=0.0, most=1.0)
    sweeps: float | None = setting(None, above=0.0)
    positions: bool = False
    margin: float | None = setting(None, above=0.0)
    reflection: bool = False
    floor: str = setting("velocity", names=("velocity", "both", "position"))
    unit: float = setting(1.0, above=0.0)
    restitution: float = setting(0.0, least=0.0, most=1.0)
    base_restitution: float = setting(1.0, least=0.0, most=1.0)

    def __post_init__(self) -> None:
        check(self)

    def iterations_of(self, scene: Scene) -> int | None:
        """Return how often the solver goes through the contacts; None leaves that to it."""
        return iterations_for(scene, self.iterations, self.sweeps)

    def margin_of(self, scene: Scene, dt_s: float) -> float:
        """Return the gap, in units of length, up to which the pivot is kept in contact."""
        return (self.margin or 0.0) * fall(scene, dt_s) * self.unit

    def slop_of(self, scene: Scene, dt_s: float) -> float | None:
        """Return the penetration that is left alone; None is the library's own."""
        return self.slop if self.margin is None else 10.0 * self.margin_of(scene, dt_s)


TUNED = PymunkSettings(
    geometry="corners",
    friction=NO_JAM,
    sweeps=20.0,
    bias=0.0,
    margin=10.0,
    floor="both",
)
LANDING = replace(TUNED, positions=True, reflection=True)

DOCUMENTED = (
    Citation("step", "space.step(0.02)", "README, the first example"),
    Citation("iterations", "10, the default", "Space.iterations"),
    Citation("collision_slop", "0.1, the default", "Space.collision_slop"),
    Citation("sleeping", "off: sleep_time_threshold is inf", "Space.sleep_time_threshold"),
    Citation("friction", "0, of a pair the product; here 1", "Shape.friction, cpArbiter.c"),
    Citation("warm starting", "all of the last step's impulses", "cpSpaceStep.c"),
    Citation(
        "collision_persistence",
        "3 steps; with 0 nothing is left to start from, and a block slides",
        "cpSpace.c",
    ),
    Citation(
        "without effect",
        "collision_bias 0.9^60 a second, of what exceeds the slop; damping 1; elasticity 0",
        "cpSpace.c, cpShape.c",
    ),
    Citation("floor", "Body.KINEMATIC, by its velocity", "Body.KINEMATIC, on platforms"),
)
"""What its documentation sets, in pymunk 7.3.1."""

RECOMMENDED = (
    Citation("step", "ten of a tenth", "Space.step: multiple calls with a smaller dt"),
    Citation(
        "collision_slop",
        "as high as you can without noticeable overlapping: here 1 mm",
        "Space.collision_slop",
    ),
)
"""What it recommends for stable and accurate contact."""

FACTORS = (
    factor("geometry"),
    factor("positions", level("moved by the adapter", positions=True), by_default=False),
    Factor(
        "iterations",
        ("iterations", "sweeps"),
        (level("100", iterations=100),),
    ),
    factor("margin", level("1", margin=1.0), level("0.1", margin=0.1)),
    factor("bias", level("the library's", bias=(1.0 - 0.1) ** 60)),
    factor("unit", level("the README's 100 in a metre", ("naive",), unit=100.0)),
    factor("slop", level("0", ("naive",), slop=0.0), level("1e-4 m", ("naive",), slop=1e-4)),
    factor("friction", level("5", friction=5.0, trap="Painlevé's paradox: the pivot jams")),
    moving_base("both", "velocity", "position"),
)
"""What its contact can be set to."""

RULES = (
    Rule(
        "Keep the step of `space.step` the same: the impulses it starts from are scaled by the "
        "ratio of two steps",
        *("landing", LEFT_OUT, "positions"),
    ),
    Rule(
        "Step finer than 0.02 s: positions move by the velocities of the step before",
        *(DEFAULT, OWN_STEPS, OWN_STEP),
    ),
    Rule(
        "Leave `collision_slop` above 0: at 0 contacts come and go",
        *(DEFAULT, "slop", "0"),
    ),
)
"""What its users should know, each with its measured effect."""
