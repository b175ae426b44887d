"""PyBullet: what it can do, how it is used, what its users should know first."""

from engines.declaration import Engine, Help, Preset, Stepping
from engines.pybullet.build import BulletWorld
from engines.pybullet.script import script
from engines.pybullet.settings import (
    DOCUMENTED,
    FACTORS,
    LANDING,
    LIBRARY_STEP_S,
    RECOMMENDED,
    RULES,
    STACKED,
    TUNED,
    BulletSettings,
)

NAIVE = Preset(
    name="naive",
    settings=BulletSettings(),
    step_s=LIBRARY_STEP_S,
    documented=DOCUMENTED,
    frame="world",
    own={"friction": 0.5},
)

ENGINE = Engine(
    name="pybullet",
    title="PyBullet",
    library="pybullet",
    packages=("pybullet",),
    install="rocking[pybullet]",
    build=BulletWorld,
    stacks=True,
    presets=(
        NAIVE,
        NAIVE.at_rest(),
        NAIVE.recommended(*RECOMMENDED, iterations=150, damping=0.0),
        Preset(name="fixed", settings=TUNED, step=5e-4, stacked=STACKED),
        Preset(
            name="landing",
            settings=LANDING,
            stepping=Stepping.LANDING,
            # with fewer, the impulses of an impact have not settled among all contacts when a step
            # ends: some bodies meet a step late, and the peak is up to 22 % too large
            stacked={**STACKED, "iterations": 3000},
            helped_by={
                Help.STEPS: None,
                Help.PHASES: {"by_phase": False},
                Help.MARGIN: {"gap_by_step": False},
            },
        ),
    ),
    core=True,
    script=script,
    factors=FACTORS,
    rules=RULES,
)
