"""Rapier: what it can do, how it is used, what its users should know first."""

from engines.declaration import Deviation, Engine, Help, Precision, Preset, Stepping
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
from engines.scene import Ability

NAIVE = Preset(
    name="naive",
    settings=RapierSettings(),
    step_s=1.0 / 60.0,
    documented=DOCUMENTED,
    frame="world",
    deviations=(Deviation.MIRROR, Deviation.PEAK),
    own={"friction": 0.5},
)

ENGINE = Engine(
    name="rapier",
    title="Rapier",
    library="rapier3d",
    packages=("rapier3d",),
    install="rocking[rapier]",
    build=RapierWorld,
    abilities=(Ability.SEVERAL, Ability.STACKED),
    presets=(
        NAIVE,
        NAIVE.at_rest(Deviation.MIRROR, Deviation.RECORD, Deviation.SLEEP),
        NAIVE.recommended(
            *RECOMMENDED,
            deviations=(Deviation.MIRROR,),
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
    geometries=("box", "corners"),
    spatial=True,
    precision=Precision.SINGLE,
    nuisance_sensitivity=6e-3,
    shortest_step=3e-6,
    script=script,
    factors=FACTORS,
    rules=RULES,
    remedy={"iterations": 1000},
    own_step="rapier3d:PhysicsWorld.step",
)
