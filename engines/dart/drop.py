"""A sphere dropped on a box in DART: its coefficient of restitution.

The library lets nothing bounce that comes in at less than 0.1 units of length a second, and nothing
come off at more than 100; no setting changes that, but the unit does.
"""

from functools import partial

from engines.dart.settings import TUNED
from engines.parts.drop import Bouncing, Drop, rebound
from engines.parts.quiet import imported

BETWEEN = 10.0
"""Units of length in a metre by which speeds of 0.01 to 10 m/s bounce."""

WIDTHS = 20.0
"""Width of the floor over the radius."""


def _dropped(drop: Drop, floor: float, unit: float) -> float:
    """Drop a sphere; floor is the box's coefficient, unit the units of length in a metre."""
    dart = imported("dartpy")
    world = dart.simulation.World()
    world.setTimeStep(drop.dt_s)
    world.setGravity((0.0, 0.0, -drop.gravity * unit))
    radius = drop.radius * unit
    width = WIDTHS * radius
    ground, ball = dart.dynamics.Skeleton("ground"), dart.dynamics.Skeleton("ball")
    _, base = ground.createWeldJointAndBodyNodePair()
    joint, body = ball.createFreeJointAndBodyNodePair()
    body.setMass(drop.mass)
    body.setMomentOfInertia(*[0.4 * drop.mass * radius**2] * 3)
    below = base.createShapeNode(dart.dynamics.BoxShape((width, width, width)))
    below.setRelativeTranslation((0.0, 0.0, -0.5 * width))
    sphere = body.createShapeNode(dart.dynamics.SphereShape(radius))
    for node, restitution in ((below, floor), (sphere, drop.restitution)):
        node.createCollisionAspect()
        node.createDynamicsAspect().setRestitutionCoeff(restitution)
    up = 5
    joint.setPosition(up, radius + drop.height * unit)
    joint.setVelocity(up, -drop.speed * unit)
    world.addSkeleton(ground)
    world.addSkeleton(ball)

    def step() -> tuple[float, float]:
        world.step(False)
        return (joint.getPosition(up) - radius) / unit, joint.getVelocity(up) / unit

    return rebound(drop, step)


def _setting(drop: Drop, floor: float, unit: float) -> str:
    coefficients = f"setRestitutionCoeff({drop.restitution:g}) on the sphere, {floor:g} below"
    return coefficients if unit == 1.0 else f"{coefficients}, {unit:g} units to the metre"


def _way(name: str, floor: float, unit: float, own: bool = False) -> Bouncing:
    """Return a way to ask; own where a block's preset counts in that unit by itself."""
    block = {} if own else {"unit": unit}
    return Bouncing(
        name=name,
        setting=partial(_setting, floor=floor, unit=unit),
        dropped=partial(_dropped, floor=floor, unit=unit),
        block=(lambda e: {"restitution": e, **block}) if floor else None,
    )


BOUNCING = (
    _way("e on the body alone", 0.0, 1.0),
    _way("e on the body, 1 on the base, in metres", 1.0, 1.0),
    _way("and in tenths of a metre", 1.0, BETWEEN),
    _way("and in the preset's unit", 1.0, TUNED.unit, own=True),
)
"""The library takes the product of two bodies' coefficients, which are 0 unless they are set."""
