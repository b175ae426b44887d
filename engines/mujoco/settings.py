"""What MuJoCo can be set to: its settings, the tuned ones, and what the studies try of them."""

from dataclasses import dataclass, replace
from typing import Any

from engines.declaration import (
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
from engines.scene import Scene
from engines.settings import check, setting

INTEGRATORS = ("Euler", "RK4", "implicit", "implicitfast")
"""Integrators of the library."""

NARROWEST_CONE = 0.1
"""Friction over the root of impratio: what the solver takes for the cone; it errs in a narrower
one."""

DEFAULT_CONTACT_S = 0.02
"""Time constant [s] of the library's own contact, which does not follow the step."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MujocoSettings:
    """Settings of MuJoCo, by default its own; None leaves a setting to the library.

    A contact holds its points to the acceleration -b v - k r, v being their velocity and r the
    gap. Here b and k are given without units, as b dt and k dt^2: b dt = 1 takes all velocity out
    of a contact within one step.

    Attributes
    ----------
    geometry : str
        "box", "corners": small spheres where the corners at the base are, or "hull": a convex
        mesh of the block's eight corners.
    planar : bool
        Give the block two slides and a hinge, and two corners in the middle plane, instead of a
        free joint and four corners at the edges.
    friction : float
        Coefficient between block and base.
    corner_radius : float
        Radius of the corner spheres over the width.
    cone, solver, jacobian, tolerance, iterations, impratio, noslip_iterations : optional
        Options of the contact solver.
    diagexact : bool or None
        Scale each contact's regularization by the inertia that it feels, not by an estimate of it
        made where the bodies were built.
    integrator : str or None
        "Euler", "RK4", "implicit" or "implicitfast".
    damping, sliding_damping : float or None
        b dt along the contact's normal and along the base; both or neither.
    stiffness : float or None
        k dt^2, wherever damping is set.
    impedance : tuple of float or None
        The five numbers of solimp; needed wherever damping is set.
    soft_surface : float or None
        Depth over g dt^2 within which a contact grows from the first of the impedances to the
        second, in place of their width; it keeps contacts that close together from parting. Of
        bodies that rest on others it is over g dt^2 sin(alpha)^2, and softens the first one, too.
    solref : tuple of float or None
        The contact in the library's other form, in place of damping and stiffness: its time
        constant over dt and its damping ratio. Both should be positive: the library takes a pair
        with one zero for its own default, and goes on.
    margin : float or None
        Gap, over the width, from which on a contact acts.
    floor : str
        How a base that moves is moved: by a "weld" to a body that is, by its "surfacevel", or by
        "position" alone.
    by_phase : bool
        Use `stiffness` at rest alone.
    reflection : bool
        Give the velocity of the corner about which the block turns back to it, so that its mean
        over a step is zero; in the steps of an impact and the first one after it is taken out.
    carry : float or None
        Gap, over the width, within which the corner about which the block turns stays in contact,
        however long the step; the other corners act at the depth to which they carry the weight.
    preload : bool
        Press that corner from the start of a step by what its force yields, where `carry` is set.
    """

    geometry: str = setting("box", names=("box", "corners", "hull"))
    planar: bool = False
    friction: float = setting(1.0, least=0.0)
    corner_radius: float = setting(1e-7, above=0.0)
    cone: str | None = None
    solver: str | None = None
    jacobian: str | None = None
    tolerance: float | None = setting(least=0.0)
    iterations: int | None = setting(least=0)
    diagexact: bool | None = None
    impratio: float | None = setting(least=0.0)
    # a reference with one zero would be replaced by the library's default
    damping: float | None = setting(above=0.0, beside=("sliding_damping", "stiffness"))
    sliding_damping: float | None = setting(above=0.0)
    stiffness: float | None = setting(above=0.0)
    impedance: tuple[float, ...] | None = None
    soft_surface: float | None = setting(above=0.0)
    by_phase: bool = False
    reflection: bool = False
    carry: float | None = setting(above=0.0)
    preload: bool = False
    integrator: str | None = setting(names=INTEGRATORS)
    noslip_iterations: int | None = setting(least=0)
    solref: tuple[float, float] | None = None
    margin: float | None = setting(least=0.0)
    floor: str = setting("weld", names=("weld", "surfacevel", "position"))

    def __post_init__(self) -> None:
        check(self)
        if self.damping is not None and self.impedance is None:
            raise ValueError("impedance is None; it must be given wherever damping is")
        if self.solref is not None and self.damping is not None:
            raise ValueError(
                f"solref is {self.solref!r}; it must be None wherever damping is given"
            )


TUNED = MujocoSettings(
    geometry="corners",
    planar=True,
    friction=10.0,
    cone="elliptic",
    solver="Newton",
    jacobian="dense",
    tolerance=1e-15,
    iterations=100,
    impratio=1e4,
    damping=1.0,
    sliding_damping=1.0,
    stiffness=0.01,
    impedance=(0.9999, 0.9999, 0.001, 0.5, 2.0),
    floor="surfacevel",
)

LANDING = replace(
    TUNED,
    friction=1e3,
    stiffness=1.0,
    impratio=3e3,
    by_phase=True,
    reflection=True,
    carry=1e-4,
    preload=True,
)

STACKED: dict[str, Any] = {
    "friction": 2.0,
    "impratio": 100.0,
    "tolerance": 0.0,
    "soft_surface": 4.0,
}
"""Where bodies rest on others: with the block's own contact they part; the softness of the surface
is over sin(alpha)^2 (`engines.mujoco.stacks`)."""

STEEP = "a pyramid this steep leaves too little normal force"
ZERO = "one zero makes it the default, 0.02 s 1"
ORIGINAL: dict[str, Any] = {"damping": None, "sliding_damping": None, "stiffness": None}
"""The direct form of the reference given up."""

REFERENCE, MODELING = "XMLreference.rst of MuJoCo 4.0.0", "modeling.rst of MuJoCo 4.0.0"

DOCUMENTED = (
    Citation("step", "timestep 0.002", f"{REFERENCE}, option"),
    Citation("integrator", "Euler", f"{REFERENCE}, option"),
    Citation("solver", "Newton, iterations 100, tolerance 1e-8", f"{REFERENCE}, option"),
    Citation("cone", "pyramidal, impratio 1", f"{REFERENCE}, option"),
    Citation("noslip", "noslip_iterations 0", f"{REFERENCE}, option"),
    Citation("sleeping", "sleep disable", f"{REFERENCE}, option/flag"),
    Citation(
        "friction", "1 0.005 0.0001, as here, of a pair the larger", f"{REFERENCE}, body/geom"
    ),
    Citation(
        "friction", "condim 3: sliding alone, neither spin nor roll", f"{REFERENCE}, body/geom"
    ),
    Citation("margin", "0", f"{REFERENCE}, body/geom"),
    Citation(
        "contact", "solref 0.02 1, solimp 0.9 0.95 0.001 0.5 2", f"{MODELING}, Solver parameters"
    ),
    Citation("contact", "its inertia by an estimate: diagexact off", f"{REFERENCE}, option/flag"),
    Citation(
        "without effect",
        "refsafe, island and multiccd on, ls_iterations 50, ls_tolerance 0.01; the warm start's "
        "is below 1e-3",
        f"{REFERENCE}, option, option/flag",
    ),
    Citation(
        "floor", "a regular body, weld to a mocap body: better-behaved", f"{MODELING}, MoCap bodies"
    ),
)
"""What the library's documentation says of all that its defaults decide."""

RECOMMENDED = (
    Citation("integrator", "implicitfast", f"{MODELING}, Tuning defaults"),
    Citation("cone", "elliptic, impratio 10", f"{MODELING}, Tuning defaults"),
    Citation("contact", "solref[0] 0.004 to 0.01 s, at least 2 timesteps", f"{MODELING}, the same"),
    Citation("solver", "Newton, tolerance 1e-10", f"{MODELING}, the same"),
)
"""What it recommends for rigid contact in place of its defaults, which it does not."""

FACTORS = (
    factor(
        "cone",
        level("pyramid, friction 1", cone="pyramidal", friction=1.0),
        level("pyramid, friction 1000", trap=STEEP, cone="pyramidal", friction=1e3),
        level("ellipse, friction 10", (DEFAULT,), cone="elliptic", friction=10.0),
        level("ellipse, friction 1000", cone="elliptic", friction=1e3),
    ),
    factor("friction", traps={DEFAULT: STEEP}),
    factor(
        "solver",
        level("CG", BOTH, solver="CG"),
        level("PGS", BOTH, solver="PGS"),
        by_default=False,
    ),
    factor("tolerance", level("1e-4", tolerance=1e-4), name="solver tolerance"),
    factor("iterations", level("2", iterations=2), name="solver iterations", by_default=False),
    Factor(
        "reference",
        (*ORIGINAL, "impedance"),
        (
            level("0.02 s 1, best impedance", **ORIGINAL),
            level("2 dt 1", solref=(2.0, 1.0), **ORIGINAL),
            level("10 dt 1", solref=(10.0, 1.0), **ORIGINAL),
            level("2 dt 1", (DEFAULT,), solref=(2.0, 1.0)),
            level("2 dt 0", trap=ZERO, solref=(2.0, 0.0), **ORIGINAL),
            level("b dt 0.3", damping=0.3, sliding_damping=0.3),
            level("b dt 1.9", damping=1.9, sliding_damping=1.9),
            level("k dt² 1e-4", stiffness=1e-4),
            level("k dt² 0.3", stiffness=0.3),
        ),
    ),
    factor(
        "impedance",
        level("0.9 to 0.95, the default", impedance=(0.9, 0.95, 0.001, 0.5, 2.0)),
        level("0.99", impedance=(0.99, 0.99, 0.001, 0.5, 2.0)),
        by_default=False,
    ),
    factor("impratio", level("100", impratio=100.0)),
    factor("diagexact", level("exact", BOTH, diagexact=True), name="inertia of a contact"),
    factor("noslip_iterations", level("10 iterations", BOTH, noslip_iterations=10), name="noslip"),
    factor(
        "integrator",
        level("RK4", BOTH, integrator="RK4"),
        level("implicit", integrator="implicit"),
        level("implicitfast", integrator="implicitfast"),
    ),
    factor("margin", level("1e-3 B", margin=1e-3), level("1e-2 B", margin=1e-2)),
    Factor(
        "geometry",
        ("geometry", "planar"),
        (
            level("planar box", geometry="box"),
            level("hull", BOTH, geometry="hull"),
            level("4 corners, free", planar=False),
            level("planar box", (DEFAULT,), planar=True),
        ),
    ),
    moving_base("surfacevel", "weld", "position"),
)
"""What its contact can be set to."""

RULES = (
    Rule(
        "Give contacts a `solref` that follows the step: it is 0.02 s, and soft",
        *(DEFAULT, "reference", "2 dt 1"),
        kept=True,
    ),
    Rule(
        "Give a base that is moved its velocity, `surfacevel`: friction does not feel a mocap move",
        *UNMOVED_BASE,
    ),
)
"""What its users should know first."""


def kept(scene: Scene, s: MujocoSettings) -> MujocoSettings:
    """Return settings with a preset's impratio kept to what the friction allows.

    Parameters
    ----------
    scene : Scene, whose own impratio, where its settings have one, is left as it is
    s : MujocoSettings, the preset's with the scene's in their place

    Returns
    -------
    MujocoSettings
        With an impratio of at most (friction/`NARROWEST_CONE`)^2.
    """
    if s.impratio is None or "impratio" in scene.settings:
        return s
    return replace(s, impratio=min(s.impratio, (s.friction / NARROWEST_CONE) ** 2))
