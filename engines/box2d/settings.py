"""What Box2D can be set to: its settings, the tuned ones, and what the studies try of them."""

from dataclasses import dataclass, replace

from engines.declaration import (
    AS_BEST,
    ASLEEP,
    BEST,
    BY_DEFAULT,
    DEFAULT,
    SLEEP,
    Citation,
    Factor,
    Rule,
    factor,
    level,
    moving_base,
)
from engines.parts import NO_JAM, Counted, fall, iterations_for
from engines.scene import Scene
from engines.settings import check, setting

MANUAL_ITERATIONS = 6
"""For velocities: of the library's own hello world."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Box2DSettings(Counted):
    """Settings of Box2D, by default those of its own first example.

    Attributes
    ----------
    geometry : str
        "box": one polygon on another, or "corners": circles at the corners, each on a polygon of
        its own.
    friction : float
        Coefficient between block and base.
    iterations : int or None
        Of the solver, for velocities.
    position_iterations : int
        And for positions.
    sweeps : float or None
        Iterations over 1/sin^2(alpha), where `iterations` are None; the manual's 6 if both are.
    units : float or None
        Units of length in the height of the block; None counts in metres.
    centred : bool
        Count heights from where the block's centre is at rest, not from the base: in single
        precision the least heights are told apart near 0.
    skins_below : bool
        Lower a floor by the skins that the library gives polygons, so that it acts where it is.
    continuous : bool
        Whether the library looks for impacts within a step.
    margin : float or None
        Gap over (alpha p dt)^2 H up to which the corner about which the block turns is kept in
        contact.
    reflection : bool
        Give the pivot's velocity back while the block turns about it, by the velocity of its floor.
    sleeping : bool
        Whether a block that has hardly moved for half a second is no longer simulated.
    floor : str
        How a base that moves is moved: by its "velocity", by "both" its place and its velocity, or
        by "position" alone.
    restitution : float
        Coefficient of the block; of a pair the library takes the larger one.
    """

    geometry: str = setting("box", names=("box", "corners"))
    friction: float = setting(1.0, least=0.0)
    iterations: int | None = setting(None, least=1)
    position_iterations: int = setting(2, least=0)
    sweeps: float | None = setting(None, above=0.0)
    units: float | None = setting(None, above=0.0)
    centred: bool = False
    skins_below: bool = False
    continuous: bool = True
    margin: float | None = setting(None, above=0.0)
    reflection: bool = False
    sleeping: bool = True
    floor: str = setting("velocity", names=("velocity", "both", "position"))
    restitution: float = setting(0.0, least=0.0, most=1.0)

    def __post_init__(self) -> None:
        check(self)

    def iterations_of(self, scene: Scene) -> int:
        """Return how often the solver goes through the contacts."""
        return iterations_for(scene, self.iterations, self.sweeps) or MANUAL_ITERATIONS

    def reach_of(self, scene: Scene, dt_s: float) -> float:
        """Return half of the gap, in units of length, up to which the pivot is kept in contact."""
        return 0.5 * (self.margin or 0.0) * fall(scene, dt_s) * self.unit_of(scene)


TUNED = Box2DSettings(
    geometry="corners",
    friction=NO_JAM,
    sweeps=10.0,
    position_iterations=0,
    units=50.0,
    centred=True,
    skins_below=True,
    continuous=False,
    margin=10.0,
    sleeping=False,
    floor="both",
)
LANDING = replace(TUNED, reflection=True)

DOCUMENTED = (
    Citation("step", "world.Step(1.0 / 60, 6, 2)", "Box2D/examples/hello.py"),
    Citation("sleeping", "on, the default", "b2BodyDef.allowSleep"),
    Citation(
        "friction",
        "0.2, of a pair the root of the product; here 1",
        "b2FixtureDef.friction, b2Contact.h",
    ),
    Citation(
        "skin", "0.01 of a polygon, of which 0.005 is left alone", "b2_polygonRadius, b2_linearSlop"
    ),
    Citation("warm starting", "on, the default", "b2World.warmStarting"),
    Citation(
        "without effect",
        "continuousPhysics on; b2_velocityThreshold 1 below which nothing bounces; no damping; "
        "speeds up to b2_maxTranslation 2 a step",
        "b2World, b2BodyDef, b2Settings.h",
    ),
    Citation("floor", "a kinematic body, by its linearVelocity", "examples/body_types.py"),
)
"""What its documentation sets, in pybox2d 2.3.10."""

RECOMMENDED = (
    Citation("iterations", "8 for velocity and 3 for position", "manual, Hello Box2D"),
    Citation("step", "1/60 s; no smaller one for fewer iterations", "manual, Dynamics Module"),
)
"""What it recommends for accurate contact."""

FACTORS = (
    factor("geometry"),
    Factor(
        "iterations",
        ("iterations", "sweeps"),
        (
            level("6", iterations=6),
            level("100", iterations=100),
            level("1000", iterations=1000),
        ),
    ),
    factor("position_iterations", level("2", position_iterations=2)),
    factor("units", level("5 a height", units=5.0), level("200 a height", units=200.0)),
    factor("centred", name="origin"),
    factor("skins_below"),
    factor("continuous"),
    factor("margin", level("1", margin=1.0), level("100", margin=100.0)),
    ASLEEP,
    moving_base("both", "velocity", "position"),
)
"""What its contact can be set to."""

RULES = (
    Rule(
        "Count in units of length that fit, here 50 a height: polygons have a skin of 0.01 "
        "units, and speed is cut to 2 units a step",
        *(DEFAULT, "units", AS_BEST),
        kept=True,
    ),
    Rule(
        "Lower a floor by that skin, if bodies are to touch it where it is",
        *(BEST, "skins below", BY_DEFAULT),
    ),
    Rule(
        "Forbid sleep by `body.sleepingAllowed = False`: the world's own `doSleep` reads back what "
        "was set and does nothing, and gravity that turns wakes nothing",
        *SLEEP,
    ),
)
"""What its users should know, each with its measured effect."""
