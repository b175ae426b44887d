"""Box2D: what it can do, how it is used, what its users should know first."""

from engines.box2d.build import LIBRARY_STEP_S, Box2DWorld, script
from engines.box2d.settings import (
    DOCUMENTED,
    FACTORS,
    LANDING,
    RECOMMENDED,
    RULES,
    TUNED,
    Box2DSettings,
)
from engines.box2d.stacks import Box2DStacks
from engines.declaration import Deviation, Engine, Help, Precision, Preset, Stepping
from engines.scene import Ability

NAIVE = Preset(
    name="naive",
    settings=Box2DSettings(),
    step_s=LIBRARY_STEP_S,
    documented=DOCUMENTED,
    frame="world",
    deviations=(Deviation.MIRROR, Deviation.PEAK),
    own={"friction": 0.2},
)

ENGINE = Engine(
    name="box2d",
    title="Box2D",
    library="Box2D",
    packages=("Box2D",),
    install="rocking[box2d]",
    build=Box2DWorld,
    abilities=(Ability.SEVERAL, Ability.STACKED),
    presets=(
        NAIVE,
        NAIVE.at_rest(Deviation.MIRROR, Deviation.PEAK, Deviation.RECORD, Deviation.SLEEP),
        NAIVE.recommended(
            *RECOMMENDED,
            deviations=(Deviation.MIRROR, Deviation.PEAK),
            iterations=8,
            position_iterations=3,
        ),
        Preset(
            name="fixed",
            settings=TUNED,
            step=1e-3,
            helped_by={Help.MARGIN: {"margin": None}},
        ),
        Preset(
            name="landing",
            settings=LANDING,
            stepping=Stepping.LANDING,
            stacked={"sweeps": 200.0},
            builders={Ability.STACKED: Box2DStacks},
            helped_by={
                Help.STEPS: None,
                Help.REFLECTION: {"reflection": False},
                Help.MARGIN: {"margin": None},
            },
        ),
    ),
    geometries=("box", "corners"),
    precision=Precision.SINGLE,
    shortest_step=3e-6,
    script=script,
    factors=FACTORS,
    rules=RULES,
)
