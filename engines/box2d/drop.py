"""A disc dropped on a polygon in Box2D: its coefficient of restitution.

What comes in at less than 1 unit of length a second does not bounce, and nothing in Python changes
that: a smaller unit does, as long as nothing moves by more than 2 units in a step. A block's preset
counts in parts of its height by itself.
"""

from functools import partial

from engines.box2d.settings import TUNED
from engines.parts.drop import Bouncing, Drop, rebound
from engines.parts.quiet import imported

SMALL = 20.0
"""Units of length in a metre by which speeds of 0.05 to 10 m/s bounce."""

ITERATIONS = 100
"""More than a single contact needs."""


def _dropped(drop: Drop, unit: float) -> float:
    """Drop a disc; unit is the units of length in a metre."""
    b2 = imported("Box2D")
    radius, far = drop.radius * unit, 100.0 * drop.radius * unit
    world = b2.b2World(gravity=(0.0, -drop.gravity * unit))
    # a polygon acts from its skin on
    top = -b2.b2_polygonRadius
    corners = [(-far, -far), (far, -far), (far, top), (-far, top)]
    world.CreateStaticBody(position=(0.0, 0.0), shapes=b2.b2PolygonShape(vertices=corners))
    body = world.CreateDynamicBody(position=(0.0, radius + drop.height * unit))
    disc = b2.b2CircleShape(radius=radius)
    body.CreateFixture(shape=disc, density=1.0, restitution=drop.restitution)
    body.linearVelocity = (0.0, -drop.speed * unit)

    def step() -> tuple[float, float]:
        world.Step(drop.dt_s, ITERATIONS, TUNED.position_iterations)
        return (body.position[1] - radius) / unit, body.linearVelocity[1] / unit

    return rebound(drop, step)


def _setting(drop: Drop, unit: float) -> str:
    words = f"restitution={drop.restitution:g} of the body's fixture"
    return words if unit == 1.0 else f"{words}, {unit:g} units to the metre"


BOUNCING = (
    Bouncing(
        name="e on the body, in metres",
        setting=partial(_setting, unit=1.0),
        dropped=partial(_dropped, unit=1.0),
        block=lambda e: {"restitution": e, "units": None},
    ),
    Bouncing(
        name="e on the body, in small units",
        setting=partial(_setting, unit=SMALL),
        dropped=partial(_dropped, unit=SMALL),
        block=lambda e: {"restitution": e},
    ),
)
"""Of a pair the library takes the larger coefficient, the floor's being 0."""
