"""What Newton can be set to: its settings, the tuned ones, and what the studies try of them."""

from dataclasses import dataclass
from typing import Any

from engines.declaration import (
    AS_BEST,
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
from engines.settings import check, given, setting

XPBD = "xpbd"
"""The solver by positions; the other ones are Kamino's, by impulses."""

SOLVERS = (XPBD, "padmm", "dvi")


@dataclass(frozen=True, slots=True, kw_only=True)
class NewtonSettings:
    """Settings of Newton, by default those of its own example of a belt; None leaves its own.

    Attributes
    ----------
    geometry : str
        "box", or "corners": four small spheres where the corners at the base are.
    friction : float
        Coefficient between block and base.
    solver : str
        "xpbd", or Kamino with one of its two solvers of dynamics, "padmm" or "dvi".
    iterations : int or None
        Of "xpbd", whose own are 2, and "padmm"; "dvi" has none.
    relaxation : float or None
        Part of a contact's correction that "xpbd" makes in an iteration; its own is 0.8.
    weighting : bool or None
        Whether "xpbd" divides a correction by the number of contacts, by which momentum is lost.
    baumgarte : float or None
        Part of a penetration that Kamino corrects in a step, by a velocity; its own is 0.01.
    depth : float or None
        Penetration over the width that Kamino leaves as it is; its own is 1e-6 m.
    tolerance : float or None
        Of "padmm"; its own is 1e-6.
    restitution : float or None
        Coefficient of block and base; "xpbd" heeds it where it is told to, as here.
    corner_radius : float
        Radius of the corner spheres over the width.
    floor : str
        How a base that moves is moved: by its "velocity", or by "position" alone.
    """

    geometry: str = setting("box", names=("box", "corners"))
    friction: float = setting(1.0, least=0.0)
    solver: str = setting(XPBD, names=SOLVERS)
    iterations: int | None = setting(least=1)
    relaxation: float | None = setting(above=0.0, most=2.0)
    weighting: bool | None = None
    baumgarte: float | None = setting(least=0.0, most=1.0)
    depth: float | None = setting(least=0.0)
    tolerance: float | None = setting(above=0.0)
    restitution: float | None = setting(least=0.0, most=1.0)
    corner_radius: float = setting(1e-3, above=0.0)
    floor: str = setting("velocity", names=("velocity", "position"))

    def __post_init__(self) -> None:
        check(self)
        if self.iterations is not None and self.solver == "dvi":
            raise ValueError(f"iterations are {self.iterations!r}; the solver 'dvi' takes none")

    def of_xpbd(self) -> dict[str, Any]:
        """Return the arguments of XPBD that are set."""
        return given(
            {
                "iterations": self.iterations,
                "rigid_contact_relaxation": self.relaxation,
                "rigid_contact_con_weighting": self.weighting,
                "enable_restitution": None if self.restitution is None else True,
            }
        )


DOMINOES = "newton/examples/contacts/example_domino_spiral.py, newton 1.8.0"
BELT = "newton/examples/basic/example_basic_conveyor.py, newton 1.8.0"

DOCUMENTED = (
    Citation("step", "fps = 100, sim_substeps = 10", BELT),
    Citation("solver", "newton.solvers.SolverXPBD(model), the example's --solver by default", BELT),
    Citation("iterations", "Defaults to 2.", "SolverXPBD, newton 1.8.0"),
    Citation(
        "contact",
        "rigid_contact_relaxation 0.8, rigid_contact_con_weighting True, enable_restitution False",
        "SolverXPBD, newton 1.8.0",
    ),
    Citation("damping", "angular_damping: Defaults to 0.0.", "SolverXPBD, newton 1.8.0"),
    Citation(
        "friction",
        "mu: float = 1.0, of a pair the mean",
        "ModelBuilder.ShapeConfig; xpbd/kernels.py, newton 1.8.0",
    ),
    Citation("gap", "contacts are made from rigid_gap 0.1 away", "ModelBuilder, newton 1.8.0"),
    Citation(
        "floor",
        "is_kinematic=True on a joint; joint_q and joint_qd in each substep, then "
        "eval_fk(..., body_flag_filter=BodyFlags.KINEMATIC)",
        BELT,
    ),
    Citation("shapes", "a box on add_shape_plane(body=belt), where the solver is Kamino", BELT),
)
"""What the preset "naive" is documented by: the example in which a floor moves."""

RECOMMENDED = (
    Citation("step", "a smaller dt first, before all else of a solver", "simulation_tuning.rst"),
    Citation("step", "60 fps of 10 substeps, free dominoes", DOMINOES),
    Citation("iterations", "20, free dominoes; enable_restitution, which is left off", DOMINOES),
)
"""What it recommends for less penetration: a smaller step, then more iterations."""

TUNED = NewtonSettings(solver="dvi", friction=NO_JAM, baumgarte=0.0)

OVERDONE = "both corners correct all of a penetration that they share"

FACTORS = (
    Factor(
        "solver",
        ("solver", "iterations"),
        (
            level("XPBD, 50 iterations", BOTH, solver=XPBD, iterations=50),
            level("Kamino by PADMM", BOTH, solver="padmm", iterations=200),
        ),
    ),
    factor("relaxation", level("1", (DEFAULT,), relaxation=1.0), by_default=False),
    factor("weighting", level("no", (DEFAULT,), OVERDONE, weighting=False), by_default=False),
    factor("baumgarte", level("0.1", baumgarte=0.1)),
    factor("geometry", level("corners", BOTH, geometry="corners")),
    factor("friction"),
    moving_base("velocity", "position"),
)
"""What its contact can be set to."""

RULES = (
    Rule(
        "Use Kamino, `SolverKamino` with `dynamics_solver='dvi'`, where XPBD is the example's",
        *(DEFAULT, "solver", AS_BEST),
        kept=True,
    ),
    Rule(
        "Set Kamino's `config.constraints.gamma` to 0: it makes speed of a depth, the more of it "
        "the shorter the step",
        *(BEST, "baumgarte", BY_DEFAULT),
    ),
    Rule(
        "Give a kinematic base its `joint_qd` beside `joint_q`: friction does not feel a place",
        *UNMOVED_BASE,
    ),
)
"""What its users should know first."""
