"""A scene in MuJoCo's own language."""

import math
from collections.abc import Iterator
from xml.etree import ElementTree

from engines.mujoco.settings import MujocoSettings
from engines.parts import corner_spheres, floor_half_size, half_size, hull_points
from engines.parts.compiled import shared
from engines.scene import BASE, Scene

OPTIONS = (
    "cone",
    "solver",
    "jacobian",
    "tolerance",
    "iterations",
    "impratio",
    "integrator",
    "noslip_iterations",
)
"""Settings that are options of the model under their own names."""

PLANAR_JOINTS = (
    '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>'
    '<joint type="hinge" axis="0 1 0"/>'
)


FLOOR_MASSES = 1000.0
"""Mass of a welded base over that of the bodies on it. From ten on it hardly matters; but the
library's own for so large a box, 240000 at equal densities, is where its solver ends too early."""


def model_xml(scene: Scene, s: MujocoSettings, dt_s: float) -> str:
    """Return the model of a scene in MuJoCo's own language, for ordinary steps of dt_s [s].

    The step, and the references of contacts that go by it, are not in it: a run sets them.

    Parameters
    ----------
    scene : Scene, whose bodies stand here upright at rest, wherever they begin
    s : MujocoSettings
    dt_s : float, ordinary step [s], from which the depth of a soft surface follows
    """
    margin = (s.margin or 0.0) * scene.system.width
    named = ((name, getattr(s, name)) for name in OPTIONS)
    options = " ".join(f'{name}="{value}"' for name, value in named if value is not None)
    exact = "" if s.diagexact is None else _flag("diagexact", on=s.diagexact)
    common = f'{_friction(s)} margin="{margin}"'
    bodies = "".join(_body(scene, number, s, common) for number in range(len(scene.bodies)))
    floor, weld = _floor(scene, s) if welded(scene, s) else ("", "")
    contact = f' margin="{margin}" solimp="{_row(impedance_of(scene, s, dt_s) or ())}" '
    pairs = "" if s.impedance is None else "".join(_pairs(scene, s, contact))
    return (
        f"<mujoco><option {options}>{exact}</option>{_assets(scene, s)}"
        f"<worldbody>{_base(scene, s)}{bodies}"
        f"{floor}</worldbody><contact>{pairs}</contact>{weld}</mujoco>"
    )


def _flag(name: str, *, on: bool) -> str:
    return f'<flag {name}="{"enable" if on else "disable"}"/>'


def _body(scene: Scene, number: int, s: MujocoSettings, common: str) -> str:
    body = scene.bodies[number]
    (x, z), joints = body.home, PLANAR_JOINTS if s.planar else "<freejoint/>"
    shapes = _geoms(scene, number, s).items()
    geoms = "".join(f'<geom name="{name}" {shape} {common}/>' for name, shape in shapes)
    return (
        f'<body pos="{x} 0 {z}">{joints}'
        f'<inertial pos="0 0 0" mass="{body.mass}" diaginertia="{_row(body.inertia)}"/>'
        f"{geoms}</body>"
    )


def _assets(scene: Scene, s: MujocoSettings) -> str:
    if s.geometry != "hull":
        return ""
    meshes = (
        f'<mesh name="{named("hull", number)}" vertex="{" ".join(map(_row, hull_points(body)))}"/>'
        for number, body in enumerate(scene.bodies)
    )
    return f"<asset>{''.join(meshes)}</asset>"


def named(shape: str, number: int) -> str:
    """Return the name of a body's shape; the first body's is the shape's."""
    return f"{shape}{number or ''}"


def _base(scene: Scene, s: MujocoSettings) -> str:
    if scene.frame != "world":
        return f'<geom name="base" type="plane" size="1 1 1" {_friction(s)}/>'
    place = f'pos="0 0 {-scene.bodies[0].height}"'
    if welded(scene, s):
        return f'<body name="guide" mocap="true" {place}/>'
    # a plane may not move, so a box does; any surface velocity will do to switch it on
    return (
        f'<body mocap="true" {place}><geom name="base" type="box" '
        f'size="{_row(floor_half_size(scene))}" surfacevel="{int(s.floor == "surfacevel")} 0 0" '
        f"{_friction(s)}/></body>"
    )


def welded(scene: Scene, s: MujocoSettings) -> bool:
    """Return whether the base is a body of its own, welded to the one that is moved.

    Parameters
    ----------
    scene, s
        As for `model_xml`.
    """
    return scene.frame == "world" and s.floor == "weld"


def _floor(scene: Scene, s: MujocoSettings) -> tuple[str, str]:
    """Return such a base, whose joint comes after those of the bodies, and its weld."""
    mass = FLOOR_MASSES * sum(body.mass for body in scene.bodies)
    return (
        f'<body name="floor" pos="0 0 {-scene.bodies[0].height}"><freejoint/><geom name="base" '
        f'type="box" size="{_row(floor_half_size(scene))}" mass="{mass}" {_friction(s)}/></body>',
        '<equality><weld body1="guide" body2="floor"/></equality>',
    )


