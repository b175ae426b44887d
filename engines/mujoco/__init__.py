"""MuJoCo: its presets, where they come from, and what the studies try of its settings."""

from dataclasses import replace
from typing import Any

from engines.declaration import Engine, Help, Preset, citations, default, landing
from engines.factors import BOTH, DEFAULT, factor, level, moving_base
from engines.mujoco.build import MujocoSettings, MujocoWorld, script

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

STACKED = {"friction": 2.0, "impratio": 100.0, "tolerance": 0.0, "soft_surface": 4.0}
"""Where bodies rest on others: with the block's own contact they part (`MujocoSettings.fitted`)."""

SLIDING: dict[str, Any] = {
    "impedance": (1e-4, 1e-4, 0.001, 0.5, 2.0),
    "stiffness": 1e6,
    "damping": 1e3,
    "impratio": 1e6,
}
"""Where a block slides. A stiff contact initiates slip by a motion mu v in the normal direction
(computation/index.rst, "Physical realism and soft contacts"), which throws the block off. Of that
the least impedance acts here; the reference makes up for it, with k dt^2 0.01 and b dt 0.1."""

STEEP = "a pyramid this steep leaves too little normal force"
ZERO = "one zero makes it the default, 0.02 s 1"
ORIGINAL: dict[str, Any] = {"damping": None, "sliding_damping": None, "stiffness": None}
"""The direct form of the reference given up."""

REFERENCE, MODELING = "XMLreference.rst of MuJoCo 4.0.0", "modeling.rst of MuJoCo 4.0.0"
GEOM = f"{REFERENCE}, body/geom"

DOCUMENTED = citations(f"""
step | timestep 0.002 | {REFERENCE}, option
integrator | Euler | {REFERENCE}, option
solver | Newton, iterations 100, tolerance 1e-8 | {REFERENCE}, option
cone | pyramidal, impratio 1 | {REFERENCE}, option
noslip | noslip_iterations 0 | {REFERENCE}, option
sleeping | sleep disable | {REFERENCE}, option/flag
friction | 1 0.005 0.0001, as here, of a pair the larger | {GEOM}
friction | condim 3: sliding alone, neither spin nor roll | {GEOM}
margin | 0 | {GEOM}
contact | solref 0.02 1, solimp 0.9 0.95 0.001 0.5 2 | {MODELING}, Solver parameters
contact | its inertia by an estimate: diagexact off | {REFERENCE}, option/flag
without effect | refsafe, island and multiccd on, ls_iterations 50, ls_tolerance 0.01; the warm
    start's is below 1e-3 | {REFERENCE}, option, option/flag
floor | a regular body, weld to a mocap body: better-behaved | {MODELING}, MoCap bodies
""")
"""What the library's documentation says of all that its defaults decide."""

RECOMMENDED = citations(f"""
integrator | implicitfast | {MODELING}, Tuning defaults
cone | elliptic, impratio 10 | {MODELING}, Tuning defaults
contact, weld | solref[0] 0.004 to 0.01 s, at least 2 timesteps | {MODELING}, the same
solver | Newton, tolerance 1e-10 | {MODELING}, the same
""")
"""What it recommends for rigid contact in place of its defaults, which it does not."""

PASTED = citations(f"""
contact | solref in the direct form, -0.01/dt² and -1/dt; solimp 0.9999: rigid, and damped at once
    | {MODELING}, Solver parameters; the numbers measured here
""")

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
        "solver", level("CG", BOTH, solver="CG"), level("PGS", BOTH, solver="PGS"), by_default=False
    ),
    factor("tolerance", level("1e-4", tolerance=1e-4), name="solver tolerance"),
    factor("iterations", level("2", iterations=2), name="solver iterations", by_default=False),
    factor(
        (*ORIGINAL, "impedance"),
        level("0.02 s 1, best impedance", **ORIGINAL),
        level("2 dt 1", solref=(2.0, 1.0), **ORIGINAL),
        level("10 dt 1", solref=(10.0, 1.0), **ORIGINAL),
        level("2 dt 1", (DEFAULT,), solref=(2.0, 1.0)),
        level("2 dt 0", trap=ZERO, solref=(2.0, 0.0), **ORIGINAL),
        level("b dt 0.3", damping=0.3, sliding_damping=0.3),
        level("b dt 1.9", damping=1.9, sliding_damping=1.9),
        level("k dt² 1e-4", stiffness=1e-4),
        level("k dt² 0.3", stiffness=0.3),
        level("as for a slide", **SLIDING),
        name="reference",
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
    factor(
        ("geometry", "planar"),
        level("planar box", geometry="box"),
        level("hull", BOTH, geometry="hull"),
        level("4 corners, free", planar=False),
        level("planar box", (DEFAULT,), planar=True),
    ),
    moving_base("surfacevel", "weld", "position"),
)

NAIVE = default(MujocoSettings(), 2e-3, DOCUMENTED)

ENGINE = Engine(
    name="mujoco",
    title="MuJoCo",
    library="mujoco",
    install="rocking",
    build=MujocoWorld,
    stacks=True,
    offsets=True,
    lifts=("weld",),
    presets=(
        NAIVE,
        NAIVE.at_rest(),
        NAIVE.recommended(
            *RECOMMENDED,
            integrator="implicitfast",
            cone="elliptic",
            impratio=10.0,
            solref=(2.0, 1.0),
            solver="Newton",
            tolerance=1e-10,
        ),
        NAIVE.pasted(*PASTED, geom_reference=(0.01, 1.0), impedance=(0.9999, 0.9999, 0.001)),
        Preset(name="tuned", settings=TUNED, step=2.5e-4, stacked=STACKED, sliding=SLIDING),
        landing(
            LANDING,
            {
                Help.PHASES: {"by_phase": False},
                Help.REFLECTION: {"reflection": False},
                Help.MARGIN: {"carry": None, "preload": False},
                Help.PRELOAD: {"preload": False},
            },
        ),
    ),
    core=True,
    script=script,
    factors=FACTORS,
    compiles=True,
)
