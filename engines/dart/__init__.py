"""DART: what it can do, how it is used, what its users should know first."""

from engines.dart.build import DartWorld, script
from engines.dart.settings import (
    DOCUMENTED,
    FACTORS,
    LANDING,
    RECOMMENDED,
    RULES,
    TUNED,
    DartSettings,
)
from engines.dart.stacks import DartStacks
from engines.declaration import Engine, Help, Preset, Stepping

NAIVE = Preset(
    name="naive",
    settings=DartSettings(),
    step_s=1e-3,
    documented=DOCUMENTED,
    frame="world",
)

ENGINE = Engine(
    name="dart",
    title="DART",
    library="dartpy",
    packages=("dartpy",),
    install="rocking[dart]",
    build=DartWorld,
    stacks=True,
    presets=(
        NAIVE,
        NAIVE.at_rest(),
        NAIVE.recommended(*RECOMMENDED, sleeping=False),
        Preset(
            name="fixed",
            settings=TUNED,
            step=5e-4,
        ),
        Preset(
            name="landing",
            settings=LANDING,
            stepping=Stepping.LANDING,
            stacked={"margin": 30.0, "unit": 1e7},
            stacks=DartStacks,
            helped_by={
                Help.STEPS: None,
                Help.REFLECTION: {"reflection": False},
                Help.MARGIN: {"margin": None},
            },
        ),
    ),
    rest_factor=1.0,
    script=script,
    factors=FACTORS,
    rules=RULES,
)
