"""What MJX can be set to: MuJoCo's settings, but for what it refuses or does not heed."""

from dataclasses import dataclass, fields

from engines.mujoco.port import refuse_step_by_step
from engines.mujoco.settings import TUNED as MUJOCO_TUNED
from engines.mujoco.settings import MujocoSettings
from engines.parts.factors import AS_BEST, BEST, DEFAULT, Rule, factor, level
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


TUNED = MjxSettings(
    **{item.name: getattr(MUJOCO_TUNED, item.name) for item in fields(MUJOCO_TUNED)}
    | {"cone": "pyramidal", "friction": 1.0, "impratio": 1.0, "floor": "weld"}
    | {"precision": "double"}
)

LOST = "its elliptic cone's Hessian is not positive at a small slip: no numbers, without a word"

FACTORS = (
    factor(
        "cone",
        level("ellipse", trap=LOST, cone="elliptic", friction=10.0, impratio=100.0),
        by_default=False,
    ),
    factor("precision"),
    factor("geometry", by_default=False),
)
"""What its contact can be set to."""

RULES = (
    Rule(
        'Keep a stiff contact to `cone="pyramidal"`: an elliptic one leaves no numbers',
        *(BEST, "cone", "ellipse"),
    ),
    Rule(
        "Let corners touch a base that is moved: of two boxes a contact is counted thrice",
        *(DEFAULT, "geometry", AS_BEST),
        kept=True,
    ),
)
"""What its users should know first."""
