"""MuJoCo's models, side by side, for what else can step them: what it is given, what it answers.

MuJoCo itself reads the models; it takes none of the steps.
"""

from collections.abc import Iterator, Mapping, Sequence
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np

from engines.mujoco.model import coordinates, stepped_xml, welded
from engines.mujoco.settings import MujocoSettings, kept
from engines.parts.compiled import FloatArray
from engines.parts.readback import disagreement
from engines.scene import Scene
from engines.world import Moment, Step

STEP_BY_STEP = ("by_phase", "reflection", "carry", "preload")
"""What MuJoCo's own adapter sets anew in every step, which a port does not."""

DIFFERENT = (
    *("qpos0", "qpos_spring", "body_pos", "body_ipos", "body_mass", "body_subtreemass"),
    *("body_inertia", "body_invweight0", "dof_invweight0", "geom_size", "geom_aabb", "geom_rbound"),
    *("geom_pos", "geom_solref", "pair_solref", "pair_solreffriction", "pair_solimp"),
    *("pair_margin", "geom_margin"),
)
"""Arrays of a model in which blocks of other sizes, in other steps, may differ."""

READ = ("body_mass", "body_inertia", "geom_size", "pair_solref")
"""Arrays of a model that are read back."""


def refuse_step_by_step(settings: MujocoSettings) -> None:
    """Raise ValueError if settings ask for what is set anew in every step."""
    for name in STEP_BY_STEP:
        value = getattr(settings, name)
        if value:
            raise ValueError(f"{name} is {value!r}; it must be left out, all steps being alike")


class Loads(NamedTuple):
    """What worlds are given in each of some steps, as arrays (worlds, steps, ...).

    gravity [m/s2] and place [m] are vectors, the latter for each body that is moved by its place;
    surface is the velocity [m/s] of the base's surface, where it has one.
    """

    gravity: FloatArray
    place: FloatArray
    surface: FloatArray


class Port:
    """Models of scenes of one kind, side by side.

    Parameters
    ----------
    scenes : sequence of Scene
        Of the same settings, frame and contacts.
    settings : MujocoSettings
    dt_s : array (worlds,)
        Steps [s], all of a scene's alike.

    Attributes
    ----------
    models : list
        MuJoCo's models.
    starts : list of tuple
        Where the scenes begin: coordinates and velocities.
    """

    lag_m: FloatArray

    def __init__(self, scenes: Sequence[Scene], settings: MujocoSettings, dt_s: FloatArray) -> None:
        self._mujoco, scene = import_module("mujoco"), scenes[0]
        self.settings = s = kept(scene, settings)
        self.moment = Moment.END if s.integrator == "RK4" else Moment.MIDDLE
        xmls = [stepped_xml(one, s, float(dt)) for one, dt in zip(scenes, dt_s, strict=True)]
        self.models = [self._mujoco.MjModel.from_xml_string(xml) for xml in xmls]
        self.starts = [coordinates(one, s) for one in scenes]
        self._faults = [""] * len(scenes)
        self._homes = np.array([[body.home for body in one.bodies] for one in scenes])
        self._moving, self._welded = scene.frame == "world", welded(scene, s)
        moved = [model.body_pos[model.body_mocapid >= 0] for model in self.models]
        self._base_place = np.array(moved)
        self._base_x, self._velocity = np.zeros((2, len(scenes)))

    def data(self, number: int) -> Any:
        """Return MuJoCo's data where a scene begins, each of which takes megabytes."""
        data = self._mujoco.MjData(self.models[number])
        data.qpos[:], data.qvel[:] = self.starts[number]
        return data

    def loads(self, steps: Step) -> Loads:
        """Return what the worlds are given in some steps."""
        kick = np.asarray(steps.base_kick)
        gravity = np.zeros((*kick.shape, 3))
        gravity[..., 0], gravity[..., 2] = steps.pull_x, steps.pull_z
        place = np.repeat(self._base_place[:, None], kick.shape[1], axis=1)
        before = np.column_stack([self._velocity, steps.base_velocity])
        reached = np.column_stack([self._base_x, steps.base_x])
        if self._moving:
            # the contact turns the slip v- - V into (1 - b dt) times as much, so that a point which
            # moved with the base before moves with the base after
            place[..., 0, 0] = reached[:, 1:] if self._welded else reached[:, :-1]
        surface = before[:, :-1] + kick / (self.settings.sliding_damping or 1.0)
        self._velocity, self._base_x = before[:, -1], reached[:, -1]
        return Loads(gravity, place, surface)

    def poses(self, steps: Step, q: FloatArray, v: FloatArray) -> FloatArray:
        """Return every body's `Pose`, from coordinates and velocities (worlds, steps, ...)."""
        bodies = self._homes.shape[1]
        found = np.empty((*q.shape[:2], bodies, 4))
        moved = np.asarray(steps.base_x) * float(self._moving)
        raised = np.zeros_like(moved)
        if self._welded:
            moved, raised = q[..., -7], q[..., -5] - self._base_place[:, None, 0, 2]
            self.lag_m = np.abs(moved - steps.base_x)
        for body in range(bodies):
            x, z, theta, rate = found[..., body, :].transpose(2, 0, 1)
            if self.settings.planar:
                own, home = q[..., 3 * body :], self._homes[:, None, body]
                x[:], z[:] = own[..., 0] + home[..., 0], own[..., 1] + home[..., 1]
                theta[:], rate[:] = own[..., 2], v[..., 3 * body + 2]
            else:
                own = q[..., 7 * body :]
                x[:], z[:], rate[:] = own[..., 0], own[..., 2], v[..., 6 * body + 4]
                theta[:] = 2.0 * np.arctan2(own[..., 5], own[..., 3])
            x -= moved
            z -= raised
        return found

    def different(self) -> Iterator[tuple[str, FloatArray]]:
        """Yield the arrays in which the models differ, by name, stacked (worlds, ...)."""
        for name in DIFFERENT:
            stacked = np.array([getattr(model, name) for model in self.models])
            if (stacked != stacked[0]).any():
                yield name, stacked

    def read_back(self, rounding: float, read: Mapping[str, Any]) -> None:
        """Hold what was set against what was read, a row a world or one for all.

        Parameters
        ----------
        rounding : float
            Relative rounding of the numbers there.
        read : mapping
            Arrays `READ` of the models, and options of the solver by the names of settings.
        """
        for world, model in enumerate(self.models):
            pairs: dict[str, tuple[Any, Any]] = {}
            for name, rows in read.items():
                found = np.asarray(rows)[world % len(rows)].ravel().tolist()
                own = getattr(model, name) if name in READ else getattr(self.settings, name)
                wanted = np.ravel(own).tolist() if own is not None else found
                both = zip(wanted, found, strict=True)
                pairs |= {f"{name} {number}": pair for number, pair in enumerate(both)}
            self._faults[world] = disagreement(pairs, rounding)

    def fault(self, world: int) -> str:
        """Say which setting a world has not taken, or return an empty string."""
        return self._faults[world]

    def close(self) -> None:
        """Leave the memory to whoever counts what is in use."""
