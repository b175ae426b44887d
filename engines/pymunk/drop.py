"""A disc dropped on a segment in pymunk: its coefficient of restitution."""

from functools import partial

from engines.parts.drop import Bouncing, Drop, rebound
from engines.parts.quiet import imported


def _dropped(drop: Drop, floor: float) -> float:
    """Drop a disc; floor is the elasticity of what it falls on."""
    pm = imported("pymunk")
    space = pm.Space()
    space.gravity = (0.0, -drop.gravity)
    body = pm.Body(drop.mass, pm.moment_for_circle(drop.mass, 0.0, drop.radius))
    disc = pm.Circle(body, drop.radius)
    ground = pm.Segment(space.static_body, (-1.0, 0.0), (1.0, 0.0), 0.0)
    disc.elasticity, ground.elasticity = drop.restitution, floor
    body.position, body.velocity = (0.0, drop.radius + drop.height), (0.0, -drop.speed)
    space.add(body, disc, ground)

    def step() -> tuple[float, float]:
        space.step(drop.dt_s)
        return body.position.y - drop.radius, body.velocity.y

    return rebound(drop, step)


def _setting(drop: Drop, floor: float) -> str:
    return f"body's shape.elasticity = {drop.restitution:g}, floor.elasticity = {floor:g}"


BOUNCING = (
    Bouncing(
        name="e on the body alone",
        setting=partial(_setting, floor=0.0),
        dropped=partial(_dropped, floor=0.0),
    ),
    Bouncing(
        name="e on the body, 1 on the floor",
        setting=partial(_setting, floor=1.0),
        dropped=partial(_dropped, floor=1.0),
        block=lambda e: {"restitution": e},
    ),
)
"""The library takes the product of two shapes' elasticities, which are 0 unless they are set."""
