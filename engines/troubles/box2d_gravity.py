"""Gravity that turns leaves a sleeping block where it is.

A block at rest for 0.5 s sleeps, and a world's new gravity wakes nothing.

Kind: sleeping
"""

from importlib.metadata import version

import Box2D

G, MU, T, DT = 10.0, 0.2, 1.0, 1 / 60
print("Box2D", version("Box2D"))


def slid(*, sleeps):
    """Return how far [m] a block slides when gravity turns by 45 degrees after 2 s of rest."""
    world = Box2D.b2World(gravity=(0, -G))
    world.CreateStaticBody(shapes=Box2D.b2PolygonShape(box=(99, 0.5)))
    shape = Box2D.b2PolygonShape(box=(0.5, 0.5))
    block = world.CreateDynamicBody(position=(0, 1), allowSleep=sleeps)
    block.CreateFixture(shape=shape, density=1, friction=MU)
    for step in range(120 + round(T / DT)):
        world.gravity = (G, -G) if step >= 120 else (0, -G)
        world.Step(DT, 6, 2)
    return block.position.x


expected, found = 0.5 * G * (1 - MU) * T * (T + DT), slid(sleeps=True)
print(
    f"expected {expected:.4f} m = g (1 - mu) t (t + dt)/2; never asleep: {slid(sleeps=False):.4f}"
)
print(f"found    {found:.4f} m")
print(__doc__.splitlines()[2])
raise SystemExit(abs(found) > 1e-3)
