"""MuJoCo: how a scene is built, set, read back and stepped."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import mujoco as mj
import numpy as np
from numpy.typing import NDArray

from engines.mujoco_model import OPTIONS, model_xml
from engines.scene import GEOMETRIES, Grip, Pose, Scene, Step, disagreement, one_of

INTEGRATORS = ("Euler", "implicit", "implicitfast")
"""Integrators of the library whose velocity carries the block through the whole step, as `World`
has it. RK4's belongs to the step's end: it would feel the base's motion half a step late."""

MOST_REFLECTION = 25.0
"""Landing returns no more than this part of the velocity with which a contact comes into a step:
after a far shorter step that is noise."""

MOST_GROWTH = 20.0
"""Where the block hardly turns, by how much faster it will turn is noise: a contact's velocity is
returned as if it grew by no more than this many p dt in a step."""

FEEBLE = 1e-15
"""k dt^2 where positions are to be left alone; the library takes a zero for something else."""

NARROWEST_CONE = 0.1
"""Friction over the root of impratio: what the solver takes for the cone; it errs in a narrower
one."""

LEAST_HELD = 1e-3
"""Part of what the whole weight would press a corner by, up to which landing holds one at rest."""

CARRY = 1e-4
"""Gap, over the width, up to which landing keeps the corner about which the block turns."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MujocoSettings:
    """Settings of MuJoCo; None leaves the library's default.

    A contact holds its points to the acceleration -b v - k r, v being their velocity and r the
    gap. Here b and k are given without units, as b dt and k dt^2: b dt = 1 takes all velocity out
    of a contact within one step.

    Attributes
    ----------
    geometry : str
        "box", "corners": small spheres where the corners at the base are, or "hull": a convex
        mesh of the block's eight corners.
    planar : bool
        Give the block two slides and a hinge, and two corners in the middle plane, instead of a
        free joint and four corners at the edges.
    friction : float
        Coefficient between block and base.
    step : float or None
        p dt.
    corner_radius : float
        Radius of the corner spheres over the width.
    cone, solver, jacobian, tolerance, iterations, impratio, noslip_iterations : optional
        Options of the contact solver.
    integrator : str or None
        "Euler", "implicit" or "implicitfast".
    damping, sliding_damping : float or None
        b dt along the contact's normal and along the base; both or neither.
    stiffness : float or None
        k dt^2, wherever damping is set.
    impedance : tuple of float or None
        The five numbers of solimp; needed wherever damping is set.
    solref : tuple of float or None
        The contact in the library's other form, in place of damping and stiffness: its time
        constant over dt and its damping ratio. Both should be positive: the library takes a pair
        with one zero for its own default, and goes on.
    margin : float or None
        Gap, over the width, from which on a contact acts.
    base_velocity : bool
        Give a moving base the velocity that friction feels; else it is moved by position alone.
    landing : bool
        Hold each contact as the step needs it: `stiffness` at rest alone, velocities reflected
        while the block turns about a corner, and taken out in the steps of an impact and the
        first one after.
    """

    geometry: str = "corners"
    planar: bool = True
    friction: float = 10.0
    step: float | None = 2.5e-4
    corner_radius: float = 1e-7
    cone: str | None = "elliptic"
    solver: str | None = "Newton"
    jacobian: str | None = "dense"
    tolerance: float | None = 1e-15
    iterations: int | None = 100
    impratio: float | None = 1e4
    damping: float | None = 1.0
    sliding_damping: float | None = 1.0
    stiffness: float | None = 0.01
    impedance: tuple[float, ...] | None = (0.9999, 0.9999, 0.001, 0.5, 2.0)
    landing: bool = False
    integrator: str | None = None
    noslip_iterations: int | None = None
    solref: tuple[float, float] | None = None
    margin: float | None = None
    base_velocity: bool = True

    def __post_init__(self) -> None:
        one_of("geometry", self.geometry, GEOMETRIES)
        contact = (self.damping, self.sliding_damping, self.stiffness, self.impedance)
        if len({value is None for value in contact[:3]}) != 1:
            raise ValueError(
                f"damping, sliding_damping, stiffness are {contact[:3]!r}; "
                "they must be given together or not at all"
            )
        if self.damping is not None and self.impedance is None:
            raise ValueError("impedance is None; it must be given wherever damping is")
        if self.solref is not None and self.damping is not None:
            raise ValueError(
                f"solref is {self.solref!r}; it must be None wherever damping is given"
            )
        if self.integrator is not None:
            one_of("integrator", self.integrator, INTEGRATORS)
        for name in ("noslip_iterations", "margin"):
            if getattr(self, name) is not None and not 0 <= getattr(self, name) < math.inf:
                raise ValueError(f"{name} is {getattr(self, name)!r}; it must be 0 or more")
        for name in ("damping", "sliding_damping", "stiffness"):
            if getattr(self, name) is not None and getattr(self, name) <= 0.0:
                # a reference with one zero would be replaced by the library's default
                raise ValueError(f"{name} is {getattr(self, name)!r}; it must be positive")


PRESETS: Mapping[str, MujocoSettings] = {
    "naive": MujocoSettings(
        geometry="box",
        planar=False,
        friction=1.0,
        step=None,
        cone=None,
        solver=None,
        jacobian=None,
        tolerance=None,
        iterations=None,
        impratio=None,
        damping=None,
        sliding_damping=None,
        stiffness=None,
        impedance=None,
    ),
    "fixed": MujocoSettings(),
    "landing": MujocoSettings(step=None, friction=1e3, stiffness=1.0, impratio=3e3, landing=True),
}


class MujocoWorld:
    """A block on a plane, or on a driven box where the base moves.

    A driven body has no velocity that friction could feel, so the box is given the surface
    velocity that its motion has.
    """

    def __init__(self, scene: Scene) -> None:
        self.settings = s = settings_of(scene)
        self._moving = scene.frame == "world"
        self._gravity = scene.block.gravity
        self._height = 0.5 * scene.block.height
        self._model = mj.MjModel.from_xml_string(model_xml(scene, s))
        self._data = mj.MjData(self._model)
        self._pull, self._option = self._model.opt.gravity, self._model.opt
        self.dt_s = scene.ordinary_step(s.step, self._option.timestep)
        self._velocity = self._moved = self._dt = self._time = 0.0
        self._rate = self._gained = 0.0
        self._aloft, self._back = False, 0.0
        self._spin = 2 if s.planar else 4
        self._growth = 1.0 + MOST_GROWTH * scene.block.p * self.dt_s
        self._sliding = 1.0 if s.sliding_damping is None else s.sliding_damping
        self._set_reach(scene)
        self._fault = self._read_back(scene)
        # the library would write its warnings to a file; they are counted and read from `fault`
        mj.set_mju_user_warning(_ignore)

    def step(self, step: Step) -> None:
        """Advance by a step; see `engines.scene.World`."""
        self._hold(step)
        self._pull[2] = -self._gravity * step.kick_s / step.dt_s
        if self._moving:
            self._move_base(step.dt_s, step.base_kick)
        else:
            self._pull[0] = -step.base_kick / step.dt_s
        mj.mj_step(self._model, self._data)
        self._time += step.dt_s
        if self.settings.landing:
            self._look_at_yield(step)
            self._look_at_rate(step)

    def pose(self) -> Pose:
        """Read the block's pose back."""
        q, v = self._data.qpos.tolist(), self._data.qvel.tolist()
        if self.settings.planar:
            return Pose(q[0] - self._moved, q[1] + self._height, q[2], v[2])
        return Pose(q[0] - self._moved, q[2], 2.0 * math.atan2(q[5], q[3]), v[4])

    def fault(self) -> str:
        """Say which setting was not taken, or what the engine warned of."""
        if self._fault:
            return self._fault
        for kind, warning in zip(mj.mjtWarning.__members__, self._data.warning, strict=False):
            if warning.number:
                return f"MuJoCo warned: {kind.removeprefix('mjWARN_')}"
        return disagreement({"time": (self._time, self._data.time)})

    def close(self) -> None:
        """Give warnings back to the library."""
        mj.set_mju_user_warning(None)

    def _hold(self, step: Step) -> None:
        """Set the step, and the contact in units of it."""
        s, model, dt = self.settings, self._model, step.dt_s
        if dt == self._dt and not s.landing:
            return
        before, self._dt = self._dt, dt
        self._option.timestep = dt
        if s.solref is not None:
            model.pair_solref[:] = model.geom_solref[:] = (s.solref[0] * dt, s.solref[1])
        if s.damping is None or s.sliding_damping is None or s.stiffness is None:
            return
        self._back = back = self._reflected(step, before) if s.landing else 0.0
        firm = FEEBLE if s.landing and (step.side or step.grip is not Grip.REST) else s.stiffness
        self._sliding = s.sliding_damping + back
        # the library divides both numbers by the impedance, the first one twice
        k, unit = -firm * (self._impedance / dt) ** 2, -self._impedance / dt
        model.pair_solref[:] = (k, unit * (s.damping + back))
        model.pair_solreffriction[:] = (k, unit * self._sliding)
        if s.landing:
            self._reach(step)

    def _reflected(self, step: Step, before: float) -> float:
        """Part of a contact's velocity that is returned, with a change of sign.

        A pivot is back where it was at the end of a step h if it leaves with -c h/2, c being its
        centripetal acceleration, in proportion to the square of the angular velocity; it comes
        into the next step with c h/2, or with c h if it was held and not returned before.
        """
        was_aloft, self._aloft = self._aloft, step.grip in (Grip.SWING, Grip.APPROACH)
        if not (was_aloft and self._aloft and self._rate):
            return 0.0
        faster = 1.0 + self._gained * step.kick_s / self._rate
        part = min(faster * faster, self._growth) * step.dt_s / before
        return min(part if self._back else 0.5 * part, MOST_REFLECTION)

    def _reach(self, step: Step) -> None:
        """Set from which gap on each contact acts, and preload the one that carries the block."""
        model, sag = self._model, self._yield * self.dt_s**2
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
            model.pair_margin[:] = max(sag, min(self._carry, lean))
            return
        pivot = self._left if step.side < 0.0 else self._right
        model.pair_margin[pivot] = self._carry
        preload = self._yield * step.kick_s / step.dt_s
        model.pair_solref[pivot, 0] = -preload * self._impedance**2 / self._carry

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

    def _look_at_rate(self, step: Step) -> None:
        """Note the angular velocity [rad/s] of a step, and the acceleration [rad/s2] before it."""
        before, self._rate = self._rate, float(self._data.qvel[self._spin])
        self._gained = (self._rate - before) / step.kick_s

    def _set_reach(self, scene: Scene) -> None:
        s, pairs = self.settings, self._model.npair
        self._left, self._right = slice(0, pairs // 2), slice(pairs // 2, pairs)
        self._width = scene.block.width
        self._carry = CARRY * scene.block.width
        self._corners = max(pairs // 2, 1)
        self._weight = scene.mass * scene.block.gravity / self._corners
        self._impedance = 1.0 if s.impedance is None else s.impedance[1]
        self._yield = (1.0 - self._impedance) * scene.block.gravity
        self._yields = np.full(pairs, 0.5 * self._yield)
        self._sides = np.repeat((1.0, -1.0), pairs // 2) if pairs > 1 else np.zeros(pairs)

    def _move_base(self, dt_s: float, base_kick: float) -> None:
        before, self._velocity = self._velocity, self._velocity + base_kick
        # the contact turns the slip v- - V into (1 - b dt) times as much, so that a point which
        # moved with the base before moves with the base after
        if self.settings.base_velocity:
            self._model.geom_surfacevel[0, 0] = before + base_kick / self._sliding
        self._data.mocap_pos[0, 0] = self._moved
        self._moved += dt_s * self._velocity

    def _read_back(self, scene: Scene) -> str:
        s, model = self.settings, self._model
        pairs: dict[str, tuple[Any, Any]] = {"mass": (scene.mass, model.body_mass[-1])}
        pairs |= {f"inertia {i}": (scene.inertia[i], model.body_inertia[-1, i]) for i in range(3)}
        pairs |= {name: _option(self._option, name, getattr(s, name)) for name in OPTIONS}
        pairs["friction"] = (s.friction, model.geom_friction[-1, 0])
        if s.impedance is not None:
            pairs |= {
                f"impedance {i}": (value, model.pair_solimp[0, i])
                for i, value in enumerate(s.impedance)
            }
            pairs["friction of the pair"] = (s.friction, model.pair_friction[0, 0])
        return disagreement({name: pair for name, pair in pairs.items() if pair[0] is not None})


def settings_of(scene: Scene) -> MujocoSettings:
    """Return the settings of a scene; a preset's impratio is kept to what its friction allows."""
    s = scene.choose(PRESETS[scene.preset])
    if s.impratio is None or "impratio" in scene.settings:
        return s
    return replace(s, impratio=min(s.impratio, (s.friction / NARROWEST_CONE) ** 2))


def build(scene: Scene) -> MujocoWorld:
    """Build a scene, the block at rest on its base."""
    return MujocoWorld(scene)


def _option(option: Any, name: str, wanted: Any) -> tuple[Any, Any]:
    """Return a wanted option as the library numbers it, and the option as it is."""
    kinds = {"cone": "mjCONE_", "solver": "mjSOL_", "jacobian": "mjJAC_", "integrator": "mjINT_"}
    if wanted is None or name not in kinds:
        return wanted, getattr(option, name)
    kind = getattr(mj, f"mjt{name.capitalize()}")
    return int(kind.__members__[kinds[name] + wanted.upper()]), int(getattr(option, name))


def _ignore(message: str) -> None:
    """Take a warning without writing it anywhere."""
