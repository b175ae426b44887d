"""What PhysX can be set to: its settings, the tuned ones, and what the studies try of them."""

from dataclasses import dataclass, replace

from engines.declaration import (
    BEST,
    BOTH,
    BY_DEFAULT,
    DEFAULT,
    OWN_STEP,
    OWN_STEPS,
    UNMOVED_BASE,
    Citation,
    Factor,
    Rule,
    factor,
    level,
    moving_base,
)
from engines.parts import NO_JAM, Counted
from engines.settings import check, setting

MOST = 255
"""Iterations at most: the library counts them in eight bits."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PhysxSettings(Counted):
    """Settings of PhysX, by default those of SAPIEN; None leaves a setting to it.

    Attributes
    ----------
    geometry : str
        "box", or "corners": small balls where the corners at the base are.
    planar : bool
        Lock what leads out of the plane, and put two corners into the middle plane instead of four
        at the edges. A box has its four corners either way.
    friction : float
        Coefficient between block and base, at rest and sliding; SAPIEN's own is 0.3, with which a
        block of H/B = 3 slides before it rocks.
    tgs : bool or None
        Whether the solver is TGS, which moves bodies in every iteration, or PGS; its own is TGS.
    iterations, velocity_iterations : int or None
        Of the solver, with and then without the correction of depths; its own are 10 and 1.
    bounce_threshold : float or None
        Velocity [m/s] below which no impact bounces; its own is 2.
    depenetration : float or None
        Fastest correction of a depth [m/s]; its own has no limit. A rounding of the depth over a
        short step is a velocity, too.
    angular_damping : float or None
        Part of the angular velocity that is lost in a second; its own is 0.05.
    sleeping : bool or None
        Whether a block that has hardly moved for 0.4 s is no longer simulated; its own is on.
    contact_offset : float or None
        Gap [units of length] below which a contact holds, half of it on each side; its own is 0.01.
        A block that is held before it strikes does so in two steps.
    units : float or None
        Units of length in the height of the block; None counts in metres.
    centred : bool
        Count heights from where the block's centre is at rest, not from the base.
    reflection : bool
        Give the sliding velocity of the corner about which the block turns back to it, by the
        velocity of the base; not in the steps of an impact.
    floor : str
        How a base that moves is moved: by a "target" for the end of the step; as a "belt" whose
        targets are where it is, set back before by what it goes in a step, since of a far place
        less is told apart; or by "position" alone.
    restitution : float
        Coefficient of both; SAPIEN's own is 0.1.
    """

    geometry: str = setting("box", names=("box", "corners"))
    planar: bool = False
    friction: float = setting(1.0, least=0.0)
    tgs: bool | None = None
    iterations: int | None = setting(least=1, most=MOST)
    velocity_iterations: int | None = setting(least=0, most=MOST)
    bounce_threshold: float | None = setting(above=0.0)
    depenetration: float | None = setting(above=0.0)
    angular_damping: float | None = setting(least=0.0)
    sleeping: bool | None = None
    contact_offset: float | None = setting(above=0.0)
    units: float | None = setting(above=0.0)
    centred: bool = False
    reflection: bool = False
    floor: str = setting("target", names=("target", "belt", "position"))
    restitution: float = setting(0.1, least=0.0, most=1.0)

    def __post_init__(self) -> None:
        check(self)


TUNED = PhysxSettings(
    geometry="corners",
    planar=True,
    friction=NO_JAM,
    tgs=False,
    iterations=100,
    velocity_iterations=100,
    depenetration=1e-6,
    angular_damping=0.0,
    sleeping=False,
    contact_offset=1e-6,
    units=1.0,
    centred=True,
    restitution=0.0,
)

LANDING = replace(
    TUNED,
    iterations=MOST,
    velocity_iterations=MOST,
    contact_offset=None,
    reflection=True,
    floor="belt",
)

SHAPES = "SAPIEN 3.0.3, sapien/pysapien/physx.pyi"
TUNING = "Isaac Lab 3.0.0, concepts/solver-tuning/tune_physx.rst"

DOCUMENTED = (
    Citation("step", "1/100 s", "SAPIEN 3.0.3, sapien/example/hello_world.py"),
    Citation(
        "iterations", "10 of position, 1 of velocity, by default", f"{SHAPES}: set_body_config"
    ),
    Citation(
        "solver",
        "enable_tgs = True, the default",
        f"{SHAPES}: set_scene_config",
    ),
    Citation("bounce_threshold", "2.0, the default", f"{SHAPES}: set_scene_config"),
    Citation("sleeping", "sleep_threshold = 0.005, the default", f"{SHAPES}: set_body_config"),
    Citation("contact_offset", "0.01, the default", f"{SHAPES}: set_shape_config"),
    Citation("contact_offset", "rest_offset 0, the default", f"{SHAPES}: set_shape_config"),
    Citation("manifolds", "enable_pcm = True, the default", f"{SHAPES}: set_scene_config"),
    Citation("damping", "angular 0.05, linear 0", f"{SHAPES}: PhysxRigidDynamicComponent"),
    Citation("restitution", "0.1, the default", "physx.get_default_material()"),
    Citation("friction", "0.3, of a pair the mean; here 1", "physx.get_default_material()"),
    Citation(
        "without effect",
        "enable_friction_every_iteration, no enable_ccd, max_angular_velocity 100, "
        "max_depenetration_velocity 1e32",
        f"{SHAPES}: PhysxSceneConfig, PhysxRigidDynamicComponent",
    ),
    Citation("floor", "kinematic, set_kinematic_target", f"{SHAPES}: PhysxRigidDynamicComponent"),
)
"""What its documentation sets."""

RECOMMENDED = (
    Citation("step", "dt = 1/120 s, where to start: 'not a universal recommendation'", TUNING),
    Citation("iterations", "at most 64 of position and 4 of velocity: all of them here", TUNING),
    Citation("solver", "TGS, the first candidate", TUNING),
    Citation("bounce_threshold", "0.2 m/s", TUNING),
)
"""What those who maintain PhysX recommend for contact."""

STUCK = "of a slow move nothing is left in single precision: TGS adds it to the place in parts"
SMOOTH = "SAPIEN's own friction: the block slides before it rocks"

FACTORS = (
    factor("tgs", level("TGS", trap=STUCK, tgs=True), level("PGS", (DEFAULT,), tgs=False)),
    Factor(
        "iterations",
        ("iterations", "velocity_iterations"),
        (level("255, 255", iterations=MOST, velocity_iterations=MOST),),
    ),
    factor("depenetration"),
    factor("contact_offset"),
    factor("angular_damping"),
    factor("bounce_threshold", level("0.01 m/s", BOTH, bounce_threshold=0.01)),
    factor("restitution"),
    Factor(
        "geometry",
        ("geometry", "planar"),
        (
            level("4 corners, free", planar=False),
            level("planar box", geometry="box"),
            level("4 corners", (DEFAULT,), geometry="corners"),
        ),
    ),
    factor("units", level("metres", units=None)),
    factor("centred", name="origin"),
    factor("sleeping", level("on", sleeping=True), by_default=False),
    factor("friction", level("0.3, SAPIEN's own", (DEFAULT,), SMOOTH, friction=0.3)),
    moving_base("target", "belt", "position"),
)
"""What its contact can be set to."""

RULES = (
    Rule("Take shorter steps than 1/100 s", *(DEFAULT, OWN_STEPS, OWN_STEP)),
    Rule(
        "Give a block small balls for corners, not a box",
        *(BEST, "geometry", BY_DEFAULT),
    ),
    Rule(
        "Shrink `contact_offset`: a corner that is held before it strikes does so in two steps",
        *(BEST, "contact offset", BY_DEFAULT),
    ),
    Rule(
        "Switch TGS off, `enable_tgs=False`, in short steps: below (ulp/2) iterations/dt, ulp that "
        "of the place in the world, a body stands still",
        *(BEST, "tgs", "TGS"),
    ),
    Rule(
        "Move a base by `set_kinematic_target`: friction does not feel one whose pose is set",
        *UNMOVED_BASE,
    ),
)
"""What its users should know first."""
