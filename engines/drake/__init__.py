"""Drake: what it can do, how it is used, what its users should know first."""

from engines.declaration import Engine, Preset, Stepping
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
    stacks=True,
    presets=(
        NAIVE,
        NAIVE.at_rest(),
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
    script=script,
    factors=FACTORS,
    rules=RULES,
)
