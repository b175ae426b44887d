"""MuJoCo: its settings, and how a scene is built, set, read back and stepped."""

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from importlib import import_module
from typing import Any
from xml.etree import ElementTree

import numpy as np

from engines.mujoco import contact
from engines.parts import yaw_of
from engines.run.look import compiled, records
from engines.scene import BASE, Scene
from engines.settings import check, disagreement, setting
from engines.shapes import corner_spheres, floor_half_size, half_size, hull_points
from engines.world import FloatArray, Moment, Pose, Script, Step

NARROWEST_CONE, SOFT = 0.1, 0.5
"""Friction over the root of impratio: the solver's cone; it errs in a narrower one, unless a
contact's impedance is below the second number."""

FLOOR_MASSES = 1000.0
"""Mass of a welded base over that of the bodies on it. From ten on it hardly matters; but the
library's own for so large a box, 240000 at equal densities, is where its solver ends too early."""

OPTIONS = {
    **{"cone": "mjCONE_", "solver": "mjSOL_", "jacobian": "mjJAC_", "integrator": "mjINT_"},
    **dict.fromkeys(("tolerance", "iterations", "impratio", "noslip_iterations"), ""),
}
"""Options of the model -> how the library's names of their values begin, where they have any."""

PLANAR_JOINTS = (
    '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>'
    '<joint type="hinge" axis="0 1 0"/>'
)


@dataclass(frozen=True, slots=True, kw_only=True)
class MujocoSettings:
    """Settings of MuJoCo, by default its own; None leaves a setting to the library.

    Of a contact (`engines.mujoco.contact`) b and k are given without units, as b dt and k dt^2:
    b dt = 1 takes all velocity out of a contact within one step.

    geometry: "box", "corners" (small spheres where the corners at the base are) or "hull" (a convex
        mesh of the block's eight corners).
    planar: two slides and a hinge, and two corners in the middle plane, instead of a free joint and
        four corners at the edges.
    corner_radius, margin, carry: over the width: radius of the spheres; gap from which on a contact
        acts; gap within which the corner about which the block turns stays in contact, however long
        the step.
    diagexact: scale each contact's regularization by the inertia that it feels, not by an estimate
        of it made where the bodies were built.
    damping, sliding_damping, stiffness: b dt along the contact's normal and along the base, and
        k dt^2; all or none.
    impedance: the five numbers of solimp; needed wherever damping is set.
    soft_surface: depth over g dt^2 within which a contact grows from the first of the impedances to
        the second, in place of their width; it keeps contacts that close together from parting. Of
        bodies that rest on others it is over g dt^2 sin(alpha)^2, and softens the first one, too.
    solref: the contact, and the weld of a moving base, in the library's other form, in place of
        damping and stiffness: its time constant over the ordinary step and its damping ratio, both
        positive: the library takes a pair with one zero for its own default, and goes on.
    geom_reference: k dt^2 and b dt in one line of defaults for all geoms, as is the impedance then.
    floor: how a base that moves is moved: by a "weld" to a body that is, by its "surfacevel", or by
        "position" alone.
    by_phase, reflection, preload: use `stiffness` at rest alone; give the velocity of the corner
        about which the block turns back to it; press that corner by what its force yields, where
        `carry` is set.
    others: options of the library.
    """

    geometry: str = setting("box", names=("box", "corners", "hull"))
    planar: bool = False
    friction: float = setting(1.0, least=0.0)
    corner_radius: float = setting(1e-7, above=0.0)
    cone: str | None = None
    solver: str | None = None
    jacobian: str | None = None
    tolerance: float | None = setting(least=0.0)
    iterations: int | None = setting(least=0)
    diagexact: bool | None = None
    impratio: float | None = setting(least=0.0)
    # a reference with one zero would be replaced by the library's default
    damping: float | None = setting(above=0.0, beside=("sliding_damping", "stiffness"))
    sliding_damping: float | None = setting(above=0.0)
    stiffness: float | None = setting(above=0.0)
    impedance: tuple[float, ...] | None = None
    soft_surface: float | None = setting(above=0.0)
    by_phase: bool = False
    reflection: bool = False
    carry: float | None = setting(above=0.0)
    preload: bool = False
    integrator: str | None = setting(names=("Euler", "RK4", "implicit", "implicitfast"))
    noslip_iterations: int | None = setting(least=0)
    solref: tuple[float, float] | None = None
    geom_reference: tuple[float, float] | None = None
    margin: float | None = setting(least=0.0)
    floor: str = setting("weld", names=("weld", "surfacevel", "position"))

    def __post_init__(self) -> None:
        check(self)
        if self.damping is not None and self.impedance is None:
            raise ValueError("impedance is None; it must be given wherever damping is")
        if self.solref is not None and self.damping is not None:
            raise ValueError(f"solref is {self.solref!r}; it must be None where damping is given")

    def fitted(self, scene: Scene) -> "MujocoSettings":
        """Return settings whose impratio the friction allows, and whose soft surface fits.

        A step lifts a pivot by (theta' dt)^2 R/2. A contact makes up for it that yields as much, by
        (1 - d)/d times force over mass, d being its impedance. One that yields less at its surface
        lets go; one that yields much less below overshoots: both go by sin(alpha)^2.
        """
        s = self
        if scene.stacked and s.impedance and s.soft_surface is not None:
            yields = s.soft_surface * math.sin(scene.system.alpha) ** 2
            surface, *below = s.impedance
            softest = min(surface, 1.0 / (1.0 + yields))
            s = replace(s, impedance=(softest, *below), soft_surface=yields)
        soft = s.impedance is not None and s.impedance[1] < SOFT
        if s.impratio is None or soft or "impratio" in scene.settings:
            return s
        return replace(s, impratio=min(s.impratio, (s.friction / NARROWEST_CONE) ** 2))

    def solimp(self, scene: Scene, dt_s: float) -> tuple[float, ...]:
        """Return solimp: impedances at surface and width, width [m], midpoint, power; or none."""
        if self.impedance is None or self.soft_surface is None:
            return self.impedance or ()
        surface, whole, _, *curve = self.impedance
        return surface, whole, self.soft_surface * scene.system.gravity * dt_s**2, *curve

    def direct(self, dt_s: float) -> tuple[float, ...]:
        """Return solref of all geoms for steps [s], minus a stiffness and a damping; or none."""
        if self.geom_reference is None:
            return ()
        stiffness, damping = self.geom_reference
        return -stiffness / dt_s**2, -damping / dt_s


