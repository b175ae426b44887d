"""Newton: what it can do, how it is used, what its users should know first."""

from engines.declaration import Engine, Precision, Preset
from engines.newton.build import NewtonWorld, script
from engines.newton.settings import DOCUMENTED, FACTORS, RECOMMENDED, RULES, TUNED, NewtonSettings
from engines.newton.stacks import NewtonStacks
from engines.scene import Scene
from engines.world import World


def world_of(scene: Scene, settings: NewtonSettings, dt_s: float) -> World:
    """Build a scene; one of several bodies is built, and stepped, otherwise."""
    return (NewtonStacks if scene.stacked else NewtonWorld)(scene, settings, dt_s)


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
    build=world_of,
    stacks=True,
    presets=(
        NAIVE,
        NAIVE.at_rest(),
        NAIVE.recommended(*RECOMMENDED, step_s=1.0 / 600.0, iterations=20),
        Preset(name="fixed", settings=TUNED, step=1e-3),
    ),
    precision=Precision.SINGLE,
    shortest_step=3e-6,
    script=script,
    factors=FACTORS,
    rules=RULES,
    compiles=True,
)
