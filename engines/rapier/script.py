"""A scene in Rapier's own words, for a script that needs the library alone."""

from engines.parts.script import Script
from engines.parts.shapes import corner_spheres, half_size
from engines.parts.units import counted
from engines.rapier.settings import RapierSettings, parameters
from engines.scene import Scene


def script(scene: Scene, s: RapierSettings, dt_s: float) -> Script:
    """Return a scene on a base at rest as calls of Rapier; see `engines.parts.script`."""
    rough = f".friction({float(s.friction)!r})"
    set_ = _parameters(scene, s, dt_s)
    locks, shape = _locks(s), _touching(scene, s)
    unit, sunk = s.unit_of(scene), s.sunk_of(scene)
    x, y, z = counted(s.base_half_size(scene), unit)
    times = "" if unit == 1.0 else f" * {unit!r}"
    lowered = f".translation({(0.0, 0.0, -sunk)})" if sunk else ""
    return Script(
        imports=("import rapier3d as rapier",),
        settings=(f"parameters.dt = {dt_s!r}", *set_, *locks, *shape, rough),
        build=(
            "world = rapier.PhysicsWorld()",
            "parameters = world.integration_parameters",
            "parameters.dt = DT",
            *set_,
            "",
            "",
            "def added(body, colliders):",
            f"    rough = [collider{rough} for collider in colliders]  # the mean counts",
            "    return world.rigid_bodies[world.add_body(body, rough)]",
            "",
            "",
            f"base = rapier.RigidBody.kinematic_velocity_based(){lowered}",
            f"floor = rapier.Collider.cuboid({x!r}, {y!r}, {z!r}).translation({(0.0, 0.0, -z)})",
            "base = added(base, [floor])",
            *_beginning(scene, unit, sunk),
            *locks,
            *shape,
            "block = added(body, shapes)",
            "block.recompute_mass_properties_from_colliders(world.colliders)",
        ),
        step=(f"world.gravity = pull_x{times}, 0.0, pull_z{times}", "world.step()"),
        pose=(
            "turn = block.rotation",
            "theta, rate = 2.0 * math.atan2(turn.j, turn.w), block.angvel.y",
        ),
    )


def _parameters(scene: Scene, s: RapierSettings, dt_s: float) -> tuple[str, ...]:
    given = parameters(s, scene)
    lines = [f"parameters.{name} = {_value(value)}" for name, value in given.items()]
    if spring := s.spring_of(dt_s):
        lines += [
            f"spring = rapier.SpringCoefficients{spring!r}",
            "parameters.contact_softness = parameters.static_contact_softness = spring",
        ]
    return tuple(lines)


def _value(value: object) -> str:
    return f"rapier.FrictionModel.{value}" if isinstance(value, str) else repr(value)


def _beginning(scene: Scene, unit: float, sunk: float) -> tuple[str, ...]:
    """Return lines that make a body where and as fast as the block sets out."""
    at = scene.beginning
    place = at.x * unit, 0.0, at.z * unit - sunk
    lines = (
        f"body = rapier.RigidBody.dynamic().translation({place})",
        f"body = body.rotation({(0.0, at.theta, 0.0)}).angvel({(0.0, at.rate, 0.0)})",
        f"body = body.linvel({(at.velocity_x * unit, 0.0, at.velocity_z * unit)})",
    )
    return lines[:1] if at.at_rest else lines


def _locks(s: RapierSettings) -> tuple[str, ...]:
    lines: list[str] = []
    if s.planar:
        free = (True, not s.locked_aside, True)
        lines += [
            "body = body.enabled_rotations((False, True, False))",
            f"body = body.enabled_translations({free})",
        ]
    if s.sleeping is not None:
        lines += [f"body = body.can_sleep({s.sleeping})"]
    return tuple(lines)


def _touching(scene: Scene, s: RapierSettings) -> tuple[str, ...]:
    """Return lines that give the block its mass, and what touches the base."""
    unit = s.unit_of(scene)
    if s.geometry == "box":
        size = ", ".join(map(repr, counted(half_size(scene), unit)))
        dense = f".density({scene.density / unit**3!r})"
        return (f"shapes = [rapier.Collider.cuboid({size}){dense}]",)
    radius = s.corner_radius * scene.block.height
    places = [counted(at, unit) for at in corner_spheres(scene, radius, planar=s.planar)]
    return (
        f"ball = rapier.Collider.ball({radius * unit!r}).density(0.0)",
        f"shapes = [ball.translation(at) for at in {places}]",
        f"inertia = {tuple(moment * unit**2 for moment in scene.inertia)}",
        f"mass = rapier.MassProperties((0.0, 0.0, 0.0), {scene.mass!r}, inertia)",
        "body = body.additional_mass_properties(mass)",
    )
