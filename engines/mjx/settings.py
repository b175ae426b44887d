"""What MJX can be set to: MuJoCo's settings, but for what it refuses or does not heed."""

from dataclasses import dataclass, fields

from engines.declaration import Source
from engines.mujoco.port import refuse_step_by_step
from engines.mujoco.settings import TUNED as MUJOCO_TUNED
from engines.mujoco.settings import MujocoSettings
from engines.parts.factors import Factor, Rule, factor, level, moving_base
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
    | {"floor": "weld", "precision": "double", "impratio": 100.0}
)

LOST = "single precision: what friction yields is less than a rounding of the slip to be taken out"

FACTORS = (
    Factor(
        "precision",
        ("precision",),
        (level("single, impratio 10", precision="single", impratio=10.0),),
        traps={"fixed": LOST},
    ),
    factor("impratio", level("1", impratio=1.0), level("1e4", impratio=1e4)),
    moving_base("weld", "position"),
)
"""What its contact can be set to."""

RULES = (
    Rule(
        "Set `jax_enable_x64`: in single precision friction at `impratio` 100 is rounded away",
        *("fixed", "precision", "default"),
    ),
)
"""What its users should know first."""
