"""MuJoCo: what it can do, how it is used, what its users should know first."""

from engines.declaration import Engine, Help, Preset, Stepping
from engines.mujoco.build import LIBRARY_STEP_S, world_of
from engines.mujoco.script import script
from engines.mujoco.settings import (
    DOCUMENTED,
    FACTORS,
    LANDING,
    RECOMMENDED,
    RULES,
    STACKED,
    TUNED,
    MujocoSettings,
)
from engines.mujoco.stacks import stacks_of

NAIVE = Preset(
    name="naive",
    settings=MujocoSettings(),
    step_s=LIBRARY_STEP_S,
    documented=DOCUMENTED,
    frame="world",
)

ENGINE = Engine(
    name="mujoco",
    title="MuJoCo",
    library="mujoco",
    packages=("mujoco",),
    install="rocking",
    build=world_of,
    stacks=True,
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
        Preset(
            name="fixed",
            settings=TUNED,
            step=2.5e-4,
            stacked=STACKED,
            stacks=stacks_of,
        ),
        Preset(
            name="landing",
            settings=LANDING,
            stepping=Stepping.LANDING,
            helped_by={
                Help.STEPS: None,
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
    rules=RULES,
    compiles=True,
)
