"""A scene in MuJoCo's own language."""

import math
from xml.etree import ElementTree

from engines.mujoco.settings import MujocoSettings
from engines.parts.compiled import shared
from engines.parts.shapes import corner_spheres, floor_half_size, half_size, hull_points
from engines.scene import Scene

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


def model_xml(scene: Scene, s: MujocoSettings) -> str:
    """Return the model of a scene in MuJoCo's own language."""
    block, margin = scene.block, (s.margin or 0.0) * scene.block.width
    named = ((name, getattr(s, name)) for name in OPTIONS)
    options = " ".join(f'{name}="{value}"' for name, value in named if value is not None)
    geoms = _geoms(scene, s)
    common = f'{_friction(s)} margin="{margin}"'
    parts = (f'<geom name="{name}" {shape} {common}/>' for name, shape in geoms.items())
    pairs = "" if s.impedance is None else "".join(_pair(name, s, margin) for name in geoms)
    return (
        f"<mujoco><option {options}/>{_assets(scene, s)}<worldbody>{_base(scene, s)}"
        f'<body pos="0 0 {0.5 * block.height}">{PLANAR_JOINTS if s.planar else "<freejoint/>"}'
        f'<inertial pos="0 0 0" mass="{scene.mass}" diaginertia="{_row(scene.inertia)}"/>'
        f"{''.join(parts)}</body></worldbody><contact>{pairs}</contact></mujoco>"
    )


def _assets(scene: Scene, s: MujocoSettings) -> str:
    if s.geometry != "hull":
        return ""
    vertices = " ".join(map(_row, hull_points(scene)))
    return f'<asset><mesh name="hull" vertex="{vertices}"/></asset>'


def _base(scene: Scene, s: MujocoSettings) -> str:
    if scene.frame == "base":
        return f'<geom name="base" type="plane" size="1 1 1" {_friction(s)}/>'
    # a plane may not move, so a box does; any surface velocity will do to switch it on
    return (
        f'<body mocap="true" pos="0 0 {-scene.block.height}"><geom name="base" type="box" '
        f'size="{_row(floor_half_size(scene))}" surfacevel="{int(s.base_velocity)} 0 0" '
        f"{_friction(s)}/></body>"
    )


def _geoms(scene: Scene, s: MujocoSettings) -> dict[str, str]:
    """Name and shape of what the block touches its base with."""
    if s.geometry == "hull":
        return {"hull": 'type="mesh" mesh="hull"'}
    if s.geometry == "box":
        return {"box": f'type="box" size="{_row(half_size(scene))}"'}
    radius = s.corner_radius * scene.block.width
    corners = corner_spheres(scene, radius, planar=s.planar)
    shape = f'type="sphere" size="{radius}"'
    return {f"corner{i}": f'{shape} pos="{_row(at)}"' for i, at in enumerate(corners)}


def _friction(s: MujocoSettings) -> str:
    return f'friction="{s.friction} 0.005 0.0001"'


def _pair(name: str, s: MujocoSettings, margin: float) -> str:
    friction = _row((s.friction, s.friction, 0.005, 0.0001, 0.0001))
    # any direct form will do for now: it is set with the first step
    reference = "" if s.damping is None else 'solref="-1 -1" solreffriction="-1 -1"'
    return (
        f'<pair geom1="base" geom2="{name}" condim="3" friction="{friction}" margin="{margin}" '
        f'solimp="{_row(s.impedance or ())}" {reference}/>'
    )


def coordinates(scene: Scene, s: MujocoSettings) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return the positions and the velocities from which the block sets out."""
    at, half = scene.beginning, 0.5 * scene.beginning.theta
    if s.planar:
        place = (at.x, at.z - 0.5 * scene.block.height, at.theta)
        return place, (at.velocity_x, at.velocity_z, at.rate)
    turned = (math.cos(half), 0.0, math.sin(half), 0.0)
    velocity = (at.velocity_x, 0.0, at.velocity_z, 0.0, at.rate, 0.0)
    return (at.x, 0.0, at.z, *turned), velocity


@shared
def direct_reference(
    impedance: float, dt_s: float, stiffness: float, damping: float
) -> tuple[float, float]:
    """Return the two numbers of a direct reference with k dt^2 and b dt, at a step dt_s [s].

    The library divides both by the impedance, the first one twice.
    """
    unit = impedance / dt_s
    return -stiffness * (unit * unit), -unit * damping


def stepped_xml(scene: Scene, s: MujocoSettings, dt_s: float) -> str:
    """Return the model of a scene with what the adapter sets at a step dt_s [s], a line each."""
    root = ElementTree.fromstring(model_xml(scene, s))
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
