"""A ball dropped on a box in Rapier: its coefficient of restitution.

The impulse by which something bounces is along the normal alone, and comes after that of friction:
a corner that bounces slides.
"""

from functools import partial

from engines.parts.drop import Bouncing, Drop, rebound
from engines.parts.quiet import imported


def _dropped(drop: Drop, floor: float) -> float:
    """Drop a ball; floor is the box's coefficient."""
    rapier = imported("rapier3d")
    world = rapier.PhysicsWorld()
    world.gravity = (0.0, 0.0, -drop.gravity)
    world.integration_parameters.dt = drop.dt_s
    far = 10.0 * drop.radius
    box = rapier.Collider.cuboid(far, far, far).translation((0.0, 0.0, -far)).restitution(floor)
    world.add_body(rapier.RigidBody.fixed(), [box])
    ball = rapier.Collider.ball(drop.radius).density(1000.0).restitution(drop.restitution)
    body = (
        rapier.RigidBody.dynamic()
        .translation((0.0, 0.0, drop.radius + drop.height))
        .linvel((0.0, 0.0, -drop.speed))
        .can_sleep(False)
    )
    body = world.rigid_bodies[world.add_body(body, [ball])]

    def step() -> tuple[float, float]:
        world.step()
        return body.translation.z - drop.radius, body.linvel.z

    return rebound(drop, step)


def _alone(drop: Drop) -> str:
    return f"Collider.restitution({drop.restitution:g}) of the ball"


def _both(drop: Drop) -> str:
    return f"Collider.restitution({drop.restitution:g}) of ball and floor"


BOUNCING = (
    Bouncing(
        name="e on the body alone",
        setting=_alone,
        dropped=partial(_dropped, floor=0.0),
        block=lambda e: {"restitution": 0.5 * e},
    ),
    Bouncing(
        name="e on both",
        setting=_both,
        dropped=lambda drop: _dropped(drop, drop.restitution),
        block=lambda e: {"restitution": e},
    ),
)
"""The library takes the mean of two colliders' coefficients, which are 0 unless they are set."""
