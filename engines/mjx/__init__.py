"""MJX: what it can do, how it is used, what its users should know first."""

from functools import partial

from engines.declaration import BatchEngine, Precision, Preset
from engines.disclosure import Citation
from engines.layouts import Ability
from engines.mjx.build import MjxWorlds
from engines.mjx.settings import FACTORS, RULES, TUNED, MjxSettings
from engines.run.batch import alone

NAIVE = Preset(
    name="naive",
    settings=MjxSettings(),
    step_s=0.002,
    documented=(Citation("step", "timestep 0.002", "XMLreference.rst of MuJoCo 4.0.0, option"),),
    frame="world",
    contact_s=0.02,
)

ENGINE = BatchEngine(
    name="mjx",
    title="MJX",
    library="mujoco.mjx",
    packages=("mujoco-mjx", "jax", "jaxlib", "mujoco"),
    install="rocking[mjx]",
    build=partial(alone, MjxWorlds),
    batch=MjxWorlds,
    abilities=(Ability.SEVERAL,),
    presets=(NAIVE, NAIVE.at_rest(), Preset(name="fixed", settings=TUNED, step=2.5e-4)),
    geometries=("box", "corners"),
    spatial=True,
    precision=Precision.SINGLE,
    # its only floor with a velocity is a weld, which lags: tuned, it errs there as MuJoCo's own
    unmoved=("fixed",),
    shortest_step=3e-6,
    factors=FACTORS,
    rules=RULES,
    compiles=True,
)
