"""MuJoCo: how a scene is built, set, read back and stepped."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import mujoco as mj

from engines.scene import GEOMETRIES, Pose, Scene, disagreement, one_of

OPTIONS = ("cone", "solver", "jacobian", "tolerance", "iterations", "impratio")
"""Settings that are options of the model under their own names."""

PLANAR_JOINTS = (
    '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>'
    '<joint type="hinge" axis="0 1 0"/>'
)


@dataclass(frozen=True, slots=True, kw_only=True)
class MujocoSettings:
    """Settings of MuJoCo; None leaves the library's default.

    A contact holds its points to the acceleration -b v - k r, v being their velocity and r the
    gap. Here b and k are given without units, as b dt and k dt^2: b dt = 1 takes all velocity out
    of a contact within one step.

    Attributes
    ----------
    geometry : str
        "box", or "corners": small spheres where the corners at the base are.
    planar : bool
        Give the block two slides and a hinge, and two corners in the middle plane, instead of a
        free joint and four corners at the edges.
    friction : float
        Coefficient between block and base.
    step : float or None
        p dt.
    corner_radius : float
        Radius of the corner spheres over the width.
    cone, solver, jacobian, tolerance, iterations, impratio : optional
        Options of the contact solver.
    damping, sliding_damping : float or None
        b dt along the contact's normal and along the base; both or neither.
    stiffness : float or None
        k dt^2, wherever damping is set.
    impedance : tuple of float or None
        The five numbers of solimp, wherever damping is set.
    """

    geometry: str = "corners"
    planar: bool = True
    friction: float = 10.0
    step: float | None = 5e-4
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

    def __post_init__(self) -> None:
        one_of("geometry", self.geometry, GEOMETRIES)
        contact = (self.damping, self.sliding_damping, self.stiffness, self.impedance)
        if len({value is None for value in contact}) != 1:
            raise ValueError(
                f"damping, sliding_damping, stiffness, impedance are {contact!r}; "
                "they must be given together or not at all"
            )
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
}


class MujocoWorld:
    """A block on a plane, or on a driven box where the base moves.

    A driven body has no velocity that friction could feel, so the box is given the surface
    velocity that its motion has.
    """

    def __init__(self, scene: Scene) -> None:
        self.settings = s = scene.choose(PRESETS[scene.preset])
        self._moving = scene.frame == "world"
        self._gravity = scene.block.gravity
        self._height = 0.5 * scene.block.height
        self._model = mj.MjModel.from_xml_string(model_xml(scene, s))
        self._data = mj.MjData(self._model)
        self._pull, self._option = self._model.opt.gravity, self._model.opt
        self.default_step_s = self._option.timestep if s.step is None else s.step / scene.block.p
        self._velocity = self._moved = self._dt = self._time = 0.0
        self._fault = self._read_back(scene)
        # the library would write its warnings to a file; they are counted and read from `fault`
        mj.set_mju_user_warning(_ignore)

    def step(self, dt_s: float, kick_s: float, base_kick: float) -> None:
        """Advance by `dt_s` [s]; see `engines.scene.World`."""
        if dt_s != self._dt:
            self._set_step(dt_s)
        self._pull[2] = -self._gravity * kick_s / dt_s
        if self._moving:
            self._move_base(dt_s, base_kick)
        else:
            self._pull[0] = -base_kick / dt_s
        mj.mj_step(self._model, self._data)
        self._time += dt_s

    def pose(self) -> Pose:
        """Read the block's pose back."""
        q, v = self._data.qpos.tolist(), self._data.qvel
        if self.settings.planar:
            return Pose(q[0] - self._moved, q[1] + self._height, q[2], float(v[2]))
        return Pose(q[0] - self._moved, q[2], 2.0 * math.atan2(q[5], q[3]), float(v[4]))

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

    def _set_step(self, dt_s: float) -> None:
        s = self.settings
        self._option.timestep = self._dt = dt_s
        if s.stiffness is not None and s.damping is not None and s.sliding_damping is not None:
            stiffness = -s.stiffness / dt_s**2
            self._model.pair_solref[:] = (stiffness, -s.damping / dt_s)
            self._model.pair_solreffriction[:] = (stiffness, -s.sliding_damping / dt_s)

    def _move_base(self, dt_s: float, base_kick: float) -> None:
        before, self._velocity = self._velocity, self._velocity + base_kick
        b = 1.0 if self.settings.sliding_damping is None else self.settings.sliding_damping
        # the contact turns the slip v- - V into (1 - b dt) times as much, so that a point which
        # moved with the base before moves with the base after
        self._model.geom_surfacevel[0, 0] = before + base_kick / b
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