def model_xml(scene: Scene, s: MujocoSettings, dt_s: float) -> str:
    """Return the model of a scene in MuJoCo's own language, its bodies upright, for steps [s]."""
    options = "".join(f'{k}="{getattr(s, k)}" ' for k in OPTIONS if getattr(s, k) is not None)
    flag = ""
    if s.diagexact is not None:
        flag = f'<flag diagexact="{"enable" if s.diagexact else "disable"}"/>'
    margin = (s.margin or 0.0) * scene.system.width
    held, reference = f'friction="{s.friction} 0.005 0.0001"', ""
    if s.solref is not None:
        reference = f'solref="{_row((s.solref[0] * dt_s, s.solref[1]))}"'
    base, floor, weld = _base(scene, s, held, reference)
    shapes = f'{held} margin="{margin}" {reference}'
    bodies = "".join(_body(scene, number, s, shapes) for number in range(len(scene.bodies)))
    pairs = meshes = defaults = ""
    if s.geom_reference is not None:
        own = f'solref="{_row(s.direct(dt_s))}" solimp="{_row(s.impedance or ())}"'
        defaults = f"<default><geom {own}/></default>"
    elif s.impedance is not None:
        if s.damping is not None:
            by, both = (s.impedance[1], dt_s, s.stiffness or 0.0), (s.damping, s.sliding_damping)
            normal, along = (contact.direct(*by, damping or 0.0) for damping in both)
            reference = f'solref="{_row(normal)}" solreffriction="{_row(along)}"'
        friction = _row((s.friction, s.friction, 0.005, 0.0001, 0.0001))
        held = f'friction="{friction}" margin="{margin}" solimp="{_row(s.solimp(scene, dt_s))}"'
        touching = (f'{names} condim="3" {held} {reference}' for names in _pairs(scene, s))
        pairs = "".join(f"<pair {each}/>" for each in touching)
    if s.geometry == "hull":
        hulls = ((n, " ".join(map(_row, hull_points(each)))) for n, each in enumerate(scene.bodies))
        each = (f'<mesh name="{_named("hull", n)}" vertex="{points}"/>' for n, points in hulls)
        meshes = f"<asset>{''.join(each)}</asset>"
    return (
        f'<mujoco><option {options}timestep="{dt_s!r}">{flag}</option>{defaults}{meshes}<worldbody>'
        f"{base}{bodies}{floor}</worldbody><contact>{pairs}</contact>{weld}</mujoco>"
    )


