"""pymunk: what it can do, how it is used, what its users should know first."""

from engines.declaration import Deviation, Engine, Help, Preset, Stepping
from engines.pymunk.build import LIBRARY_STEP_S, PymunkWorld, script
from engines.pymunk.settings import (
    DOCUMENTED,
    FACTORS,
    LANDING,
    RECOMMENDED,
    RULES,
    TUNED,
    PymunkSettings,
)
from engines.scene import Ability

NAIVE = Preset(
    name="naive",
    settings=PymunkSettings(),
    step_s=LIBRARY_STEP_S,
    documented=DOCUMENTED,
    frame="world",
    deviations=(Deviation.MIRROR,),
    own={"friction": 0.0},
)

ENGINE = Engine(
    name="pymunk",
    title="pymunk",
    library="pymunk",
    packages=("pymunk",),
    install="rocking[pymunk]",
    build=PymunkWorld,
    abilities=(Ability.SEVERAL, Ability.STACKED),
    presets=(
        NAIVE,
        NAIVE.at_rest(Deviation.MIRROR, Deviation.PEAK, Deviation.RECORD),
        NAIVE.recommended(
            *RECOMMENDED, deviations=(Deviation.MIRROR,), step_s=LIBRARY_STEP_S / 10.0, slop=1e-3
        ),
        Preset(
            name="fixed",
            settings=TUNED,
            step=2.5e-4,
            helped_by={Help.MARGIN: {"margin": None}},
        ),
        Preset(
            name="landing",
            settings=LANDING,
            stepping=Stepping.LANDING,
            stacked={"sweeps": 400.0},  # the heavier what rests on others, the slower they converge
            helped_by={
                Help.STEPS: None,
                Help.POSITIONS: {"positions": False},
                Help.REFLECTION: {"reflection": False},
                Help.MARGIN: {"margin": None},
            },
        ),
    ),
    geometries=("box", "corners"),
    script=script,
    factors=FACTORS,
    rules=RULES,
)
