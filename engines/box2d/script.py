"""A scene in Box2D's own words, for a script that needs the library alone."""

from engines.box2d.settings import Box2DSettings
from engines.parts.script import Script
from engines.parts.shapes import FLOOR_HEIGHTS
from engines.scene import Scene


def script(scene: Scene, s: Box2DSettings, dt_s: float) -> Script:
    """Return a scene on a base at rest as calls of Box2D; see `engines.parts.script`."""
    unit, reach, paired = s.unit_of(scene), s.reach_of(scene, dt_s), s.geometry == "corners"
    world = (
        "world = Box2D.b2World(gravity=(0.0, 0.0))",
        f"world.continuousPhysics = {s.continuous}",
    )
    shape = _corner(scene, unit, reach) if paired else _box(scene, unit)
    rough, take = f"friction={float(s.friction)!r}", _take(scene, s)
    block_meets = ", filter=Box2D.b2Filter(categoryBits=1 << n, maskBits=4 << n)" if paired else ""
    floor_meets = ", filter=Box2D.b2Filter(categoryBits=4 << n, maskBits=1 << n)" if paired else ""
    return Script(
        imports=("import Box2D",),
        settings=(f"world.Step({dt_s!r}, {take})", *world, shape, rough, *_floor(scene, s, unit)),
        build=(
            *world,
            *_beginning(scene, s),
            f"for n, side in enumerate({(-1.0, 1.0) if paired else (0.0,)}):",
            f"    {shape}",
            f"    block.CreateFixture(shape=shape, {rough}, restitution=0.0{block_meets})",
            f"inertia = {scene.inertia[1] * unit**2!r}",
            f"block.massData = Box2D.b2MassData(mass={scene.mass!r}, center=(0, 0), I=inertia)",
            *_velocity(scene, unit),
            *_floor(scene, s, unit),
            f"for n in range({2 if paired else 1}):",
            "    floor = world.CreateKinematicBody(position=(0.0, 0.0))",
            "    ground = Box2D.b2PolygonShape(vertices=corners)",
            f"    floor.CreateFixture(shape=ground, {rough}{floor_meets})",
            f"    floor.position = 0.0, {reach - s.sunk_of(scene)!r}",
        ),
        step=(
            f"world.gravity = pull_x * {unit!r}, pull_z * {unit!r}",
            f"world.Step(DT, {take})",
        ),
        pose=("theta, rate = -block.angle, -block.angularVelocity",),
    )


def _take(scene: Scene, s: Box2DSettings) -> str:
    """Return how often the solver goes through velocities and positions."""
    return f"{s.iterations_of(scene)}, {s.position_iterations}"


def _box(scene: Scene, unit: float) -> str:
    half = 0.5 * scene.block.width * unit, 0.5 * scene.block.height * unit
    return f"shape = Box2D.b2PolygonShape(box={half})"


def _corner(scene: Scene, unit: float, reach: float) -> str:
    x, z = 0.5 * scene.block.width * unit, 0.5 * scene.block.height * unit
    return f"shape = Box2D.b2CircleShape(pos=(side * {x!r}, {-z!r}), radius={reach!r})"


def _beginning(scene: Scene, s: Box2DSettings) -> tuple[str, ...]:
    at, unit = scene.beginning, s.unit_of(scene)
    place = at.x * unit, at.z * unit - s.sunk_of(scene)
    return (
        f"block = world.CreateDynamicBody(position={place}, angle={-at.theta!r})",
        f"block.sleepingAllowed = {s.sleeping}",
    )


def _velocity(scene: Scene, unit: float) -> tuple[str, ...]:
    """Return lines that let the block set out; none where it is at rest."""
    at = scene.beginning
    if at.at_rest:
        return ()
    velocity = at.velocity_x * unit, at.velocity_z * unit
    return (f"block.linearVelocity = {velocity}", f"block.angularVelocity = {-at.rate!r}")


def _floor(scene: Scene, s: Box2DSettings, unit: float) -> tuple[str, ...]:
    """Return lines that say where a floor begins; a polygon acts from its skin on."""
    far = FLOOR_HEIGHTS * scene.block.height * unit
    skins = 1.0 if s.geometry == "corners" else 2.0
    top = f"{-skins!r} * Box2D.b2_polygonRadius" if s.skins_below else "0.0"
    return (
        f"far, top = {far!r}, {top}",
        "corners = [(-far, -far), (far, -far), (far, top), (-far, top)]",
    )
