"""Gravity that turns leaves a sleeping block where it is.

A block at rest for 0.5 s sleeps, and a world's new gravity wakes nothing.

Kind: sleeping
"""

from importlib.metadata import version

import rapier3d as rapier

G, MU, T, DT = 9.81, 0.5, 1.0, 1 / 60
print("rapier3d", version("rapier3d"))


def slid(*, sleeps):
    """Return how far [m] a flat block slides when gravity turns by 45 degrees after 2 s of rest."""
    world = rapier.PhysicsWorld()
    world.gravity = 0, 0, -G
    floor = rapier.Collider.cuboid(99, 9, 0.5).translation((0, 0, -0.5)).friction(MU)
    world.add_body(rapier.RigidBody.fixed(), [floor])
    body = rapier.RigidBody.dynamic().translation((0, 0, 0.1)).can_sleep(sleeps)
    block = world.add_body(body, [rapier.Collider.cuboid(0.5, 0.5, 0.1).friction(MU)])
    for step in range(120 + round(T / DT)):
        world.gravity = G if step >= 120 else 0, 0, -G
        world.step()
    return world.rigid_bodies[block].translation.x


expected, found = 0.5 * G * (1 - MU) * T**2, slid(sleeps=True)
print(f"expected {expected:.3f} m = g (1 - mu) t^2/2; never asleep: {slid(sleeps=False):.3f}")
print(f"found    {found:.3f} m")
print(__doc__.splitlines()[2])
raise SystemExit(abs(found) > 1e-3)
