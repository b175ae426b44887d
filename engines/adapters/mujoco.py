"""MuJoCo: how a scene is built, set, read back and stepped."""

import math
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from engines.adapters.mujoco_drop import BOUNCING
from engines.adapters.mujoco_model import OPTIONS, coordinates, direct_reference, model_xml
from engines.adapters.mujoco_script import script
from engines.adapters.mujoco_settings import (
    DEFAULT_CONTACT_S,
    FACTORS,
    LANDING,
    RULES,
    TUNED,
    MujocoSettings,
    kept,
    spring,
)
from engines.declaration import Engine, Help, Preset, Stepping
from engines.parts.readback import disagreement
from engines.parts.reflection import Reflection
from engines.scene import GEOMETRIES, Scene
from engines.world import Grip, Moment, Pose, Step

LIBRARY_STEP_S = 0.002
"""The library's own time step [s]."""

FEEBLE = 1e-15
"""k dt^2 where positions are to be left alone; the library takes a zero for something else."""

LEAST_HELD = 1e-3
"""Part of what the whole weight would press a corner by, up to which landing holds one at rest."""

KINDS = {"cone": "mjCONE_", "solver": "mjSOL_", "jacobian": "mjJAC_", "integrator": "mjINT_"}
"""Options that the library numbers, by the names that it gives their values."""


