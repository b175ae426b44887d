"""MuJoCo: what it can do, how it is used, what its users should know first."""

from engines.declaration import Deviation, Engine, Help, Preset, Stepping
from engines.mujoco.build import LIBRARY_STEP_S, world_of
from engines.mujoco.script import script
from engines.mujoco.settings import (
    DEFAULT_CONTACT_S,
    DOCUMENTED,
    FACTORS,
    LANDING,
    RECOMMENDED,
    RULES,
    STACKED,
    TUNED,
    MujocoSettings,
    spring,
)
from engines.mujoco.stacks import stacks_of
from engines.scene import GEOMETRIES, Ability

NAIVE = Preset(
    name="naive",
    settings=MujocoSettings(),
    step_s=LIBRARY_STEP_S,
    documented=DOCUMENTED,
    frame="world",
    contact_s=DEFAULT_CONTACT_S,
)

ENGINE = Engine(
    name="mujoco",
    title="MuJoCo",
    library="mujoco",
    packages=("mujoco",),
    install="rocking",
    build=world_of,
    abilities=(Ability.SEVERAL, Ability.STACKED),
    presets=(
        NAIVE,
        NAIVE.at_rest(),
        NAIVE.recommended(
            *RECOMMENDED,
            deviations=(Deviation.PEAK,),  # its floor lags
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
            builders={Ability.STACKED: stacks_of},
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
    geometries=GEOMETRIES,
    spatial=True,
    script=script,
    spring=spring,
    factors=FACTORS,
    rules=RULES,
    remedy={"impratio": 100.0},
    own_step="mujoco:mj_step",
    compiles=True,
)
