"""PhysX: what it can do, how it is used, what its users should know first."""

from engines.declaration import Engine, Help, Precision, Preset, Stepping
from engines.physx.build import PhysxWorld, script
from engines.physx.settings import (
    DOCUMENTED,
    FACTORS,
    LANDING,
    RECOMMENDED,
    RULES,
    TUNED,
    PhysxSettings,
)

NAIVE = Preset(
    name="naive",
    settings=PhysxSettings(),
    step_s=0.01,
    documented=DOCUMENTED,
    frame="world",
    own={"friction": 0.3},
)

ENGINE = Engine(
    name="physx",
    title="PhysX",
    library="sapien",
    packages=("sapien",),
    install="rocking[physx]",
    build=PhysxWorld,
    stacks=True,
    presets=(
        NAIVE,
        NAIVE.at_rest(),
        NAIVE.recommended(
            *RECOMMENDED,
            step_s=1.0 / 120.0,
            tgs=True,
            iterations=64,
            velocity_iterations=4,
            bounce_threshold=0.2,
        ),
        Preset(name="fixed", settings=TUNED, step=1e-3),
        Preset(
            name="landing",
            settings=LANDING,
            stepping=Stepping.LANDING,
            stacked=None,
            helped_by={
                Help.STEPS: None,
                Help.REFLECTION: {"reflection": False},
            },
        ),
    ),
    precision=Precision.SINGLE,
    shortest_step=3e-6,
    script=script,
    factors=FACTORS,
    rules=RULES,
)