def _base(scene: Scene, s: MujocoSettings, held: str, reference: str) -> tuple[str, str, str]:
    """Return the base; or what leads it, the base, whose joint comes last, and the weld of both."""
    held += f" {reference}"
    if scene.frame != "world":
        return f'<geom name="base" type="plane" size="1 1 1" {held}/>', "", ""
    at = f'pos="0 0 {-scene.bodies[0].height}"'
    box = f'<geom name="base" type="box" size="{_row(floor_half_size(scene))}"'
    if s.floor != "weld":
        # a plane may not move, so a box does; any surface velocity will do to switch it on
        slides = f'surfacevel="{int(s.floor == "surfacevel")} 0 0"'
        return f'<body mocap="true" {at}>{box} {slides} {held}/></body>', "", ""
    mass = FLOOR_MASSES * sum(body.mass for body in scene.bodies)
    return (
        f'<body name="guide" mocap="true" {at}/>',
        f'<body name="floor" {at}><freejoint/>{box} mass="{mass}" {held}/></body>',
        f'<equality><weld body1="guide" body2="floor" {reference}/></equality>',
    )


def _body(scene: Scene, number: int, s: MujocoSettings, held: str) -> str:
    """Return a body, and what it touches others with, or is touched on."""
    body, (x, z) = scene.bodies[number], scene.bodies[number].home
    shapes = {}
    if s.geometry == "corners":
        radius = s.corner_radius * scene.system.width
        for order, each in enumerate(scene.layout.contacts):
            if each.body == number:
                at = corner_spheres(body, radius, planar=s.planar, face=each.face)
                for name, centre in zip(_corners(order, s), at, strict=True):
                    shapes[name] = f'type="sphere" size="{radius}" pos="{_row(centre)}"'
    if s.geometry == "hull":
        shapes[_named("hull", number)] = f'type="mesh" mesh="{_named("hull", number)}"'
    elif s.geometry == "box" or scene.layout.rests(number):
        shapes[_named("box", number)] = f'type="box" size="{_row(half_size(body))}"'
    geoms = "".join(f'<geom name="{name}" {shape} {held}/>' for name, shape in shapes.items())
    heavy = f'pos="{body.offset or 0} 0 0" mass="{body.mass}"'
    inertial = f'<inertial {heavy} diaginertia="{_row(body.inertia)}"/>'
    joints = PLANAR_JOINTS if s.planar else "<freejoint/>"
    return f'<body pos="{x} 0 {z}">{joints}{inertial}{geoms}</body>'


def _pairs(scene: Scene, s: MujocoSettings) -> Iterator[str]:
    """Yield what touches what: the corners of each contact, those at -x first."""
    shape = "hull" if s.geometry == "hull" else "box"
    for order, each in enumerate(scene.layout.contacts):
        on = "base" if each.on == BASE else _named(shape, each.on)
        whole = [_named(shape, each.body)]
        for name in _corners(order, s) if s.geometry == "corners" else whole:
            yield f'geom1="{on}" geom2="{name}"'


def _corners(order: int, s: MujocoSettings) -> list[str]:
    count = 2 if s.planar else 4
    return [f"corner{order * count + number}" for number in range(count)]


def _named(shape: str, number: int) -> str:
    return f"{shape}{number or ''}"


def _row(numbers: tuple[float, ...] | list[float]) -> str:
    return " ".join(map(repr, numbers))


