"""PhysX: what it can do, how it is used, what its users should know first."""

from engines.declaration import Engine, Help, Precision, Preset, Source, Stepping
from engines.layouts import Ability
from engines.physx.build import PhysxWorld, script
from engines.physx.settings import TUNED, PhysxSettings

NAIVE = Preset(
    name="naive",
    settings=PhysxSettings(),
    step_s=0.01,
    frame="world",
)

ENGINE = Engine(
    name="physx",
    title="PhysX",
    library="sapien",
    packages=("sapien",),
    install="rocking[physx]",
    build=PhysxWorld,
    abilities=tuple(Ability),
    presets=(
        NAIVE,
        NAIVE.at_rest(),
        Preset(name="fixed", settings=TUNED, step=1e-3),
        Preset(name="landing", settings=TUNED, stepping=Stepping.LANDING, helped_by={Help.STEPS: None}),
    ),
    geometries=("box", "corners"),
    spatial=True,
    precision=Precision.SINGLE,
    shortest_step=3e-6,
    script=script,
)
