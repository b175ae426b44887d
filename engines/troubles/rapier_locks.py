"""A block that may not leave its plane has no friction.

Where nothing moves a contact along one direction of friction, it gets none along the other.

Kind: friction model
"""

import math

import rapier3d as rapier

G, MU, SLOPE, T, DT = 9.81, 0.5, 0.2, 1.0, 1 / 60
print("rapier3d", rapier.__version__)


def slid(*, y_free):
    """Return how far [m] a block slides down a slope that friction should hold it on."""
    world = rapier.PhysicsWorld()
    world.gravity = G * math.sin(SLOPE), 0, -G * math.cos(SLOPE)
    floor = rapier.Collider.cuboid(9, 9, 0.5).translation((0, 0, -0.5)).friction(MU)
    world.add_body(rapier.RigidBody.fixed(), [floor])
    body = rapier.RigidBody.dynamic().translation((0, 0, 0.5))
    body = body.enabled_rotations((False, True, False)).enabled_translations((True, y_free, True))
    block = world.add_body(body, [rapier.Collider.cuboid(0.5, 0.5, 0.5).friction(MU)])
    for _ in range(round(T / DT)):
        world.step()
    return world.rigid_bodies[block].translation.x


found, slides = slid(y_free=False), 0.5 * G * math.sin(SLOPE) * T**2
print(f"expected 0.000 m, as mu = {MU} > tan(slope) = {math.tan(SLOPE):.3f}; y free: ", end="")
print(f"{slid(y_free=True):.3f}\nfound    {found:.3f} m; g sin(slope) t^2/2 gives {slides:.3f}")
print(__doc__.splitlines()[2])
raise SystemExit(abs(found - slides) > 0.05)
