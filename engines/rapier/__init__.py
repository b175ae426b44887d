"""Rapier: what it can do, how it is used, what its users should know first."""

from engines.declaration import Engine, Help, Precision, Preset, Stepping
from engines.rapier.build import RapierWorld, script
from engines.rapier.settings import (
    DOCUMENTED,
    FACTORS,
    LANDING,
    RECOMMENDED,
    RULES,
    TUNED,
    RapierSettings,
)

NAIVE = Preset(
    name="naive",
    settings=RapierSettings(),
    step_s=1.0 / 60.0,
    documented=DOCUMENTED,
    frame="world",
    own={"friction": 0.5},
)

ENGINE = Engine(
    name="rapier",
    title="Rapier",
    library="rapier3d",
    packages=("rapier3d",),
    install="rocking[rapier]",
    build=RapierWorld,
    stacks=True,
    presets=(
        NAIVE,
        NAIVE.at_rest(),
        NAIVE.recommended(
            *RECOMMENDED,
            step_s=1.0 / 120.0,
            substeps=8,
            coulomb=True,
        ),
        Preset(name="fixed", settings=TUNED, step=5e-4),
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
