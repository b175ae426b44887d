"""MuJoCo Warp: what it can do, how it is used, what its users should know first."""

from functools import partial

from engines.declaration import BatchEngine, Precision, Preset
from engines.layouts import Ability
from engines.run.batch import alone
from engines.warp.build import WarpWorlds
from engines.warp.settings import DOCUMENTED, FACTORS, RULES, TUNED, WarpSettings

NAIVE = Preset(
    name="naive",
    settings=WarpSettings(),
    step_s=0.002,
    documented=DOCUMENTED,
    frame="world",
    contact_s=0.02,
)

ENGINE = BatchEngine(
    name="warp",
    title="MuJoCo Warp",
    library="mujoco_warp",
    packages=("mujoco-warp", "warp-lang", "mujoco"),
    install="rocking[warp]",
    build=partial(alone, WarpWorlds),
    batch=WarpWorlds,
    abilities=(Ability.SEVERAL,),
    presets=(
        NAIVE,
        NAIVE.at_rest(),
        Preset(name="fixed", settings=TUNED, step=2.5e-4),
    ),
    geometries=("box", "corners"),
    spatial=True,
    precision=Precision.SINGLE,
    # sizes and shaking changed by a rounding, 6e-8, in 8 histories: the peaks moved by up to 2.0e-3
    # (frame "base") and 2.2e-3 ("world"), and by 4e-4 where the impact stayed in its step; in the
    # next step it makes a peak 2.0e-3 larger in double precision, too, where a change of 1e-5 does
    nuisance_sensitivity=2.2e-3,
    shortest_step=3e-6,
    factors=FACTORS,
    rules=RULES,
    compiles=True,
)
