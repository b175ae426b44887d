"""What a contact can be set to, factor by factor and engine by engine."""

from typing import Any

from studies.variants import BEST, DEFAULT, Factor, Level, level

BOTH = (BEST, DEFAULT)
UNMOVED = "a base without a velocity: friction does not feel it"
DRAG = "drag that nobody asked for"
SMOOTH = "the library's own friction: a block of H/B = 2 slides before it rocks"
STEEP = "a pyramid this steep leaves too little normal force"
SLIDES = "held out of its margin with contact ERP 1, a hull slides off its pivot"
ANCHORED = "an anchor kept through an impact drags the pivot along"
SHAPES = ("geometry", "planar")
ORIGINAL: dict[str, Any] = {"damping": None, "sliding_damping": None, "stiffness": None}
"""MuJoCo's direct form of the reference given up."""


def moving(trapped: bool) -> Level:
    """Return the base that moves in the world, or the one that is moved by position alone."""
    return Level(
        name="by position alone" if trapped else "with its velocity",
        settings={"base_velocity": not trapped},
        trap=UNMOVED if trapped else "",
        scene={"frame": "world"},
    )


MOVING_BASE = Factor(
    name="moving base",
    settings=("base_velocity",),
    levels=(moving(False), moving(True)),
)

FACTORS: dict[str, tuple[Factor, ...]] = {
    "pybullet": (
        Factor(
            name="solver",
            settings=("solver",),
            levels=(level("PGS", BOTH, solver="PGS"), level("Dantzig", BOTH, solver="Dantzig")),
        ),
        Factor(
            name="residual threshold",
            settings=("residual",),
            levels=(level("1e-5", residual=1e-5), level("1e-12", residual=1e-12)),
        ),
        Factor(name="iterations", settings=("iterations",), levels=(level("5", iterations=5),)),
        Factor(
            name="contact ERP", settings=("contact_erp",), levels=(level("0", contact_erp=0.0),)
        ),
        Factor(
            name="friction ERP", settings=("friction_erp",), levels=(level("1", friction_erp=1.0),)
        ),
        Factor(
            name="contact slop",
            settings=("contact_slop",),
            levels=(level("1 mm", contact_slop=1e-3),),
        ),
        Factor(
            name="friction anchor",
            settings=("friction_anchor",),
            levels=(
                level("on", BOTH, friction_anchor=True),
                level("on, friction ERP 1", trap=ANCHORED, friction_anchor=True, friction_erp=1.0),
            ),
        ),
        Factor(
            name="kept gap",
            settings=("breaking_threshold",),
            levels=(level("1e-5 R", breaking_threshold=1e-5),),
        ),
        Factor(
            name="yielding contact",
            settings=("contact_stiffness", "contact_damping"),
            levels=(
                level("k 1e4, c 1e2", contact_stiffness=1e4, contact_damping=1e2),
                level("k 1e4, c 1e3", contact_stiffness=1e4, contact_damping=1e3),
                level("k 1e6, c 1e5", BOTH, contact_stiffness=1e6, contact_damping=1e5),
            ),
        ),
        Factor(
            name="damping",
            settings=("damping",),
            levels=(
                level(
                    "0.04, a multibody's default",
                    trap=DRAG,
                    damping=0.04,
                ),
            ),
        ),
        Factor(
            name="coordinates",
            settings=("multibody",),
            levels=(level("reduced, default damping", multibody=True, damping=None, trap=DRAG),),
        ),
        Factor(
            name="inertia",
            settings=("exact_inertia",),
            traps={BEST: "the inertia of the corner spheres instead of the block's"},
        ),
        Factor(
            name="geometry",
            settings=(*SHAPES, "exact_inertia"),
            levels=(
                level("hull on plane", trap=SLIDES, geometry="hull"),
                level("hull on plane, default ERP", geometry="hull", contact_erp=None),
                level("hull on plane", (DEFAULT,), geometry="hull"),
                level("2 corners on box", base_geometry="box"),
                level("box on box", BOTH, geometry="box", base_geometry="box"),
                level("hull on box", trap=SLIDES, geometry="hull", base_geometry="box"),
                level("hull on box", (DEFAULT,), geometry="hull", base_geometry="box"),
                level(
                    "4 corners on plane", BOTH, geometry="corners", planar=False, exact_inertia=True
                ),
                level("corners of B/500", corner_radius=2e-3),
                level("box, separating axes", geometry="box", separating_axis=True),
            ),
        ),
        Factor(
            name="split impulse",
            settings=("split_impulse",),
            levels=(level("on", split_impulse=True), level("off", split_impulse=False)),
        ),
        Factor(
            name="friction cone",
            settings=("cone_friction",),
            levels=(
                level("cone", BOTH, cone_friction=True),
                level("pyramid", BOTH, cone_friction=False),
            ),
        ),
        Factor(
            name="warm starting",
            settings=("warm_starting",),
            levels=(level("off", warm_starting=0.0), level("0.95", warm_starting=0.95)),
        ),
        Factor(
            name="friction",
            settings=("friction",),
            traps={BEST: SMOOTH},
            levels=(level("0.5, the library's own", (DEFAULT,), SMOOTH, friction=0.5),),
        ),
        MOVING_BASE,
    ),
    "mujoco": (
        Factor(
            name="cone",
            settings=("cone",),
            levels=(
                level("pyramid, friction 1", cone="pyramidal", friction=1.0),
                level(
                    "pyramid, friction 1000",
                    trap=STEEP,
                    cone="pyramidal",
                    friction=1e3,
                ),
                level("ellipse, friction 10", (DEFAULT,), cone="elliptic", friction=10.0),
                level("ellipse, friction 1000", cone="elliptic", friction=1e3),
            ),
        ),
        Factor(name="friction", settings=("friction",), traps={DEFAULT: STEEP}),
        Factor(
            name="solver",
            settings=("solver",),
            by_default=False,
            levels=(level("CG", BOTH, solver="CG"), level("PGS", BOTH, solver="PGS")),
        ),
        Factor(
            name="solver tolerance",
            settings=("tolerance",),
            levels=(level("1e-4", tolerance=1e-4),),
        ),
        Factor(
            name="solver iterations",
            settings=("iterations",),
            by_default=False,
            levels=(level("2", iterations=2),),
        ),
        Factor(
            name="reference",
            settings=(*ORIGINAL, "impedance"),
            levels=(
                level("0.02 s 1, best impedance", **ORIGINAL),
                level("2 dt 1", solref=(2.0, 1.0), **ORIGINAL),
                level("10 dt 1", solref=(10.0, 1.0), **ORIGINAL),
                level("2 dt 1", (DEFAULT,), solref=(2.0, 1.0)),
                level(
                    "2 dt 0",
                    trap="one zero makes it the default, 0.02 s 1",
                    solref=(2.0, 0.0),
                    **ORIGINAL,
                ),
                level("b dt 0.3", damping=0.3, sliding_damping=0.3),
                level("b dt 1.9", damping=1.9, sliding_damping=1.9),
                level("k dt² 1e-4", stiffness=1e-4),
                level("k dt² 0.3", stiffness=0.3),
            ),
        ),
        Factor(
            name="impedance",
            settings=("impedance",),
            by_default=False,
            levels=(
                level("0.9 to 0.95, the default", impedance=(0.9, 0.95, 0.001, 0.5, 2.0)),
                level("0.99", impedance=(0.99, 0.99, 0.001, 0.5, 2.0)),
            ),
        ),
        Factor(name="impratio", settings=("impratio",), levels=(level("100", impratio=100.0),)),
        Factor(
            name="noslip",
            settings=("noslip_iterations",),
            levels=(level("10 iterations", BOTH, noslip_iterations=10),),
        ),
        Factor(
            name="integrator",
            settings=("integrator",),
            levels=(
                level("implicit", BOTH, integrator="implicit"),
                level("implicitfast", integrator="implicitfast"),
            ),
        ),
        Factor(
            name="margin",
            settings=("margin",),
            levels=(level("1e-3 B", margin=1e-3), level("1e-2 B", margin=1e-2)),
        ),
        Factor(
            name="geometry",
            settings=SHAPES,
            levels=(
                level("planar box", geometry="box"),
                level("hull", BOTH, geometry="hull"),
                level("4 corners, free", planar=False),
                level("planar box", (DEFAULT,), planar=True),
            ),
        ),
        MOVING_BASE,
    ),
}
"""Engine -> what its contact can be set to."""
