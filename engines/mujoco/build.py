"""MuJoCo: how a scene is built, set, read back and stepped."""

from functools import partial
from importlib import import_module
from typing import Any

from engines.mujoco.contact import notice, prepare, read
from engines.mujoco.contact_state import ContactState, Forces, arrays_of, begin_contact
from engines.mujoco.model import OPTIONS, coordinates, impedance_of, model_xml
from engines.mujoco.settings import MujocoSettings, kept
from engines.parts.compiled import interpreted, switched_off
from engines.scene import Scene
from engines.settings import disagreement
from engines.world import Driver, FloatArray, Moment, Step

LIBRARY_STEP_S = 0.002
"""The library's own time step [s]."""

KINDS = {"cone": "mjCONE_", "solver": "mjSOL_", "jacobian": "mjJAC_", "integrator": "mjINT_"}
"""Options that the library numbers, by the names that it gives their values."""


class MujocoWorld:
    """A block on a plane, or on a box where the base moves.

    A driven body has no velocity that friction could feel, so the box is given the surface
    velocity that its motion has, or is another body, welded to the driven one.
    """

    def __init__(self, scene: Scene, settings: MujocoSettings, dt_s: float) -> None:
        self._s = s = settings
        self._mj = import_module("mujoco")
        self.moment = Moment.END if s.integrator == "RK4" else Moment.MIDDLE
        self._model = self._mj.MjModel.from_xml_string(model_xml(scene, s, dt_s))
        self._data = self._mj.MjData(self._model)
        self._option = self._model.opt
        self._fault = self._read_back(scene, dt_s)
        if not all(body.at.at_rest for body in scene.bodies):
            self._data.qpos[:], self._data.qvel[:] = coordinates(scene, s)
        loops = scene.compiled and looping()
        holds = ContactState.blank() if loops else [ContactState.plain()]
        self._held = holds[0]
        begin_contact(self._held, scene, s, dt_s, self._model.npair)
        self._arrays = arrays_of(self._model, self._data, self._held, scene)
        self.drive: Driver | None = None
        if loops:
            from engines.mujoco.loop import drive, memory_of

            self.drive = partial(drive, holds, self._arrays, memory_of(self._model, self._data))
        # the library would write its warnings to a file; they are counted and read from `fault`
        self._mj.set_mju_user_warning(_ignore)

    def step(self, step: Step) -> None:
        """Advance by a step; see `engines.world.SteppedWorld`."""
        data, held, arrays = self._data, self._held, self._arrays
        prepare(held, arrays, step)
        self._option.timestep = step.dt_s
        self._mj.mj_step(self._model, data)
        notice(held, arrays, Forces(data.ncon, data.nefc, data.efc_R, data.efc_force), step)

    @property
    def base_x_m(self) -> float:
        """Where a base that moves is; see `engines.world.World`."""
        return float(self._held.moved)

    @property
    def lag_m(self) -> float | None:
        """How far a welded base was from where it should have been; see `engines.world.World`."""
        return float(self._held.lag) if self._held.welded else None

    def state(self) -> FloatArray:
        """Read the bodies' poses back."""
        read(self._held, self._arrays)
        return self._arrays.state

    def fault(self) -> str:
        """Say which setting was not taken, or what the engine warned of."""
        if self._fault:
            return self._fault
        # all at once: to ask each kind by itself takes as long as fifty steps
        warned = self._data.warning.number.nonzero()[0]
        if warned.size:
            kind = list(self._mj.mjtWarning.__members__)[warned[0]]
            return f"MuJoCo warned: {kind.removeprefix('mjWARN_')}"
        return disagreement({"time": (self._held.time, self._data.time)})

    def close(self) -> None:
        """Give warnings back to the library."""
        self._mj.set_mju_user_warning(None)

    def _read_back(self, scene: Scene, dt_s: float) -> str:
        s, model = self._s, self._model
        pairs: dict[str, tuple[Any, Any]] = {
            "timestep": (LIBRARY_STEP_S, self._option.timestep),
            "friction": (s.friction, model.geom_friction[-1, 0]),
        }
        for number, body in enumerate(scene.bodies, 1 + (scene.frame == "world")):
            pairs[f"mass {number}"] = (body.mass, model.body_mass[number])
            found = model.body_inertia[number]
            pairs |= {f"inertia {number} {i}": (body.inertia[i], found[i]) for i in range(3)}
        pairs |= {name: self._read_option(name) for name in OPTIONS}
        pairs["diagexact"] = (s.diagexact, self._exact)
        impedance = impedance_of(scene, s, dt_s)
        if impedance is not None:
            pairs |= {
                f"impedance {i}": (value, model.pair_solimp[0, i])
                for i, value in enumerate(impedance)
            }
            pairs["friction of the pair"] = (s.friction, model.pair_friction[0, 0])
        return disagreement(pairs)

    @property
    def _exact(self) -> bool:
        bit = getattr(self._mj.mjtEnableBit, "mjENBL_DIAGEXACT", 0)  # earlier releases have none
        return bool(self._option.enableflags & int(bit))

    def _read_option(self, name: str) -> tuple[Any, Any]:
        """Return a wanted option as the library numbers it, and the option as it is."""
        wanted, found = getattr(self._s, name), getattr(self._option, name)
        if wanted is None or name not in KINDS:
            return wanted, found
        kind = getattr(self._mj, f"mjt{name.capitalize()}")
        return int(kind.__members__[KINDS[name] + wanted.upper()]), int(found)


def world_of(scene: Scene, settings: MujocoSettings, dt_s: float) -> MujocoWorld:
    """Build a scene; a preset's impratio is kept to what the friction allows.

    Parameters
    ----------
    scene : Scene
    settings : MujocoSettings
    dt_s : float, ordinary step [s], from which depths of the contact follow
    """
    return MujocoWorld(scene, kept(scene, settings), dt_s)


def looping() -> bool:
    """Return whether a compiled loop can take the steps, and compiled code is used at all."""
    if interpreted() or switched_off():
        return False
    from engines.mujoco.loop import usable

    return usable()


def _ignore(message: str) -> None:
    """Take a warning without writing it anywhere."""
