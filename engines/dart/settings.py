"""What DART can be set to: its settings, the tuned ones, and what the studies try of them."""

from dataclasses import dataclass, replace

from engines.declaration import (
    BEST,
    BOTH,
    DEFAULT,
    UNMOVED_BASE,
    Citation,
    Factor,
    Rule,
    factor,
    level,
    moving_base,
)
from engines.settings import check, setting

DETECTORS = {
    "DART": "DARTCollisionDetector",
    "FCL": "FCLCollisionDetector",
    "BULLET": "BulletCollisionDetector",
    "ODE": "OdeCollisionDetector",
}
"""The library's names of its collision detectors -> their classes, which every release has."""

SOLVERS = {
    "Dantzig": "DantzigBoxedLcpSolver",
    "NSGS": "NsgsFrictionSolver",
    "FBF": "FbfFrictionSolver",
}
"""Names of solvers of contact forces -> their classes."""

IN_PLANE, IN_SPACE = (1, 0, 2), (3, 5, 1)
"""Where x, z and theta stand among the coordinates of a joint in the plane, or of a free one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DartSettings:
    """Settings of DART, by default its own; None leaves a setting to the library.

    Attributes
    ----------
    geometry : str
        "box", or "corners": small spheres where the corners at the base are.
    planar : bool
        Give the block a planar joint, and two corners in the middle plane, instead of a free joint
        and four corners at the edges.
    aside : bool
        Let the base slide out of the plane. Else nothing moves a block in the plane that way, its
        friction there has no mass, the Dantzig solver fails on it, and the library takes what its
        other solver makes of the last step's impulses in a few iterations, without a word.
    friction : float
        Coefficient between block and base, of which the library takes the smaller; its own is 1.
    exact_inertia : bool
        Set the moments of inertia, too: the mass alone leaves them at 1 kg m2.
    collision : str or None
        Collision detector, one of `DETECTORS`; by default FCL. By "DART" contacts are known again
        by where bodies are in memory: where Dantzig's solver fails, answers depend on that.
    solver : str or None
        Of contact forces, one of `SOLVERS`; by default Dantzig's, which bounds friction by normal
        forces that it solves for without it: while a block turns about a corner that bound is up to
        a third too low.
    split_impulse : bool or None
        Correct penetration without giving it a velocity.
    sleeping : bool or None
        Whether a block that has hardly moved for half a second is no longer simulated.
    unit : float
        Units of length in a metre. The library corrects a penetration by 1 % of it a step, up to
        1e-3 units/s.
    corner_radius : float
        Radius of the corner spheres over the width.
    margin : float or None
        Depth over (alpha p dt)^2 H by which the corner about which the block turns is lowered, so
        that it stays in contact.
    reflection : bool
        Give that corner's velocity back to it, by the velocity of the base; not in the steps of an
        impact and the first one after it.
    floor : str
        How a base that moves is moved: by the "velocity" of its joint, or by a "servo" that gives
        it one, both of which lead it by the library; by "both" its place and its velocity; by
        "position" alone.
    restitution : float or None
        Coefficient of the block.
    base_restitution : float
        That of the base, with which the library multiplies it.
    """

    geometry: str = setting("box", names=("box", "corners"))
    planar: bool = False
    aside: bool = False
    friction: float = setting(1.0, least=0.0)
    exact_inertia: bool = True
    collision: str | None = setting(names=tuple(DETECTORS))
    solver: str | None = setting(names=tuple(SOLVERS))
    split_impulse: bool | None = None
    sleeping: bool | None = None
    unit: float = setting(1.0, above=0.0)
    corner_radius: float = setting(1e-6, above=0.0)
    margin: float | None = setting(above=0.0)
    reflection: bool = False
    floor: str = setting("velocity", names=("velocity", "servo", "both", "position"))
    restitution: float | None = setting(least=0.0, most=1.0)
    base_restitution: float = setting(1.0, least=0.0, most=1.0)

    def __post_init__(self) -> None:
        check(self)


TUNED = DartSettings(
    geometry="corners",
    planar=True,
    aside=True,
    friction=10.0,
    collision="DART",
    sleeping=False,
    unit=1e5,
    floor="both",
)

LANDING = replace(TUNED, margin=0.5, reflection=True)

MASSLESS = "friction without mass: the Dantzig solver fails, and PGS answers in its stead"
UNFINISHED = "an iteration that may end before friction holds: a pivot slides in some cases"
UNIT_INERTIA = "the mass alone leaves the moments of inertia at 1 kg m2"

DOCUMENTED = (
    Citation("step", "0.001 s, the default", "World.getTimeStep"),
    Citation("solver", "Dantzig's, the default", "ConstraintSolver.getBoxedLcpSolver"),
    Citation(
        "solver",
        "where it fails PGS, 30 iterations, from the last step's impulses",
        "dart pull request 1265; PgsBoxedLcpSolverOption; ContactWarmStartCache.hpp",
    ),
    Citation("collision", "FCL's, the default", "ConstraintSolver.getCollisionDetector"),
    Citation(
        "contact",
        "of a depth 0.01 a step is corrected, by at most 0.001 a second",
        "ContactConstraint.cpp; split impulse is off",
    ),
    Citation("sleeping", "on, the default since 6.19", "World.getDeactivationOptions"),
    Citation(
        "sleeping",
        "after 0.5 s below 0.01 m/s and 0.05 rad/s; commands are said to wake",
        "DeactivationOptions.hpp, dart pull request 2920",
    ),
    Citation(
        "friction", "1, the default, of a pair the smaller", "DynamicsAspect.getFrictionCoeff"
    ),
    Citation(
        "floor",
        "a joint of ActuatorType VELOCITY, setCommands; or SERVO, a dynamic one",
        "dart/dynamics/detail/JointAspect.hpp, ActuatorType",
    ),
)
"""What its documentation sets, in dartpy 6.20.0."""

RECOMMENDED = (
    Citation("sleeping", "off, for who needs the path of before", "dart pull requests 2920, 3086"),
    Citation("solver", "Dantzig's, the default, which is more precise", "dart issue 961"),
)
"""What it recommends: no page of it is on stiff contact."""

FACTORS = (
    factor("aside", level("no", trap=MASSLESS, aside=False), name="base in the plane"),
    factor("unit", level("1e3 a metre", unit=1e3), name="unit of length"),
    factor(
        "solver",
        level("NSGS", BOTH, solver="NSGS"),
        level("FBF", BOTH, trap=UNFINISHED, solver="FBF"),
        name="solver of contact forces",
    ),
    factor("split_impulse", level("on", BOTH, split_impulse=True)),
    factor("sleeping"),
    Factor(
        "geometry",
        ("geometry", "planar", "aside"),
        (
            level("4 corners", planar=False, aside=False),
            level("planar box", geometry="box"),
        ),
    ),
    factor(
        "collision",
        level("FCL", collision="FCL"),
        level("Bullet", BOTH, collision="BULLET"),
        level("ODE", BOTH, collision="ODE"),
        level("DART", (DEFAULT,), collision="DART"),
        name="collision detector",
    ),
    factor(
        "exact_inertia",
        level("of 1 kg m²", BOTH, trap=UNIT_INERTIA, exact_inertia=False),
        name="inertia",
    ),
    factor("corner_radius", level("B/500", corner_radius=2e-3)),
    factor("margin", level("0.5", margin=0.5), level("10", margin=10.0)),
    factor("friction"),
    moving_base("both", "velocity", "servo", "position"),
)
"""What its contact can be set to."""

RULES = (
    Rule(
        "Set the moment of inertia after `setMass`, by `setMomentOfInertia`: it stays 1 kg m²",
        *(BEST, "inertia", "of 1 kg m²"),
    ),
    Rule(
        "Drive a base that moves by a joint's velocity: friction does not feel one that is placed",
        *UNMOVED_BASE,
    ),
)
"""What its users should know first."""
