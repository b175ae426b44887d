"""MuJoCo's own rollout: the equal steps of a scene by one call, forces in place of gravity.

It is no engine of the registry: it answers as MuJoCo does but for last digits, and is there to be
measured. Announced as `engines.mujoco.rollout:ENGINE` (ROCKING_ENGINES), it is a source of its own.
"""

from collections.abc import Sequence
from copy import copy
from dataclasses import fields
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from engines.declaration import BatchEngine, Stepping
from engines.mujoco import ENGINE as STEPPED
from engines.mujoco.build import MujocoWorld
from engines.mujoco.contact import FREE, WELDED, prepare_step
from engines.mujoco.model import welded
from engines.mujoco.settings import MujocoSettings, kept
from engines.parts.compiled import FloatArray
from engines.scene import Scene
from engines.world import Grip, Pose, Step

PLANAR = 3
"""Coordinates of a body in the plane."""


class Posed(MujocoWorld):
    """A world from which a rollout sets out: its contact set for equal steps, once.

    Attributes
    ----------
    model
        A copy of it, which outlives the world.
    begin : array
        Its state, as the library keeps it: time, positions, velocities.
    masses : array (velocities, 2)
        What gives each coordinate its force along the base and upwards [kg].
    """

    def __init__(self, scene: Scene, settings: MujocoSettings, dt_s: float) -> None:
        super().__init__(scene, kept(scene, settings), dt_s)
        held, mj, data = self._held, self._mj, self._data
        if held.by_step or (held.moving and not held.welded):
            self.close()
            raise ValueError("a contact or a base that is set anew each step cannot be rolled out")
        step = Step(dt_s, dt_s, dt_s, 0.0, -scene.system.gravity, 0.0, 0.0, 0.0, Grip.SWING, 0.0)
        prepare_step(self._holds, self._arrays, (*step[:-2], int(step.grip), step.side))
        self._option.timestep = dt_s
        self.model: Any = copy(self._model)
        kind = int(mj.mjtState.mjSTATE_FULLPHYSICS)
        self.begin = np.empty(mj.mj_stateSize(self.model, kind))
        mj.mj_getState(self.model, data, self.begin, kind)
        up, count = (1, PLANAR) if held.planar else (2, WELDED)
        self.masses = np.zeros((self.model.nv, 2))
        for number, body in enumerate(scene.bodies):
            self.masses[count * number, 0] = self.masses[count * number + up, 1] = body.mass
        if held.welded:
            self.masses[-WELDED, 0] = self.masses[-WELDED + 2, 1] = self.model.body("floor").mass[0]


class Rollouts:
    """Scenes side by side; see `engines.world.Worlds`."""

    driver = "rollout"

    def __init__(self, scenes: Sequence[Scene], settings: MujocoSettings, dt_s: FloatArray) -> None:
        mj = self._mj = import_module("mujoco")
        states = mj.mjtState
        self._rollout = import_module("mujoco.rollout").Rollout(nthread=0)
        self._scenes, self._planar, self._welded = scenes, settings.planar, False
        self._models, self._masses, self._states, self._faults = [], [], [], []
        for scene, its_s in zip(scenes, dt_s.tolist(), strict=True):
            world = Posed(scene, settings, its_s)
            self.moment = world.moment
            self._models.append(world.model)
            self._masses.append(world.masses)
            self._states.append(world.begin)
            self._faults.append(world.fault())
            world.close()
        self._welded = welded(scenes[0], settings)
        self._spec = int(states.mjSTATE_QFRC_APPLIED)
        if self._welded:
            self._spec |= int(states.mjSTATE_MOCAP_POS)
        # one for all: with its arena it takes a thousand times a model
        self._data = mj.MjData(self._models[0])
        self._warm = np.zeros((len(scenes), self._models[0].nv))
        self.lag_m: FloatArray | None = None
        mj.set_mju_user_warning(lambda message: None)

    def advance(self, steps: Step, going: NDArray[np.bool_]) -> FloatArray:
        """Take some steps."""
        shape = np.shape(steps.dt_s)
        poses = np.full((*shape, len(self._scenes[0].bodies), len(Pose._fields)), np.nan)
        self.lag_m = np.zeros(shape) if self._welded else None
        for world in np.flatnonzero(going).tolist():
            of_all: Any = steps  # arrays
            own = Step(*(part[world] for part in of_all))
            if not self._faults[world]:
                poses[world] = self._poses(world, self._rolled(world, own), own)
        return poses

    def _rolled(self, world: int, steps: Step) -> FloatArray:
        """Return the library's states at the ends of some steps, nan after a warning."""
        model, data, gravity = self._models[world], self._data, self._scenes[world].system.gravity
        pulls = np.column_stack((steps.pull_x, steps.pull_z + gravity))
        control = pulls @ self._masses[world].T
        if self._welded:
            places = np.tile(data.mocap_pos[0], (len(control), 1))
            places[:, 0], places[:, 2] = steps.base_x, -self._scenes[world].bodies[0].height
            control = np.hstack((control, places))
        begin = self._states[world]
        states = np.empty((1, len(control), len(begin)))
        self._rollout.rollout(
            [model],
            [data],
            begin[None],
            control[None],
            control_spec=self._spec,
            nstep=len(control),
            initial_warmstart=self._warm[world][None],
            state=states,
        )
        self._states[world], self._warm[world] = states[0, -1].copy(), data.qacc_warmstart
        warned = data.warning.number.nonzero()[0]
        if warned.size:
            kind = list(self._mj.mjtWarning.__members__)[warned[0]]
            self._faults[world] = f"MuJoCo warned: {kind.removeprefix('mjWARN_')}"
            # where it stops or begins anew, its clock does
            late = np.diff(states[0, :, 0], prepend=begin[0]) < 0.5 * model.opt.timestep
            states[0, np.logical_or.accumulate(late)] = np.nan
        return states[0]

    def _poses(self, world: int, states: FloatArray, steps: Step) -> FloatArray:
        model, scene = self._models[world], self._scenes[world]
        q, v = states[:, 1 : 1 + model.nq], states[:, 1 + model.nq :]
        moved, raised = np.zeros(len(states)), np.zeros(len(states))
        if self._welded:
            moved, raised = q[:, -FREE], q[:, 2 - FREE] + scene.bodies[0].height
            if self.lag_m is not None:
                self.lag_m[world] = abs(moved - steps.base_x)
        found = []
        for number, body in enumerate(scene.bodies):
            if self._planar:
                x, z, theta, rate = *q[:, PLANAR * number :].T[:3], v[:, PLANAR * number + 2]
                found.append((x + body.home[0] - moved, z + body.home[1] - raised, theta, rate))
            else:
                own = q[:, FREE * number :].T
                theta, rate = 2.0 * np.arctan2(own[5], own[3]), v[:, WELDED * number + 4]
                found.append((own[0] - moved, own[2] - raised, theta, rate))
        return np.moveaxis(np.array(found), 2, 0)

    def fault(self, world: int) -> str:
        """Say which setting was not taken, or what the engine warned of."""
        return str(self._faults[world])

    def close(self) -> None:
        """Give warnings back to the library."""
        self._mj.set_mju_user_warning(None)
        self._rollout.close()


ENGINE = BatchEngine(
    **{item.name: getattr(STEPPED, item.name) for item in fields(STEPPED)}
    | {
        "name": "mujoco-rollout",
        "title": "MuJoCo, rolled out",
        "presets": tuple(use for use in STEPPED.presets if use.stepping is Stepping.FIXED),
        "core": False,
        "batch": Rollouts,
    }
)
