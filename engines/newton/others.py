"""Newton's other solvers that hold a block: each a use of its own, and a variant of `newton`.

The model, and its step that is recorded, are those of `engines.newton.models`; where that makes
Kamino of it, another solver is made here, and the contact's own stiffness is set.
"""

import warnings
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from engines.declaration import Engine, Preset
from engines.newton import ENGINE
from engines.newton.build import NewtonWorld
from engines.newton.models import Recorded, given_back, idle, made_of
from engines.newton.settings import NewtonSettings
from engines.parts.quiet import imported, silence
from engines.parts.settings import given, setting
from engines.parts.shapes import NO_JAM
from engines.scene import Scene

CLASSES = {
    "featherstone": "SolverFeatherstone",
    "mujoco": "SolverMuJoCo",
    "semi-implicit": "SolverSemiImplicit",
    "steel": "SolverSteel",
}
"""Name of a solver -> that of its class."""

PENALTY: dict[str, Any] = {"angular_damping": 0.0}
"""Arguments of solvers whose contact is a spring: of its own each damps all rotations."""

ARGUMENTS: dict[str, dict[str, Any]] = {
    "featherstone": PENALTY,
    "mujoco": {"cone": "elliptic", "impratio": 100.0, "tolerance": 1e-6},
    "semi-implicit": PENALTY,
    "steel": {"baumgarte": 0.0, "friction_anchor_beta": 0.0, "enable_restitution": False},
}
"""Name of a solver -> arguments that are not its own defaults, beside the iterations."""

RAW = 1
"""MuJoCo's reference as it is, among the ways in which Newton's attribute is read."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OtherSettings(NewtonSettings):
    """Settings of Newton with another solver; None leaves its own.

    Attributes
    ----------
    solver : str
        One of `CLASSES`.
    stiffness, damping, sliding : float or None
        k dt^2, c dt and the slope of friction times dt, over the mass, of a contact that is a
        spring; of "mujoco" k dt^2 and b dt of its reference.
    impedance : float or None
        Of "mujoco", at every depth.
    """

    solver: str = setting("mujoco", names=tuple(CLASSES))
    stiffness: float | None = setting(above=0.0)
    damping: float | None = setting(above=0.0)
    sliding: float | None = setting(above=0.0)
    impedance: float | None = setting(above=0.0, most=1.0)


class OtherWorld(NewtonWorld):
    """A block in space, as another solver holds it."""

    def __init__(self, scene: Scene, settings: OtherSettings, dt_s: float) -> None:
        if made_of(scene, settings, dt_s) not in idle:
            newton, warp = imported("newton"), imported("warp")
            library = with_solver(newton, settings, scene.bodies[0].mass, dt_s)
            with silence(), warnings.catch_warnings():
                warnings.simplefilter("ignore")  # it asks for MuJoCo 3.17, and this is 4.0
                given_back(Recorded(library, warp, scene, settings, dt_s))
        NewtonWorld.__init__(self, scene, settings, dt_s)

    def _put(self, scene: Scene) -> None:
        NewtonWorld._put(self, scene)  # most of these solvers begin from the joints
        self._recorded.joint_q[:7] = self._place[0]
        self._recorded.joint_qd[:6] = self._velocity[0]


def with_solver(newton: Any, s: OtherSettings, mass: float, dt_s: float) -> Any:
    """Return the library with another solver in Kamino's place."""

    class Solver:
        Config = SimpleNamespace(from_model=lambda model, dynamics_solver: None)

        @staticmethod
        def register_custom_attributes(builder: Any) -> None:
            if s.solver == "mujoco":
                newton.solvers.SolverMuJoCo.register_custom_attributes(builder)
                return
            parts = {"ke": (s.stiffness, dt_s**2), "kd": (s.damping, dt_s), "kf": (s.sliding, dt_s)}
            for name, (part, unit) in parts.items():
                if part is not None:
                    setattr(builder.default_shape_cfg, name, part * mass / unit)

        def __new__(cls, model: Any, config: Any) -> Any:
            if s.solver == "mujoco" and s.impedance is not None:
                _set_reference(model.mujoco, s, dt_s)
            asked = {**ARGUMENTS[s.solver], **given({"iterations": s.iterations})}
            return getattr(newton.solvers, CLASSES[s.solver])(model, **asked)

    solvers = SimpleNamespace(SolverKamino=Solver)
    return SimpleNamespace(**{**vars(newton), "solvers": solvers})


def _set_reference(attributes: Any, s: Any, dt_s: float) -> None:
    """Set MuJoCo's contact by the two numbers of a direct reference, as MuJoCo divides them."""
    unit = s.impedance / dt_s
    for name, row in {
        "solref": (-s.stiffness * unit**2, -s.damping * unit),
        "solref_mode": RAW,
        "geom_solimp": (s.impedance, s.impedance, 1e-3, 0.5, 2.0),
    }.items():
        array = getattr(attributes, name)
        array.assign(np.full(array.numpy().shape, row))


def _with(solver: str, **settings: Any) -> Engine:
    """Return the declaration of Newton with another solver, used as well as is known here."""
    chosen = OtherSettings(solver=solver, **settings)
    return replace(
        ENGINE,
        name=f"newton-{solver}",
        title=f"Newton, {CLASSES[solver]}",
        build=OtherWorld,
        builders={},
        presets=(Preset(name="fixed", settings=chosen, step=1e-3),),
        script=None,
        factors=(),
        rules=(),
    )


SPRING: dict[str, Any] = {"geometry": "corners", "friction": NO_JAM, "stiffness": 0.01}

FEATHERSTONE = _with("featherstone", **SPRING, damping=0.1, sliding=0.1)
SEMI_IMPLICIT = _with("semi-implicit", **SPRING, damping=0.1, sliding=0.1)
STEEL = _with("steel", geometry="corners", friction=NO_JAM, iterations=50)
MUJOCO = replace(
    _with("mujoco", **SPRING | {"friction": 10.0}, damping=1.0, impedance=0.9999, iterations=100),
    packages=(*ENGINE.packages, "mujoco-warp", "mujoco"),
    install="rocking[newton,warp]",
)
