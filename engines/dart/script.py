"""A scene in DART's own words, for a script that needs the library alone."""

from engines.dart.settings import IN_PLANE, IN_SPACE, SOLVERS, DartSettings
from engines.parts.script import Script
from engines.parts.shapes import Point, corner_spheres, floor_half_size, half_size
from engines.scene import Scene

SHAPED = (
    "def touching(body, shape, at):",
    "    node = body.createShapeNode(shape)",
    "    node.createCollisionAspect()",
    "    {rough}  # the smaller one counts",
    "    node.setRelativeTranslation(at)",
)


def script(scene: Scene, s: DartSettings, dt_s: float) -> Script:
    """Return a scene on a base at rest as calls of DART; see `engines.parts.script`."""
    unit, theta = s.unit, (IN_PLANE if s.planar else IN_SPACE)[2]
    rough = f"node.createDynamicsAspect().setFrictionCoeff({float(s.friction)!r})"
    world, base, joint = _world(s), _base(s), _joint(s)
    inertia = _inertia(scene, s)
    shapes = _touching(scene, s)
    return Script(
        imports=("import dartpy as dart",),
        settings=(
            f"world.setTimeStep({dt_s!r})",
            *world,
            *base,
            *joint,
            *inertia,
            *shapes,
            rough,
        ),
        build=(
            "",
            *(line.format(rough=rough) for line in SHAPED),
            "",
            "",
            "world = dart.simulation.World()",
            "world.setTimeStep(DT)",
            *world,
            'base = dart.dynamics.Skeleton("base")',
            *base,
            _ground(scene, unit),
            "world.addSkeleton(base)",
            'skeleton = dart.dynamics.Skeleton("block")',
            *joint,
            *inertia,
            *shapes,
            *_beginning(scene, s),
            "world.addSkeleton(skeleton)",
        ),
        step=(
            f"world.setGravity((pull_x * {unit!r}, 0.0, pull_z * {unit!r}))",
            "world.step(False)",
        ),
        pose=(f"theta, rate = joint.getPosition({theta}), joint.getVelocity({theta})",),
    )


def _world(s: DartSettings) -> tuple[str, ...]:
    lines: list[str] = []
    if s.collision is not None:
        kind = f"dart.simulation.CollisionDetectorType.{s.collision}"
        lines += [f"world.setCollisionDetector({kind})"]
    if s.sleeping is not None:
        lines += [
            "options = world.getDeactivationOptions()",
            f"options.mEnabled = {s.sleeping}",
            "world.setDeactivationOptions(options)",
        ]
    if s.solver is not None:
        kind = f"dart.constraint.{SOLVERS[s.solver]}()"
        lines += [f"world.getConstraintSolver().setBoxedLcpSolver({kind})"]
    if s.split_impulse is not None:
        lines += [f"world.getConstraintSolver().setSplitImpulseEnabled({s.split_impulse})"]
    return tuple(lines)


def _base(s: DartSettings) -> tuple[str, ...]:
    lines = (
        "drive, floor = base.createTranslationalJointAndBodyNodePair()",
        "drive.setActuatorType(dart.dynamics.ActuatorType.VELOCITY)",
    )
    if not s.aside:
        return lines
    return (
        *lines,
        "aside, floor = base.createPrismaticJointAndBodyNodePair(floor)  # free out of the plane",
        "aside.setAxis((0.0, 1.0, 0.0))",
    )


def _joint(s: DartSettings) -> tuple[str, ...]:
    if s.planar:
        return (
            "joint, block = skeleton.createPlanarJointAndBodyNodePair()",
            "joint.setZXPlane()",
        )
    return ("joint, block = skeleton.createFreeJointAndBodyNodePair()",)


def _inertia(scene: Scene, s: DartSettings) -> tuple[str, ...]:
    mass = f"block.setMass({scene.mass!r})"
    if not s.exact_inertia:
        return (mass,)
    moments = ", ".join(repr(s.unit * s.unit * moment) for moment in scene.inertia)
    return (mass, f"block.setMomentOfInertia({moments})")


def _ground(scene: Scene, unit: float) -> str:
    x, y, z = (2.0 * size * unit for size in floor_half_size(scene))
    return f"touching(floor, dart.dynamics.BoxShape({(x, y, z)}), {(0.0, 0.0, -0.5 * z)})"


def _touching(scene: Scene, s: DartSettings) -> tuple[str, ...]:
    """Return lines that give the block what touches the base."""
    if s.geometry == "box":
        size = [2.0 * s.unit * half for half in half_size(scene)]
        return (f"touching(block, dart.dynamics.BoxShape({size}), (0.0, 0.0, 0.0))",)
    radius = s.corner_radius * scene.block.width
    places = corner_spheres(scene, radius, planar=s.planar)
    return (
        f"ball = dart.dynamics.SphereShape({radius * s.unit!r})",
        *(f"touching(block, ball, {_scaled(at, s.unit)})" for at in places),
    )


def _scaled(at: Point, unit: float) -> Point:
    x, y, z = at
    return (x * unit, y * unit, z * unit)


def _beginning(scene: Scene, s: DartSettings) -> tuple[str, ...]:
    """Return lines that put the block where it sets out."""
    at, unit = scene.beginning, s.unit
    numbers = IN_PLANE if s.planar else IN_SPACE
    places = (at.x * unit, at.z * unit, at.theta)
    speeds = (at.velocity_x * unit, at.velocity_z * unit, at.rate)
    return (
        f"for number, place, speed in zip({numbers}, {places}, {speeds}):",
        "    joint.setPosition(number, place)",
        "    joint.setVelocity(number, speed)",
    )
