"""A cylinder that rolls on a box does not keep its tilt, however short the steps.

Of a box the deepest point is found by iteration: in some steps another, up to millimetres off.

Kind: contact point
"""

from importlib.metadata import version
from math import acos, cos, hypot, pi, sin, sqrt

import rapier3d as rapier

A, H, TILT, G, TURNS = 0.5, 0.25, 0.2, 9.81, 5
C, S, ACROSS, ALONG = cos(TILT), sin(TILT), A * A / 4 + H * H / 3, A * A / 2
OMEGA = sqrt(G * (A * C - H * S) / (S * (ACROSS * C - ALONG * H / A * S)))  # steady rolling
SPIN = OMEGA * (C - H / A * S)


def astray(floor, dt):
    """Return by how much [rad] it leans otherwise after five turns."""
    world, height = rapier.PhysicsWorld(), A * S + H * C + (floor is floors[1])  # half of a box
    world.gravity, numbers = (0, 0, -G), world.integration_parameters
    numbers.dt, numbers.num_solver_iterations, numbers.contact_recycling = dt, 1, False
    numbers.static_contact_softness = rapier.SpringCoefficients(1e5 / (10 * pi * dt), 1e5)
    world.add_body(rapier.RigidBody.fixed(), [floor.friction(1)])
    body = rapier.RigidBody.dynamic().translation((0, 0, height)).rotation((0, TILT, 0))
    body = body.angvel((-SPIN * S, 0, OMEGA - SPIN * C)).can_sleep(False)
    shape = rapier.Collider.cylinder(H, A).rotation((pi / 2, 0, 0)).friction(1)
    rolls = world.rigid_bodies[world.add_body(body, [shape])]
    for _ in range(round(TURNS * 2 * pi / OMEGA / dt)):
        world.step()
    return acos(1 - 2 * hypot(rolls.rotation.i, rolls.rotation.j) ** 2) - TILT


floors = rapier.Collider.halfspace((0, 0, 1)), rapier.Collider.cuboid(50, 50, 1)
(flat, fine), (found, finer) = ([astray(floor, dt) for dt in (1e-4, 5e-5)] for floor in floors)
print(f"rapier3d {version('rapier3d')}: expected 0 rad; on a half-space {flat:.4f} and {fine:.4f}")
print(f"found    {found:.4f} rad, and {finer:.4f} at half the step")
print(__doc__.splitlines()[2])
raise SystemExit(min(abs(found), abs(finer)) < 10 * max(abs(flat), abs(fine)))
