"""Newton: what it can do, how it is used, what its users should know first."""

from engines.declaration import Engine, Precision, Preset, Source
from engines.newton.build import NewtonWorld, script
from engines.newton.settings import FACTORS, RULES, TUNED, NewtonSettings

ENGINE = Engine(
    name="newton",
    title="Newton",
    library="newton",
    packages=("newton", "warp-lang"),
    install="rocking[newton]",
    build=NewtonWorld,
    presets=(
        Preset(
            name="naive",
            title="the library's example",
            settings=NewtonSettings(),
            step_s=2e-3,
            documented=(
                Source(
                    "step", "?", "the library's own example basic_shapes, 5 substeps of 1/100 s"
                ),
            ),
        ),
        Preset(name="fixed", settings=TUNED, step=1e-3),
    ),
    frames=("base",),
    geometries=("box", "corners"),
    precision=Precision.SINGLE,
    shortest_step=3e-6,
    script=script,
    factors=FACTORS,
    rules=RULES,
    compiles=True,
)
