"""Box2D: what it can do, how it is used, what its users should know first."""

from engines.box2d.build import LIBRARY_STEP_S, MANUAL, Box2DWorld, script
from engines.box2d.settings import FACTORS, LANDING, RULES, TUNED, Box2DSettings
from engines.declaration import Engine, Help, Miss, Precision, Preset, Source, Stepping
from engines.layouts import Ability

ENGINE = Engine(
    name="box2d",
    title="Box2D",
    library="Box2D",
    packages=("Box2D",),
    install="rocking[box2d]",
    build=Box2DWorld,
    abilities=tuple(Ability),
    presets=(
        Preset(
            name="naive",
            settings=Box2DSettings(sleeping=False),
            step_s=LIBRARY_STEP_S,
            documented=(Source("step", "?", MANUAL),),
            misses=(Miss.MIRROR, Miss.PEAK),
            own={"friction": 0.2, "sleeping": True},
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
            stacked=None,
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