class MujocoWorld:
    """A block on a plane, or on a driven box where the base moves.

    A driven body has no velocity that friction could feel, so the box is given the surface
    velocity that its motion has.
    """

    def __init__(self, scene: Scene, settings: MujocoSettings, dt_s: float) -> None:
        self._s = s = settings
        self._mj = import_module("mujoco")
        self.moment = Moment.END if s.integrator == "RK4" else Moment.MIDDLE
        self._moving = scene.frame == "world"
        self._ordinary, self._height = dt_s, 0.5 * scene.block.height
        self._model = self._mj.MjModel.from_xml_string(model_xml(scene, s))
        self._data = self._mj.MjData(self._model)
        self._pull, self._option = self._model.opt.gravity, self._model.opt
        self._velocity = self._moved = self._dt = self._time = 0.0
        self._reflection = Reflection(scene, dt_s)
        self._spin = 2 if s.planar else 4
        self._sliding = 1.0 if s.sliding_damping is None else s.sliding_damping
        self._by_step = s.by_phase or s.reflection or s.carry is not None
        self._set_reach(scene)
        self._fault = self._read_back(scene)
        if not scene.beginning.at_rest:
            self._put(scene)
        # the library would write its warnings to a file; they are counted and read from `fault`
        self._mj.set_mju_user_warning(_ignore)

    def step(self, step: Step) -> None:
        """Advance by a step; see `engines.world.SteppedWorld`."""
        self._hold(step)
        self._pull[0], self._pull[2] = step.pull_x, step.pull_z
        if self._moving:
            self._move_base(step)
        self._mj.mj_step(self._model, self._data)
        self._moved = step.base_x if self._moving else 0.0
        self._time += step.dt_s
        if self._s.carry is not None:
            self._look_at_yield(step)
        if self._s.reflection:
            self._reflection.see(step, float(self._data.qvel[self._spin]))

    def pose(self) -> Pose:
        """Read the block's pose back."""
        q, v = self._data.qpos.tolist(), self._data.qvel.tolist()
        if self._s.planar:
            return Pose(q[0] - self._moved, q[1] + self._height, q[2], v[2])
        return Pose(q[0] - self._moved, q[2], 2.0 * math.atan2(q[5], q[3]), v[4])

    def fault(self) -> str:
        """Say which setting was not taken, or what the engine warned of."""
        if self._fault:
            return self._fault
        for kind, warning in zip(self._mj.mjtWarning.__members__, self._data.warning, strict=False):
            if warning.number:
                return f"MuJoCo warned: {kind.removeprefix('mjWARN_')}"
        return disagreement({"time": (self._time, self._data.time)})

    def close(self) -> None:
        """Give warnings back to the library."""
        self._mj.set_mju_user_warning(None)

    def _put(self, scene: Scene) -> None:
        """Let the block set out from where the scene begins."""
        self._data.qpos[:], self._data.qvel[:] = coordinates(scene, self._s)

    def _hold(self, step: Step) -> None:
        """Set the step, and the contact in units of it."""
        s, model, dt = self._s, self._model, step.dt_s
        if dt == self._dt and not self._by_step:
            return
        self._dt = dt
        self._option.timestep = dt
        if s.solref is not None:
            model.pair_solref[:] = model.geom_solref[:] = (s.solref[0] * dt, s.solref[1])
        if s.damping is None or s.sliding_damping is None or s.stiffness is None:
            return
        back = self._reflection.part(step) if s.reflection else 0.0
        firm = FEEBLE if s.by_phase and (step.side or step.grip is not Grip.REST) else s.stiffness
        self._sliding = s.sliding_damping + back
        held = self._impedance, dt, firm
        model.pair_solref[:] = direct_reference(*held, s.damping + back)
        model.pair_solreffriction[:] = direct_reference(*held, self._sliding)
        if s.carry is not None:
            self._reach(step, s.carry * self._width)

    def _reach(self, step: Step, carry: float) -> None:
        """Set from which gap on each contact acts, and preload the one that carries the block."""
        model, sag = self._model, self._yield * self._ordinary**2
        if step.grip is not Grip.REST:
            model.pair_margin[:] = 0.0
            self._yields[:] = 0.5 * self._yield
        elif step.side:
            # the free corner, about to lift, is still in reach where no weight presses it
            model.pair_margin[:] = sag
        else:
            model.pair_margin[:] = self._margins_at_rest(step)
        if not step.side:
            return
        if model.npair == 1:
            # all corners of a box share one pair, and the free one must not touch early
            lean = 0.5 * self._width * abs(self.pose().theta)
            model.pair_margin[:] = max(sag, min(carry, lean))
            return
        pivot = self._left if step.side < 0.0 else self._right
        model.pair_margin[pivot] = carry
        if self._s.preload:
            preload = self._yield * step.kick_s / step.dt_s
            model.pair_solref[pivot, 0] = -preload * self._impedance**2 / carry

    def _margins_at_rest(self, step: Step) -> NDArray[np.float64]:
        """Gap [m] from which on each corner is held: what it carries presses it to the base.

        Were all the same, the block would lean on the corner that carries more. A corner that is
        higher is held from where it is, and comes down.
        """
        reach = step.kick_s * step.dt_s
        all_of_it = self._yield * reach
        held = np.clip(self._gaps(), self._yields * reach, all_of_it)
        return np.asarray(held + LEAST_HELD * all_of_it)

    def _gaps(self) -> NDArray[np.float64]:
        """Height [m] of each corner above the base."""
        pose = self.pose()
        level = pose.z - self._height * math.cos(pose.theta)
        return level + self._sides * (0.5 * self._width * math.sin(pose.theta))

    def _look_at_yield(self, step: Step) -> None:
        """Note by how much [m/s2] the corners yield to their forces, for the next step."""
        data = self._data
        if step.grip is Grip.REST and data.nefc:
            self._yield = float(data.efc_R[0]) * self._weight
            if data.ncon == self._model.npair > 1:
                normal = slice(None, None, data.nefc // data.ncon)
                resisted = data.efc_R[normal] * data.efc_force[normal]
                self._yields[:] = resisted * (step.dt_s / step.kick_s)
        elif step.grip is Grip.SWING and data.ncon == self._corners:
            self._yield = float(data.efc_R[0] * data.efc_force[0]) * step.dt_s / step.kick_s

    def _set_reach(self, scene: Scene) -> None:
        pairs = self._model.npair
        self._left, self._right = slice(0, pairs // 2), slice(pairs // 2, pairs)
        self._width = scene.block.width
        self._corners = max(pairs // 2, 1)
        self._weight = scene.mass * scene.block.gravity / self._corners
        self._impedance = 1.0 if self._s.impedance is None else self._s.impedance[1]
        self._yield = (1.0 - self._impedance) * scene.block.gravity
        self._yields = np.full(pairs, 0.5 * self._yield)
        self._sides = np.repeat((1.0, -1.0), pairs // 2) if pairs > 1 else np.zeros(pairs)

    def _move_base(self, step: Step) -> None:
        """Set the place from which the base sets out, and its surface velocity."""
        before, self._velocity = self._velocity, step.base_velocity
        # the contact turns the slip v- - V into (1 - b dt) times as much, so that a point which
        # moved with the base before moves with the base after
        if self._s.base_velocity:
            self._model.geom_surfacevel[0, 0] = before + step.base_kick / self._sliding
        self._data.mocap_pos[0, 0] = self._moved

    def _read_back(self, scene: Scene) -> str:
        s, model = self._s, self._model
        pairs: dict[str, tuple[Any, Any]] = {
            "mass": (scene.mass, model.body_mass[-1]),
            "timestep": (LIBRARY_STEP_S, self._option.timestep),
            "friction": (s.friction, model.geom_friction[-1, 0]),
        }
        pairs |= {f"inertia {i}": (scene.inertia[i], model.body_inertia[-1, i]) for i in range(3)}
        pairs |= {name: self._read_option(name) for name in OPTIONS}
        if s.impedance is not None:
            pairs |= {
                f"impedance {i}": (value, model.pair_solimp[0, i])
                for i, value in enumerate(s.impedance)
            }
            pairs["friction of the pair"] = (s.friction, model.pair_friction[0, 0])
        return disagreement(pairs)

    def _read_option(self, name: str) -> tuple[Any, Any]:
        """Return a wanted option as the library numbers it, and the option as it is."""
        wanted, found = getattr(self._s, name), getattr(self._option, name)
        if wanted is None or name not in KINDS:
            return wanted, found
        kind = getattr(self._mj, f"mjt{name.capitalize()}")
        return int(kind.__members__[KINDS[name] + wanted.upper()]), int(found)


def build(scene: Scene, settings: MujocoSettings, dt_s: float) -> MujocoWorld:
    """Build a scene; a preset's impratio is kept to what the friction allows."""
    return MujocoWorld(scene, kept(scene, settings), dt_s)


def _ignore(message: str) -> None:
    """Take a warning without writing it anywhere."""


ENGINE = Engine(
    name="mujoco",
    title="MuJoCo",
    library="mujoco",
    packages=("mujoco",),
    install="rocking",
    build=build,
    presets=(
        Preset(
            name="naive",
            title="the library's defaults",
            settings=MujocoSettings(),
            step_s=LIBRARY_STEP_S,
            step_source="the library's own timestep, 0.002 s",
            contact_s=DEFAULT_CONTACT_S,
        ),
        Preset(name="fixed", title="best at a fixed step", settings=TUNED, step=2.5e-4),
        Preset(
            name="landing",
            title="steps that land on impacts",
            settings=LANDING,
            stepping=Stepping.LANDING,
            helped_by={
                Help.STEPS: None,
                Help.PHASES: {"by_phase": False},
                Help.REFLECTION: {"reflection": False},
                Help.MARGIN: {"carry": None, "preload": False},
                Help.PRELOAD: {"preload": False},
            },
        ),
    ),
    core=True,
    geometries=GEOMETRIES,
    spatial=True,
    script=script,
    spring=spring,
    bouncing=BOUNCING,
    factors=FACTORS,
    rules=RULES,
    remedy={"impratio": 100.0},
    own_step="mujoco:mj_step",
)