class MujocoWorld:
    """Bodies on a plane or, where the base moves, a box that is welded or has its velocity."""

    def __init__(self, scene: Scene, settings: MujocoSettings, dt_s: float) -> None:
        self.settings = s = settings.fitted(scene)
        self._mj, self._scene = import_module("mujoco"), scene
        self.moment = Moment.END if s.integrator == "RK4" else Moment.MIDDLE
        self.xml = model_xml(scene, s, dt_s)
        self.model = self._mj.MjModel.from_xml_string(self.xml)
        self._data = self._mj.MjData(self.model)
        self._fault = self._read_back(dt_s)
        self._set_out()
        self.held = begin_contact(scene, s, dt_s, self.model.npair)
        self.arrays = self._arrays_of()
        self.drive: Any = None
        if scene.compiled:
            from engines.mujoco.loop import drive, memory_of, usable

            if usable():
                memory, holds = memory_of(self.model, self._data), records([self.held])
                self.held = holds[0]
                self.drive = partial(compiled(drive), holds, self.arrays, memory)
        # the library would write its warnings to a file; they are counted and read from `fault`
        self._mj.set_mju_user_warning(lambda message: None)

    def _set_out(self) -> None:
        places: list[float] = []
        velocities: list[float] = []
        for body in self._scene.bodies:
            at, half, (x, z) = body.at, 0.5 * body.at.theta, body.home
            if self.settings.planar:
                places += (at.x - x, at.z - z, at.theta)
                velocities += (at.velocity_x, at.velocity_z, at.rate)
            else:
                places += (at.x, 0.0, at.z, math.cos(half), 0.0, math.sin(half), 0.0)
                velocities += (at.velocity_x, 0.0, at.velocity_z, 0.0, at.rate, 0.0)
        if not self._scene.begins_at_rest:
            self._data.qpos[: len(places)] = places
            self._data.qvel[: len(velocities)] = velocities

    def step(self, step: Step) -> None:
        """Advance by a step."""
        data, held, arrays = self._data, self.held, self.arrays
        contact.prepare(held, arrays, step)
        self.model.opt.timestep = step.dt_s
        self._mj.mj_step(self.model, data)
        forces = contact.Forces(data.ncon, data.nefc, data.efc_R, data.efc_force)
        contact.notice(held, arrays, forces, step)

    @property
    def base_x_m(self) -> float:
        """Where a base that moves is; see `engines.world.World`."""
        return float(self.held.moved)

    @property
    def lag_m(self) -> float | None:
        """How far a welded base was from where it should have been; see `engines.world.World`."""
        return float(self.held.lag) if self.held.welded else None

    @property
    def yaw(self) -> float | None:
        """How far the first body has turned; see `engines.world.World`."""
        return None if self.settings.planar else yaw_of(*self._data.qpos[3:7])

    def state(self) -> FloatArray:
        """Read the bodies' poses back."""
        contact.read(self.held, self.arrays)
        return self.arrays.state

    def fault(self) -> str:
        """Say which setting was not taken, or what the engine warned of."""
        if self._fault:
            return self._fault
        # all at once: to ask each kind by itself takes as long as fifty steps
        warned = self._data.warning.number.nonzero()[0]
        if warned.size:
            kind = list(self._mj.mjtWarning.__members__)[warned[0]]
            return f"MuJoCo warned: {kind.removeprefix('mjWARN_')}"
        return disagreement({"time": (self.held.time, self._data.time)})

    def close(self) -> None:
        """Give warnings back to the library."""
        self._mj.set_mju_user_warning(None)

    def _read_back(self, dt_s: float) -> str:
        s, model, scene = self.settings, self.model, self._scene
        pairs: dict[str, tuple[Any, Any]] = {
            "timestep": (dt_s, model.opt.timestep),
            "friction": (s.friction, model.geom_friction[-1, 0]),
        }
        for number, body in enumerate(scene.bodies, 1 + (scene.frame == "world")):
            pairs[f"mass {number}"] = (body.mass, model.body_mass[number])
            pairs[f"offset {number}"] = (body.offset, model.body_ipos[number, 0])
            found = model.body_inertia[number]
            pairs |= {f"inertia {number} {i}": (body.inertia[i], found[i]) for i in range(3)}
        pairs |= {name: self._read_option(name) for name in OPTIONS}
        exact = model.opt.enableflags & int(self._mj.mjtEnableBit.mjENBL_DIAGEXACT)
        pairs["diagexact"] = (s.diagexact, bool(exact))
        for i, value in enumerate(s.direct(dt_s)):
            pairs[f"solref {i}"] = (value, model.geom_solref[-1, i])
        found = model.pair_solimp if model.npair else model.geom_solimp
        for i, value in enumerate(s.solimp(scene, dt_s)):
            pairs[f"impedance {i}"] = (value, found[0, i])
        if model.npair:
            pairs["friction of the pair"] = (s.friction, model.pair_friction[0, 0])
        return disagreement(pairs)

    def _read_option(self, name: str) -> tuple[Any, Any]:
        """Return a wanted option as the library numbers it, and the option as it is."""
        wanted, found = getattr(self.settings, name), getattr(self.model.opt, name)
        if wanted is None or not OPTIONS[name]:
            return wanted, found
        kind = getattr(self._mj, f"mjt{name.capitalize()}")
        return int(kind.__members__[OPTIONS[name] + wanted.upper()]), int(found)

    def _arrays_of(self) -> contact.Arrays:
        """Return the library's arrays, and what is known of each pair, in the library's order."""
        held, model, data, scene = self.held, self.model, self._data, self._scene
        rows, yields = [], (1.0 - held.impedance) * scene.system.gravity
        for each in scene.layout.contacts if held.pairs else ():
            weight = scene.layout.carried(each) * scene.system.gravity / held.corners
            for side in (0.0,) if held.single else (1.0, -1.0):
                row = (side, each.face * side, *each, weight, yields, 0.5 * yields)
                rows += [row] * (1 if held.single else int(held.corners))
        homes = np.array([(*body.home, 0.5 * body.height) for body in scene.bodies])
        return contact.Arrays(
            data.qpos,
            data.qvel,
            model.opt.gravity,
            model.pair_solref,
            model.pair_solreffriction,
            model.pair_margin,
            model.geom_surfacevel,
            data.mocap_pos,
            np.array(rows).reshape(-1, 8),
            homes,
            np.zeros((len(homes), len(Pose._fields))),
        )


