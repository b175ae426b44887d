"""PyBullet: its presets, where they come from, and what the studies try of its settings."""

from dataclasses import replace
from typing import Any

from engines.declaration import Engine, Help, Preset, citations, default, landing
from engines.factors import BEST, BOTH, DEFAULT, factor, level, moving_base
from engines.pybullet.build import LIBRARY_STEP_S, BulletSettings, BulletWorld

TUNED = BulletSettings(
    geometry="corners",
    planar=True,
    multibody=False,
    friction=10.0,  # the most that the library takes
    exact_inertia=True,
    damping=0.0,
    sweeps=25.0,  # twice what leaves no more than a rounding of the impulses at two corners
    residual=1e-20,
    contact_erp=1.0,
    friction_erp=0.0,
    contact_slop=0.0,
    floor="velocity",
)

LANDING = replace(
    TUNED, residual=1e-32, friction_erp=1.0, friction_anchor=True, gap_by_step=True, by_phase=True
)

STACKED: dict[str, Any] = {"geometry": "box", "base_geometry": "box", "iterations": 250}
"""Where bodies rest on others: corner spheres under a body that moves throw it."""

GUIDE = "PyBullet Quickstart Guide, 2016-2022"
READ = "of pybullet 3.2.7"
SERVER = "PhysicsServerCommandProcessor.cpp"
EXAMPLE = "pybullet_examples/constraint.py, pybullet_data/cube_small.urdf"

DOCUMENTED = citations(f"""
step | 240 Hz: best to leave it to the default | {GUIDE}, setTimeStep
iterations | numSolverIterations 50 | getPhysicsEngineParameters {READ}
residual | solverResidualThreshold 1e-7 | {GUIDE}, setPhysicsEngineParameter
kept gap | contactBreakingThreshold 0.02 | {GUIDE}, setPhysicsEngineParameter
friction cone | cone is default | {GUIDE}, setPhysicsEngineParameter
friction anchor | disabled by default | {GUIDE}, changeDynamics
damping | linear and angular, 0.04 by default | {GUIDE}, changeDynamics
friction | 0.5, of a pair the product: 0.5 on an example's floor of 1, 0.25 on another; here 1.0 |
    getDynamicsInfo, btManifoldResult.cpp {READ}
contact | contactERP 0.08, contactSlop 1e-5 | {SERVER} {READ}
restitution | 0.0 | getDynamicsInfo {READ}
sleeping | off but for URDF_ENABLE_SLEEPING | {GUIDE}, changeDynamics
floor | better constraints than position or velocity | {GUIDE}, createConstraint
floor | JOINT_FIXED, changeConstraint, maxForce 50 on 0.1 kg | {EXAMPLE} {READ}
floor | of what it is off, erp 0.2 a step | btContactSolverInfo.h {READ}
without effect | frictionERP 0.2, warmStartingFactor 0.1, restitutionVelocityThreshold 0.2,
    collisionMargin 0.001, speeds up to 100 | {SERVER}, btContactSolverInfo.h, btMultiBody.cpp
    {READ}
""")
"""Where the library's documentation, or the library itself, says what its defaults decide."""

RECOMMENDED = citations("""
iterations | best left at 50; more, for accuracy | bullet3 issue 3081, its author
iterations | 150, its own environment | kuka_diverse_object_gym_env.py
damping | 0, its own environments | cartpole_bullet.py, quadruped_base.py
""")
"""What it recommends for accurate contact: no text gives a number, its environments do."""

PASTED = citations("""
kept gap | contactBreakingThreshold 0.001, before any shape | measured here
iterations | 100, and a residual of 0: to their end | measured here
damping | 0, its own environments | cartpole_bullet.py, quadruped_base.py
floor | a box: on GEOM_PLANE a box turns and creeps | measured here
""")

DRAG = "drag that nobody asked for"
SLIDES = "held out of its margin with contact ERP 1, a hull slides off its pivot"
SMOOTH = "the library's own friction: a block of H/B = 2 slides before it rocks"
ANCHORED = "an anchor kept through an impact drags the pivot along"
SPHERES = "the inertia of the corner spheres instead of the block's"
HULL_ON_BOX: dict[str, Any] = {"geometry": "hull", "base_geometry": "box"}

