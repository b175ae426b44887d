"""Drake: what it can do, how it is used, what its users should know first."""

from engines.declaration import Deviation, Engine, Preset, Stepping
from engines.drake.build import DrakeWorld
from engines.drake.script import script
from engines.drake.settings import (
    CONTROLLED,
    DOCUMENTED,
    FACTORS,
    RECOMMENDED,
    RULES,
    TUNED,
    DrakeSettings,
)
from engines.scene import Ability

NAIVE = Preset(
    name="naive",
    settings=DrakeSettings(),
    step_s=1e-3,
    documented=DOCUMENTED,
    frame="world",
    own={"friction": 0.5},
)

ENGINE = Engine(
    name="drake",
    title="Drake",
    library="pydrake",
    packages=("drake",),
    install="rocking[drake]",
    build=DrakeWorld,
    abilities=(Ability.SEVERAL, Ability.STACKED),
    presets=(
        NAIVE,
        NAIVE.at_rest(Deviation.PEAK),
        NAIVE.recommended(*RECOMMENDED, solver="similar", geometry="corners", stiffness=0.0133),
        Preset(name="fixed", settings=TUNED, step=3e-4),
        Preset(
            name="error-controlled",
            title="steps of its own, by its own estimate of the error",
            settings=CONTROLLED,
            stepping=Stepping.OWN,
            accuracy_knob=("accuracy", (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 2e-9)),
        ),
    ),
    geometries=("box", "corners"),
    spatial=True,
    nuisance_sensitivity=2e-4,
    script=script,
    factors=FACTORS,
    rules=RULES,
    own_step="pydrake.systems.analysis:Simulator.AdvanceTo",
)