def begin_contact(scene: Scene, s: MujocoSettings, dt_s: float, pairs: int) -> contact.ContactState:
    """Return what holds the bodies of a scene, of which so many pairs touch, in ordinary steps."""
    block, touching = scene.system, len(scene.layout.contacts)
    impedance = 1.0 if s.impedance is None else s.impedance[1]
    sliding = 1.0 if s.sliding_damping is None else s.sliding_damping
    return contact.ContactState(
        planar=s.planar,
        moving=scene.frame == "world",
        level=-scene.bodies[0].height,
        base_velocity=s.floor == "surfacevel",
        welded=scene.frame == "world" and s.floor == "weld",
        single=s.geometry != "corners",
        stacked=scene.stacked,
        by_phase=s.by_phase,
        reflects=s.reflection,
        preload=s.preload,
        width=block.width,
        height=0.5 * block.height,
        damping=s.damping or 0.0,
        sliding_damping=sliding,
        sliding=sliding,
        stiffness=s.stiffness or 0.0,
        impedance=impedance,
        carry=(s.carry or 0.0) * block.width,
        touching=touching,
        pairs=pairs,
        corners=max(pairs // touching // 2, 1),
        ordinary_squared=dt_s**2,
        impedance_squared=impedance**2,
        growth=1.0 + contact.MOST_GROWTH * block.p * dt_s,
        steady=1.0 + contact.RELEASED_GROWTH * block.p * dt_s,
        released=bool(scene.side),
        rate=scene.bodies[0].at.rate,
    )


MODEL, SAID = "block.xml", ("<option", "<default", "<geom", "<pair", "<weld")
"""File of a script's model, beside it, and elements of it that a preset sets."""


def script(scene: Scene, settings: MujocoSettings, dt_s: float) -> Script:
    """Return a scene as a model of MuJoCo; see `engines.world.Script`."""
    world = MujocoWorld(replace(scene, compiled=False), settings, dt_s)
    s, root, welded = world.settings, ElementTree.fromstring(world.xml), world.held.welded
    ElementTree.indent(root)
    model = ElementTree.tostring(root, encoding="unicode") + "\n"
    model = re.sub(r"(<default>)\s+(<.*>)\s+(</default>)", r"\1\2\3", model)  # a line to paste
    build = [f'model = mujoco.MjModel.from_xml_path(str(HERE / "{MODEL}"))']
    build.append("data = mujoco.MjData(model)")
    if not scene.begins_at_rest:
        build.append(f"data.qpos[:] = {world.arrays.position.tolist()}")
        build.append(f"data.qvel[:] = {world.arrays.velocity.tolist()}")
    world.close()
    step = ["model.opt.gravity[:] = pull_x, 0.0, pull_z", "mujoco.mj_step(model, data)"]
    if scene.frame == "world":
        # a base without a body of its own is moved after the step
        step.insert(0 if welded else 2, "data.mocap_pos[0, 0] = base_x")
        if scene.heaves:
            step.insert(0, f"data.mocap_pos[0, 2] = {world.held.level!r} + base_z")
        if s.floor == "surfacevel":
            step.insert(0, "model.geom_surfacevel[0, 0] = base_velocity")
    if s.planar:
        pose = ["theta, rate = data.qpos[3 * number + 2], data.qvel[3 * number + 2]"]
    else:
        half = "math.atan2(data.qpos[7 * number + 5], data.qpos[7 * number + 3])"
        pose = [f"theta = 2.0 * {half}", "rate = data.qvel[6 * number + 4]"]
    # the joint of a welded base is the last, a free one
    under = f" - {'data.qpos[-7]' if welded else 'base_x'}" * (scene.frame == "world")
    lines = map(str.strip, model.splitlines())
    return Script(
        imports=("import mujoco",),
        settings=tuple(dict.fromkeys(line for line in lines if line.startswith(SAID))),
        build=tuple(build),
        step=tuple(step),
        pose=tuple(pose),
        place=f"data.qpos[0]{under}",
        moment=world.moment,
        files={MODEL: model},
    )
