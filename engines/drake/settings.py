"""What Drake can be set to: its settings, the tuned ones, and what the studies try of them."""

from dataclasses import dataclass, replace

from engines.declaration import (
    BEST,
    BOTH,
    BY_DEFAULT,
    DEFAULT,
    UNMOVED_BASE,
    Citation,
    Factor,
    Rule,
    factor,
    level,
    moving_base,
)
from engines.parts import NO_JAM
from engines.settings import check, setting

CENIC = "cenic"
"""The integrator of a continuous plant; the other solvers are those of a discrete one."""

SOLVERS = ("lagged", "similar", "sap", CENIC)
"""The library's models of contact, by its own names."""

PLANE = ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))
"""Its columns are z, x and y: a planar joint moves along two axes, and turns about the third."""

LONGEST = 10.0
"""No step that CENIC is told is longer than this many ordinary ones."""

GAINS = {"p": 1e12, "d": 1e8}
"""Of the drive of a base that moves [N/m, N s/m]: nothing yields, and the ratio is an example's."""

SPEED_GAINS = {"p": 0.0, "d": 1e12}
"""The same where steps differ: how fast the base is does not depend on them, where it is does."""

ACCURACY = 2e-9
"""Error of a step over alpha. CENIC is of first order: its steps go by the root of this, and so at
first does a rotation's error in units of kappa: up to 5e-5 at 1e-8, 3e-5 at 2e-9. There it stays
with half of that, too, whatever the contact is made of; near overturning kappa is 70."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DrakeSettings:
    """Settings of Drake, by default its own; None leaves a setting to the library.

    Attributes
    ----------
    geometry : str
        "box", of which the library sees one contact, the deepest, or "corners": small spheres where
        the corners at the base are.
    planar : bool
        Give the block a planar joint, and two corners in the middle plane instead of four at the
        edges.
    friction : float
        Coefficient between block and base.
    solver : str or None
        One of `SOLVERS`; by default "lagged".
    stiffness : float or None
        Of a contact over m/dt^2, dt being the step, or the time between two looks at an engine that
        chooses its own steps; the library's own is 1e6 N/m, whatever the mass.
    relaxation : float or None
        Time in which "sap" lets a contact relax, over the step.
    dissipation : float or None
        Of the other solvers, over 1/(p R), the time over which a contact's speed is reckoned.
    stiction : float or None
        Speed over p R at which a contact that sticks may slip.
    near_rigid : float or None
        Of "sap": below which part of what a contact's mass alone would give its stiffness is held.
    corner_radius : float
        Radius of the corner spheres over the width.
    accuracy : float or None
        Of "cenic": the error of a step over alpha, by which it chooses its own; without it, it
        takes those that it is told.
    floor : str
        How a base that moves is moved: by the "drive" of its joint, or by "position" alone.
    """

    geometry: str = setting("box", names=("box", "corners"))
    planar: bool = False
    friction: float = setting(1.0, least=0.0)
    solver: str | None = setting(names=SOLVERS)
    stiffness: float | None = setting(above=0.0)
    relaxation: float | None = setting(least=0.0)
    dissipation: float | None = setting(least=0.0)
    stiction: float | None = setting(above=0.0)
    near_rigid: float | None = setting(least=0.0)
    corner_radius: float = setting(1e-6, above=0.0)
    accuracy: float | None = setting(above=0.0, most=1.0)
    floor: str = setting("drive", names=("drive", "position"))

    def __post_init__(self) -> None:
        check(self)


DOCUMENTED = (
    Citation("step", "time_step = 0.001", "MultibodyPlantConfig, drake 1.51.1"),
    Citation(
        "solver",
        "discrete_contact_approximation = 'lagged', stiction_tolerance = 0.0001",
        "MultibodyPlantConfig, drake 1.51.1",
    ),
    Citation(
        "contact",
        "contact_model = 'hydroelastic_with_fallback', compliance_type = 'undefined', that is "
        "points; point_stiffness = 1000000, hunt_crossley_dissipation = 50",
        "MultibodyPlantConfig, DefaultProximityProperties, drake 1.51.1",
    ),
    Citation(
        "shapes",
        "the table is a <box> with no properties of contact",
        "tutorials/authoring_multibody_simulation.ipynb, drake 1.51.1",
    ),
    Citation(
        "friction",
        "dynamic_friction = static_friction = 0.5, of a pair 2 a b/(a + b); 1.0 is used",
        "DefaultProximityProperties, drake 1.51.1",
    ),
    Citation(
        "without effect",
        "penetration_allowance = 0.001, sap_near_rigid_threshold = 1, relaxation_time = 0.1, "
        "contact_surface_representation = 'polygon'",
        "MultibodyPlantConfig, DefaultProximityProperties, drake 1.51.1",
    ),
    Citation(
        "floor",
        "'infinite PD gains for 1-dof joints': a prismatic joint, set_controller_gains, "
        "get_desired_state_input_port",
        "RobotLocomotion/drake issue 20496; MultibodyPlant, 'Using PD controlled actuators', "
        "drake 1.51.1",
    ),
    Citation(
        "gains",
        "{1e4, 1} on a rail that carries 0.1 kg; of 'infinite' ones there is no example: 1e8 times "
        "those are used, and a floor of the block's mass",
        "examples/multibody/deformable/deformable_torus.cc",
    ),
)
"""What the preset "naive" is documented by."""

RECOMMENDED = (
    Citation("solver", "similar, where impacts are to be resolved", "DiscreteContactApproximation"),
    Citation("shapes", "small spheres at the corners", "contact_model_doxygen.h, Point contact"),
    Citation("contact", "stiffness by the depth under the weight: 1e7 N/m", "the same, Stiffness"),
)
"""What it recommends for rigid contact; the stiffness is for 375 kg, and follows the mass."""

TUNED = DrakeSettings(
    geometry="corners",
    planar=True,
    friction=100.0,
    solver=CENIC,
    stiffness=1.0,
    dissipation=1e3,
    stiction=1e-5,
)

CONTROLLED = replace(TUNED, stiffness=2.5e3, accuracy=ACCURACY)

LAGGED = "friction goes by the normal force of the last step, which no impact has foreseen"
DEEPEST = "a box touches a half-space in one point, its deepest"

FACTORS = (
    Factor(
        "solver",
        ("solver", "relaxation", "near_rigid"),
        (
            level("SAP, relaxation 10", solver="sap", relaxation=10.0, near_rigid=0.0),
            level("SAP, relaxation 1", solver="sap", relaxation=1.0, near_rigid=0.0),
            level("SAP", (DEFAULT,), solver="sap"),
            level("similar", BOTH, solver="similar"),
        ),
    ),
    factor("stiffness", level("10", stiffness=10.0), level("0.1", stiffness=0.1)),
    factor(
        "dissipation", level("100", dissipation=1e2), level("1e4", trap=LAGGED, dissipation=1e4)
    ),
    factor("stiction", level("1e-4", stiction=1e-4)),
    Factor(
        "geometry",
        ("geometry", "planar"),
        (
            level("4 corners", BOTH, geometry="corners", planar=False),
            level("planar box", trap=DEEPEST, geometry="box"),
        ),
        traps={"fixed": DEEPEST},
    ),
    factor("corner_radius", level("B/500", corner_radius=2e-3)),
    factor("friction", level("1.3", friction=NO_JAM)),
    moving_base("drive", "position"),
)
"""What its contact can be set to."""

RULES = (
    Rule(
        "Give each contact a `point_stiffness` of m/dt²: its own is 1e6 N/m, whatever the mass",
        *(BEST, "stiffness", BY_DEFAULT),
    ),
    Rule(
        "Put spheres at the corners: of a box a half-space sees one point, the deepest",
        *(BEST, "geometry", "planar box"),
    ),
    Rule(
        "Keep `dissipation` below 1e3/(p R): friction goes by the last step's normal force",
        *(BEST, "dissipation", "1e4"),
    ),
    Rule(
        "Drive a base that moves, `set_controller_gains`: friction does not feel one just placed",
        *UNMOVED_BASE,
    ),
)
"""What its users should know first."""
