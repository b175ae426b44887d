"""What MuJoCo Warp can be set to: MuJoCo's settings, but for what it refuses."""

from dataclasses import dataclass, fields

from engines.disclosure import Citation
from engines.mujoco.port import refuse_step_by_step
from engines.mujoco.settings import TUNED as MUJOCO_TUNED
from engines.mujoco.settings import MujocoSettings
from engines.parts.factors import BOTH, UNMOVED_BASE, Factor, Rule, factor, level, moving_base
from engines.parts.settings import setting

LEAST_TOLERANCE = 1e-6
"""The library raises any smaller tolerance to this, without a word."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WarpSettings(MujocoSettings):
    """Settings of MuJoCo Warp, by default its own; see `engines.mujoco.settings`."""

    solver: str | None = setting(names=("CG", "Newton"))
    integrator: str | None = setting(names=("Euler", "RK4", "implicitfast"))
    tolerance: float | None = setting(least=LEAST_TOLERANCE)

    def __post_init__(self) -> None:
        MujocoSettings.__post_init__(self)
        refuse_step_by_step(self)


IO = "mujoco_warp/_src/io.py, mujoco-warp 4.0.0"
DOCUMENTED = (
    Citation("step", "timestep 0.002, MuJoCo's model", "XMLreference.rst of MuJoCo 4.0.0, option"),
    Citation("solver", "Newton; tolerance 1e-8 is raised to 1e-6", IO),
)
"""What the preset "naive" is documented by: MuJoCo's defaults, and what is made of them."""

TUNED = WarpSettings(
    **{item.name: getattr(MUJOCO_TUNED, item.name) for item in fields(MUJOCO_TUNED)}
    | {"impratio": 100.0, "tolerance": LEAST_TOLERANCE}
)

NOT_A_NUMBER = "single precision: places that are no numbers, without a word"

FACTORS = (
    factor("solver", level("CG", BOTH, solver="CG"), by_default=False),
    factor(
        "impratio",
        level("1", impratio=1.0),
        level("300", impratio=300.0),
        level("1e4", trap=NOT_A_NUMBER, impratio=1e4),
    ),
    factor("integrator", level("RK4", BOTH, integrator="RK4")),
    Factor("geometry", ("geometry", "planar"), (level("planar box", geometry="box"),)),
    moving_base("surfacevel", "weld", "position"),
)
"""What its contact can be set to."""

RULES = (
    Rule(
        "Keep `impratio` to 100: in single precision 1e4 leaves no numbers, and no warning",
        *("fixed", "impratio", "1e4"),
    ),
    Rule(
        "Give a base that is moved its velocity, `surfacevel`: friction does not feel a mocap move",
        *UNMOVED_BASE,
    ),
)
"""What its users should know first."""
