"""Newton: what it can do, how it is used, what its users should know first."""

from engines.declaration import Engine, Precision, Preset
from engines.newton.build import NewtonWorld, script
from engines.newton.settings import DOCUMENTED, FACTORS, RULES, TUNED, NewtonSettings

NAIVE = Preset(
    name="naive",
    settings=NewtonSettings(),
    step_s=1e-3,
    documented=DOCUMENTED,
    frame="world",
)

ENGINE = Engine(
    name="newton",
    title="Newton",
    library="newton",
    packages=("newton", "warp-lang"),
    install="rocking[newton]",
    build=NewtonWorld,
    presets=(
        NAIVE,
        NAIVE.at_rest(),
        Preset(name="fixed", settings=TUNED, step=1e-3),
    ),
    geometries=("box", "corners"),
    precision=Precision.SINGLE,
    shortest_step=3e-6,
    script=script,
    factors=FACTORS,
    rules=RULES,
    compiles=True,
)
