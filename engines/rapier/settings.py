"""What Rapier can be set to: its settings, the tuned ones, and what the studies try of them."""

import math
from dataclasses import dataclass, replace

from engines.declaration import (
    ASLEEP,
    BEST,
    BOTH,
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
from engines.parts import NO_JAM, Counted, Point, floor_half_size, iterations_for
from engines.scene import Scene
from engines.settings import check, setting

OVERDAMPED = 1e5
"""Damping ratio of a contact that corrects positions and is firm all the same, in single precision.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class RapierSettings(Counted):
    """Settings of Rapier, by default its own; None leaves a setting to the library.

    Attributes
    ----------
    geometry : str
        "box", or "corners": small balls where the corners at the base are.
    planar : bool
        Lock the rotations that lead out of the plane, and put two corners into the middle plane
        instead of four at the edges. A box has its four corners either way.
    locked_aside : bool
        Lock the translation out of the plane, too, where `planar` is set. The contact then has no
        friction, in the plane either.
    friction : float
        Coefficient between block and base, their mean; the library's own is 0.5, with which a block
        of H/B = 2 slides before it rocks.
    substeps, iterations, stabilization : int or None
        Of the solver: substeps in a step, iterations in each, and those that take out of the
        velocities what the correction of positions has put in.
    sweeps : float or None
        Iterations over 1/sin^2(alpha), where `iterations` are None.
    frequency, damping_ratio : float or None
        Natural frequency [Hz] and damping ratio of the contact; both or neither. The library's are
        30 and 10, and 60 Hz on what does not move.
    correction : float or None
        Ordinary steps in which a contact corrects a position, in place of the two: in a short step
        it takes out no more than its share, which else would be a velocity made of rounding.
    recycling : bool or None
        Whether contacts are taken from the last step where bodies have hardly moved.
    warm_starting : float or None
        Part of the last step's impulses from which the solver starts; they are not scaled by the
        ratio of two steps.
    coulomb : bool or None
        Give each contact a friction of its own instead of one to all four.
    friction_in_bias_pass : bool or None
        Whether friction is solved, too, where a step corrects depths.
    sleeping : bool or None
        Whether a block that has hardly moved for half a second is no longer simulated.
    units : float or None
        Units of length in the height of the block; None counts in metres.
    centred : bool
        Count heights from where the block's centre is at rest, not from the base.
    base_depth : float
        Half the depth of the base over the height of the block. Contacts are looked for from the
        middle of the base: the deeper that is, the more coarsely.
    corner_radius : float
        Radius of the corner balls over the height. On a base that is deep, a ball whose centre is
        rounded to where the surface is has no normal there, and no contact for a step.
    reflection : bool
        Give the sliding velocity of the corner about which the block turns back to it, by the
        velocity of the base; not in the steps of an impact.
    floor : str
        How a base that moves is moved: by a "target" for the end of the step or its "velocity",
        which the library leads it by; by "both" its place and its velocity; by "position" alone.
    restitution : float
        Coefficient of the block.
    base_restitution : float or None
        That of the base, the block's by default; the library takes their mean.
    """

    geometry: str = setting("box", names=("box", "corners"))
    planar: bool = False
    locked_aside: bool = False
    friction: float = setting(1.0, least=0.0)
    substeps: int | None = setting(least=1)
    iterations: int | None = setting(least=1)
    stabilization: int | None = setting(least=0)
    sweeps: float | None = setting(above=0.0)
    frequency: float | None = setting(above=0.0, beside=("damping_ratio",))
    damping_ratio: float | None = setting(above=0.0)
    correction: float | None = setting(above=0.0)
    recycling: bool | None = None
    warm_starting: float | None = setting(least=0.0, most=1.0)
    coulomb: bool | None = None
    friction_in_bias_pass: bool | None = None
    sleeping: bool | None = None
    units: float | None = setting(above=0.0)
    centred: bool = False
    base_depth: float = setting(1.0, above=0.0)
    corner_radius: float = setting(1e-5, above=0.0)
    reflection: bool = False
    floor: str = setting("target", names=("target", "velocity", "both", "position"))
    restitution: float = setting(0.0, least=0.0, most=1.0)
    base_restitution: float | None = setting(least=0.0, most=1.0)

    def __post_init__(self) -> None:
        check(self)

    def iterations_of(self, scene: Scene) -> int | None:
        """Return how often the solver goes through the contacts; None leaves that to it."""
        return iterations_for(scene, self.iterations, self.sweeps)

    def base_half_size(self, scene: Scene) -> Point:
        """Return half of the size [m] of the base along x, y and z."""
        x, y, z = floor_half_size(scene)
        return x, y, self.base_depth * z

    def spring_of(self, dt_s: float) -> tuple[float, float] | None:
        """Return a contact's frequency [Hz] and damping ratio; None leaves both to the library.

        A spring of frequency f and damping ratio z takes the part dt / (dt + z / (pi f)) of a
        depth out of it in a step dt.
        """
        if self.correction is not None:
            return OVERDAMPED / (math.pi * self.correction * dt_s), OVERDAMPED
        if self.frequency is None or self.damping_ratio is None:
            return None
        return self.frequency, self.damping_ratio


TUNED = RapierSettings(
    geometry="corners",
    planar=True,
    friction=NO_JAM,
    substeps=1,
    sweeps=10.0,
    stabilization=0,
    correction=10.0,
    recycling=False,
    warm_starting=0.0,
    sleeping=False,
    units=1.0,
    centred=True,
    base_depth=0.1,
    floor="both",
)

LANDING = replace(TUNED, reflection=True)

RECYCLED = "a contact of an earlier step: the block slides off its pivot"
FRICTIONLESS = "a contact whose body cannot move aside has no friction at all"
WITHOUT_NORMAL = "a ball whose centre rounds onto a surface has no contact there for a step"
SMOOTH = "the library's own friction: a block of H/B = 2 slides before it rocks"

DOCUMENTED = (
    Citation("step", "1/60 s, the default", "IntegrationParameters.dt"),
    Citation("substeps", "4, the default", "IntegrationParameters.num_solver_iterations"),
    Citation("sleeping", "on, the default", "RigidBodyBuilder.can_sleep"),
    Citation("friction", "0.5, of a pair the mean; here 1", "ColliderBuilder.friction"),
    Citation(
        "friction",
        "simplified, one for all points; not solved where depths are corrected",
        "IntegrationParameters.friction_model, friction_in_bias_pass",
    ),
    Citation(
        "contact",
        "a spring of 30 Hz, damping ratio 10; 60 Hz on what does not move",
        "IntegrationParameters.contact_softness, static_contact_softness",
    ),
    Citation(
        "contact",
        "from 0.02 away, and kept while bodies move by less than 0.05",
        "IntegrationParameters.normalized_prediction_distance, contact_recycling",
    ),
    Citation(
        "iterations",
        "1 a substep and 1 of stabilization, from all of the last impulses",
        "IntegrationParameters.num_internal_pgs_iterations, warmstart_coefficient",
    ),
    Citation(
        "without effect",
        "allowed_linear_error 0.005, max_corrective_velocity 3, max_linear_velocity 400, "
        "max_ccd_substeps 1, contact_clustering; no damping",
        "IntegrationParameters, RigidBodyBuilder",
    ),
    Citation(
        "floor",
        "kinematic_position_based, set_next_kinematic_translation; shown second: linvel of one "
        "that is velocity-based",
        "rapier.rs, user guide for Python, Common recipes: Making a moving platform",
    ),
)
"""What its documentation sets, in rapier3d 0.36.1."""

RECOMMENDED = (
    Citation("step", "1/120 s", "rapier.rs, user guide for Python, Integration parameters"),
    Citation("substeps", "8, for a more accurate simulation", "the same page"),
    Citation("friction_model", "Coulomb, the more accurate one", "integration_parameters.rs"),
)
"""What it recommends for accurate contact."""

FACTORS = (
    Factor(
        "contact spring",
        ("frequency", "damping_ratio", "correction"),
        (
            level("1e3 Hz", frequency=1e3, damping_ratio=1.0, correction=None),
            level("1e6 Hz", frequency=1e6, damping_ratio=1.0, correction=None),
            level("1 step", correction=1.0),
            level("1000 steps", correction=1000.0),
        ),
    ),
    factor("recycling", traps={"fixed": RECYCLED}, name="contact recycling"),
    ASLEEP,
    factor("locked_aside", level("y locked", trap=FRICTIONLESS, locked_aside=True), name="locks"),
    factor("stabilization"),
    factor("substeps"),
    Factor(
        "iterations",
        ("iterations", "sweeps"),
        (
            level("10", BOTH, iterations=10),
            level("1000", iterations=1000),
        ),
    ),
    factor("warm_starting"),
    factor("coulomb", level("Coulomb", BOTH, coulomb=True), name="friction model"),
    factor(
        "friction_in_bias_pass",
        level("on", BOTH, friction_in_bias_pass=True),
        name="friction while depths are corrected",
    ),
    factor("friction", level("0.5, the library's own", (DEFAULT,), SMOOTH, friction=0.5)),
    Factor(
        "geometry",
        ("geometry", "planar"),
        (level("4 corners, free", planar=False), level("planar box", geometry="box")),
    ),
    factor("units", level("1.5 a height", units=1.5)),
    factor("centred", name="origin"),
    Factor(
        "depth of the base",
        ("base_depth", "corner_radius"),
        (
            level("1 H", base_depth=1.0),
            level(
                "1 H, corners of 1e-7 H", trap=WITHOUT_NORMAL, base_depth=1.0, corner_radius=1e-7
            ),
        ),
        by_default=False,
    ),
    factor(
        "corner_radius",
        level("H/1000", corner_radius=1e-3),
        level("1e-7 H", corner_radius=1e-7),
    ),
    moving_base("both", "target", "velocity", "position"),
)
"""What its contact can be set to."""

RULES = (
    Rule(
        "Leave the translation out of the plane free: locked, with two rotations, no friction acts",
        *(BEST, "locks", "y locked"),
    ),
    Rule(
        "Switch `contact_recycling` off: what turns slowly slides off an old contact",
        *(BEST, "contact recycling", BY_DEFAULT),
    ),
    Rule(
        "Forbid sleep, `can_sleep(False)`: gravity that changes wakes nothing",
        *SLEEP,
    ),
    Rule(
        "Stiffen contacts, `contact_softness`: they have 30 Hz, and 60 Hz on what does not move",
        *(BEST, "contact spring", BY_DEFAULT),
    ),
)
"""What its users should know first."""
