"""A block sleeps though the world was made with doSleep=False.

The constructor stores doSleep as a Python attribute, allowSleeping, that the library never reads.

Kind: sleeping
"""

import Box2D

print("Box2D", Box2D.__version__)


def awake(*, told):
    """Say whether a block is awake after 2 s of rest, and what the library says of sleep."""
    world = Box2D.b2World(gravity=(0, -10), doSleep=False)
    if told:
        world.SetAllowSleeping(False)
    world.CreateStaticBody(shapes=Box2D.b2PolygonShape(box=(9, 0.5)))
    box = Box2D.b2FixtureDef(shape=Box2D.b2PolygonShape(box=(0.5, 0.5)), density=1)
    block = world.CreateDynamicBody(position=(0, 1), fixtures=box)
    for _ in range(120):
        world.Step(1 / 60, 6, 2)
    return block.awake, world.allowSleeping, world.GetAllowSleeping()


found, attribute, inside = awake(told=False)
print(f"expected awake: True; after SetAllowSleeping(False): {awake(told=True)[0]}")
print(f"found    awake: {found}; allowSleeping {attribute}, GetAllowSleeping() {inside}")
print(__doc__.splitlines()[2])
raise SystemExit(found or not inside)
