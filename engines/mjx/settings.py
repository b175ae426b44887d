"""What MJX can be set to: MuJoCo's settings, but for what it refuses or does not heed."""

from dataclasses import dataclass, fields, replace

from engines.declaration import Source
from engines.mujoco.port import refuse_step_by_step
from engines.mujoco.settings import TUNED as MUJOCO_TUNED
from engines.mujoco.settings import MujocoSettings
from engines.parts.factors import (
    BY_POSITION,
    DEFAULT,
    MOVING_BASE,
    Factor,
    Rule,
    factor,
    level,
    moving_base,
)
from engines.parts.settings import setting


@dataclass(frozen=True, slots=True, kw_only=True)
class MjxSettings(MujocoSettings):
    """Settings of MJX, by default its own; see `engines.mujoco.settings`.

    Attributes
    ----------
    precision : str
        "single", as JAX computes by itself, or "double", its ``jax_enable_x64``.
    """

    precision: str = setting("single", names=("single", "double"))
    solver: str | None = setting(names=("CG", "Newton"))
    integrator: str | None = setting(names=("Euler", "RK4", "implicitfast"))
    noslip_iterations: int | None = setting(least=0, most=0)
    floor: str = setting("weld", names=("weld", "position"))

    def __post_init__(self) -> None:
        MujocoSettings.__post_init__(self)
        refuse_step_by_step(self)


DOCUMENTED = (
    Source("step", "timestep 0.002, MuJoCo's model", "XMLreference.rst of MuJoCo 4.0.0, option"),
)
"""What the preset "naive" is documented by: MuJoCo's defaults."""

TUNED = MjxSettings(
    **{item.name: getattr(MUJOCO_TUNED, item.name) for item in fields(MUJOCO_TUNED)}
    | {"floor": "weld", "precision": "double", "impratio": 1.0}
)

LOST = "what was found at impratio 100 in single precision: peaks off by a quarter, without a word"
LOST_SLIP = "its cone's Hessian is no longer positive for a slip below 1e-5 m/s2: no numbers"

FACTORS = (
    Factor(
        "precision",
        ("precision", "impratio"),
        (level("single, impratio 100", trap=LOST, precision="single", impratio=100.0),),
    ),
    factor("impratio", level("100", trap=LOST_SLIP, impratio=100.0)),
    Factor(
        MOVING_BASE,
        ("floor",),
        # the best contact holds no base that moves
        tuple(replace(it, presets=(DEFAULT,)) for it in moving_base("position").levels),
        by_default=False,
    ),
)
"""What its contact can be set to."""

RULES = (
    Rule("Keep `impratio` at 1: above, places become no numbers", *("fixed", "impratio", "100")),
    Rule(
        "Give a base that is moved a body of its own, welded: friction does not feel a mocap move",
        *(DEFAULT, MOVING_BASE, BY_POSITION),
    ),
)
"""What its users should know first."""