def build(scene: Scene) -> MujocoWorld:
    """Build a scene, the block at rest on its base."""
    return MujocoWorld(scene)


def model_xml(scene: Scene, settings: MujocoSettings) -> str:
    """Return the model of a scene in MuJoCo's own language."""
    s, block = settings, scene.block
    named = ((name, getattr(s, name)) for name in OPTIONS)
    options = " ".join(f'{name}="{value}"' for name, value in named if value is not None)
    geoms = _geoms(scene, s)
    parts = (f'<geom name="{name}" {shape} {_friction(s)}/>' for name, shape in geoms.items())
    pairs = "" if s.impedance is None else "".join(_pair(name, s) for name in geoms)
    return (
        f"<mujoco><option {options}/><worldbody>{_base(scene, s)}"
        f'<body pos="0 0 {0.5 * block.height}">{PLANAR_JOINTS if s.planar else "<freejoint/>"}'
        f'<inertial pos="0 0 0" mass="{scene.mass}" diaginertia="{_row(scene.inertia)}"/>'
        f"{''.join(parts)}</body></worldbody><contact>{pairs}</contact></mujoco>"
    )


def _base(scene: Scene, s: MujocoSettings) -> str:
    if scene.frame == "base":
        return f'<geom name="base" type="plane" size="1 1 1" {_friction(s)}/>'
    # a plane may not move, so a box does; any surface velocity will do to switch it on
    size = _row((100.0 * scene.block.height, 100.0 * scene.depth_m, scene.block.height))
    return (
        f'<body mocap="true" pos="0 0 {-scene.block.height}">'
        f'<geom name="base" type="box" size="{size}" surfacevel="1 0 0" {_friction(s)}/></body>'
    )


def _geoms(scene: Scene, s: MujocoSettings) -> dict[str, str]:
    """Name and shape of what the block touches its base with."""
    half = (0.5 * scene.block.width, 0.5 * scene.depth_m, 0.5 * scene.block.height)
    if s.geometry == "box":
        return {"box": f'type="box" size="{_row(half)}"'}
    radius = s.corner_radius * scene.block.width
    depths = (0.0,) if s.planar else (-half[1], half[1])
    corners = [(x, y, radius - half[2]) for x in (-half[0], half[0]) for y in depths]
    shape = f'type="sphere" size="{radius}"'
    return {f"corner{i}": f'{shape} pos="{_row(at)}"' for i, at in enumerate(corners)}


def _friction(s: MujocoSettings) -> str:
    return f'friction="{s.friction} 0.005 0.0001"'


def _pair(name: str, s: MujocoSettings) -> str:
    friction = _row((s.friction, s.friction, 0.005, 0.0001, 0.0001))
    return (
        f'<pair geom1="base" geom2="{name}" condim="3" friction="{friction}" margin="0" '
        f'solimp="{_row(s.impedance or ())}" solref="-1 -1" solreffriction="-1 -1"/>'
    )


def _row(numbers: tuple[float, ...]) -> str:
    return " ".join(map(repr, numbers))


def _option(option: Any, name: str, wanted: Any) -> tuple[Any, Any]:
    """Return a wanted option as the library numbers it, and the option as it is."""
    kinds = {"cone": "mjCONE_", "solver": "mjSOL_", "jacobian": "mjJAC_"}
    if wanted is None or name not in kinds:
        return wanted, getattr(option, name)
    kind = getattr(mj, f"mjt{name.capitalize()}")
    return int(kind.__members__[kinds[name] + wanted.upper()]), int(getattr(option, name))


def _ignore(message: str) -> None:
    """Take a warning without writing it anywhere."""