def _geoms(scene: Scene, number: int, s: MujocoSettings) -> dict[str, str]:
    """Name and shape of what a body touches others with, or is touched on."""
    body = scene.bodies[number]
    if s.geometry == "hull":
        name = named("hull", number)
        return {name: f'type="mesh" mesh="{name}"'}
    box = {named("box", number): f'type="box" size="{_row(half_size(body))}"'}
    if s.geometry == "box":
        return box
    radius = s.corner_radius * scene.system.width
    shape = f'type="sphere" size="{radius}"'
    geoms: dict[str, str] = {}
    for order, contact in enumerate(scene.layout.contacts):
        if contact.body == number:
            corners = corner_spheres(body, radius, planar=s.planar, face=contact.face)
            names = corner_names(order, s)
            geoms |= {
                name: f'{shape} pos="{_row(at)}"' for name, at in zip(names, corners, strict=True)
            }
    return geoms | box if scene.layout.rests(number) else geoms


def corner_names(order: int, s: MujocoSettings) -> list[str]:
    """Return the names of the spheres of a contact, by its place in the layout."""
    count = 2 if s.planar else 4
    return [f"corner{order * count + number}" for number in range(count)]


def surface_name(body: int, s: MujocoSettings) -> str:
    """Return the name of what corners touch: the base, or a body's face."""
    return "base" if body == BASE else named("hull" if s.geometry == "hull" else "box", body)


def impedance_of(scene: Scene, s: MujocoSettings, dt_s: float) -> tuple[float, ...] | None:
    """Return the five numbers of solimp, the width [m] of the soft surface among them.

    Parameters
    ----------
    scene, s, dt_s
        As for `model_xml`.

    Returns
    -------
    tuple (5,) or None
        Impedances at the surface and at the width, the width [m], midpoint and power; None leaves
        all to the library.
    """
    if s.impedance is None or s.soft_surface is None:
        return s.impedance
    surface, whole, _, *curve = s.impedance
    return surface, whole, s.soft_surface * scene.system.gravity * dt_s**2, *curve


def _friction(s: MujocoSettings) -> str:
    return f'friction="{s.friction} 0.005 0.0001"'


def _pairs(scene: Scene, s: MujocoSettings, contact: str) -> Iterator[str]:
    """Yield what touches what: the corners of each contact, those at -x first."""
    friction = _row((s.friction, s.friction, 0.005, 0.0001, 0.0001))
    # any direct form will do for now: it is set with the first step
    reference = "" if s.damping is None else 'solref="-1 -1" solreffriction="-1 -1"'
    for order, touching in enumerate(scene.layout.contacts):
        boxes = [surface_name(touching.body, s)]
        for name in corner_names(order, s) if s.geometry == "corners" else boxes:
            yield (
                f'<pair geom1="{surface_name(touching.on, s)}" geom2="{name}" condim="3" '
                f'friction="{friction}"{contact}{reference}/>'
            )


def coordinates(scene: Scene, s: MujocoSettings) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return the positions and the velocities from which the bodies set out.

    Parameters
    ----------
    scene, s
        As for `model_xml`.

    Returns
    -------
    places, velocities : tuple of float (nq,), (nv,)
        qpos and qvel; see `engines.mujoco.contact_state.Arrays`.
    """
    places: list[float] = []
    velocities: list[float] = []
    for body in scene.bodies:
        at, half, (x, z) = body.at, 0.5 * body.at.theta, body.home
        if s.planar:
            places += (at.x - x, at.z - z, at.theta)
            velocities += (at.velocity_x, at.velocity_z, at.rate)
        else:
            places += (at.x, 0.0, at.z, math.cos(half), 0.0, math.sin(half), 0.0)
            velocities += (at.velocity_x, 0.0, at.velocity_z, 0.0, at.rate, 0.0)
    if welded(scene, s):
        places += (0.0, 0.0, -scene.bodies[0].height, 1.0, 0.0, 0.0, 0.0)
        velocities += 6 * (0.0,)
    return tuple(places), tuple(velocities)


@shared
def direct_reference(
    impedance: float, dt_s: float, stiffness: float, damping: float
) -> tuple[float, float]:
    """Return the two numbers of a direct reference with k dt^2 and b dt, at a step dt_s [s].

    The library divides both by the impedance, the first one twice (MuJoCo's modeling.rst, "Solver
    parameters").

    Parameters
    ----------
    impedance : float, in (0, 1]
    dt_s : float, the step [s]
    stiffness, damping : float, k dt^2 and b dt, without units

    Returns
    -------
    (float, float)
        A pair's solref: minus a stiffness [1/s2] and minus a damping [1/s].
    """
    unit = impedance / dt_s
    return -stiffness * (unit * unit), -unit * damping


def stepped_xml(scene: Scene, s: MujocoSettings, dt_s: float) -> str:
    """Return the model of a scene with what the adapter sets at a step dt_s [s], a line each.

    Parameters
    ----------
    scene, s
        As for `model_xml`.
    dt_s : float, the step [s], of which all are
    """
    root = ElementTree.fromstring(model_xml(scene, s, dt_s))
    option = root.find("option")
    if option is not None:
        option.set("timestep", repr(dt_s))
    if s.solref is not None:
        for item in (*root.iter("geom"), *root.iter("pair")):
            item.set("solref", _row((s.solref[0] * dt_s, s.solref[1])))
    for pair in root.iter("pair") if s.damping is not None else ():
        held = (1.0 if s.impedance is None else s.impedance[1], dt_s, s.stiffness or 0.0)
        pair.set("solref", _row(direct_reference(*held, s.damping or 0.0)))
        pair.set("solreffriction", _row(direct_reference(*held, s.sliding_damping or 0.0)))
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"


def _row(numbers: tuple[float, ...]) -> str:
    return " ".join(map(repr, numbers))