FACTORS = (
    factor("solver", level("PGS", BOTH, solver="PGS"), level("Dantzig", BOTH, solver="Dantzig")),
    factor(
        "residual",
        level("1e-5", residual=1e-5),
        level("1e-12", residual=1e-12),
        name="residual threshold",
    ),
    factor(("iterations", "sweeps"), level("5", iterations=5), level("1000", iterations=1000)),
    factor("contact_erp", level("0", contact_erp=0.0), name="contact ERP"),
    factor("friction_erp", level("1", friction_erp=1.0), name="friction ERP"),
    factor(
        "constraint_erp",
        level("0.8", (DEFAULT,), constraint_erp=0.8),
        name="constraint ERP",
        by_default=False,
    ),
    factor("contact_slop", level("1 mm", contact_slop=1e-3)),
    factor(
        "friction_anchor",
        level("on", BOTH, friction_anchor=True),
        level("on, friction ERP 1", trap=ANCHORED, friction_anchor=True, friction_erp=1.0),
    ),
    factor("breaking_threshold", level("1e-5 R", breaking_threshold=1e-5), name="kept gap"),
    factor(
        ("contact_stiffness", "contact_damping"),
        level("k 1e4, c 1e2", contact_stiffness=1e4, contact_damping=1e2),
        level("k 1e4, c 1e3", contact_stiffness=1e4, contact_damping=1e3),
        level("k 1e6, c 1e5", BOTH, contact_stiffness=1e6, contact_damping=1e5),
        name="yielding contact",
    ),
    factor("damping", level("0.04, a multibody's default", trap=DRAG, damping=0.04)),
    factor(
        "multibody",
        level("reduced, default damping", trap=DRAG, multibody=True, damping=None),
        name="coordinates",
    ),
    factor("exact_inertia", name="inertia", traps={BEST: SPHERES}),
    factor(
        ("geometry", "planar", "exact_inertia"),
        level("hull on plane", trap=SLIDES, geometry="hull"),
        level("hull on plane, default ERP", geometry="hull", contact_erp=None),
        level("hull on plane", (DEFAULT,), geometry="hull"),
        level("2 corners on box", base_geometry="box"),
        level("box on box", BOTH, geometry="box", base_geometry="box"),
        level("hull on box", trap=SLIDES, **HULL_ON_BOX),
        level("hull on box", (DEFAULT,), **HULL_ON_BOX),
        level("4 corners on plane", BOTH, geometry="corners", planar=False, exact_inertia=True),
        level("corners of B/500", corner_radius=2e-3),
        level("box, separating axes", geometry="box", separating_axis=True),
    ),
    factor("split_impulse", level("on", split_impulse=True), level("off", split_impulse=False)),
    factor(
        "cone_friction",
        level("cone", BOTH, cone_friction=True),
        level("pyramid", BOTH, cone_friction=False),
        name="friction cone",
    ),
    factor("warm_starting", level("off", warm_starting=0.0), level("0.95", warm_starting=0.95)),
    factor("friction", level("0.5, the library's own", (DEFAULT,), SMOOTH, friction=0.5)),
    moving_base("velocity", "constraint", "position"),
)

NAIVE = default(BulletSettings(), LIBRARY_STEP_S, DOCUMENTED, friction=0.5)

ENGINE = Engine(
    name="pybullet",
    title="PyBullet",
    library="pybullet",
    build=BulletWorld,
    stacks=True,
    offsets=True,
    lifts=("velocity", "constraint"),
    presets=(
        NAIVE,
        NAIVE.at_rest(),
        NAIVE.recommended(*RECOMMENDED, iterations=150, damping=0.0),
        NAIVE.pasted(
            *PASTED,
            base_geometry="box",
            breaking_threshold=1e-3,
            iterations=100,
            residual=0.0,
            damping=0.0,
        ),
        Preset(name="tuned", settings=TUNED, step=5e-4, stacked=STACKED),
        landing(
            LANDING,
            {Help.PHASES: {"by_phase": False}, Help.MARGIN: {"gap_by_step": False}},
            # with fewer, the impulses of an impact have not settled among all contacts when a step
            # ends: some bodies meet a step late, and the peak is up to 22 % too large
            stacked={**STACKED, "iterations": 10_000, "overlap": 1e-9},
        ),
    ),
    core=True,
    script=BulletWorld.script,
    factors=FACTORS,
)
