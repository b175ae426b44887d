"""A floor that is put from place to place carries nothing.

Friction acts by the floor's velocity, and a position that is set leaves that at zero.

Kind: teleport
"""

from importlib.metadata import version

import pybullet as p

V, T, DT, MU, G = 0.5, 1.0, 1 / 240, 0.5, 9.81
print("pybullet", version("pybullet"))


def carried(*, by_velocity):
    """Return how far [m] a floor that moves V T carries a block."""
    p.connect(p.DIRECT)
    p.setGravity(0, 0, -G)
    floor = p.createMultiBody(0, p.createCollisionShape(p.GEOM_BOX, halfExtents=[9, 9, 0.5]))
    cube = p.createCollisionShape(p.GEOM_BOX, halfExtents=[0.5] * 3)
    block = p.createMultiBody(1, cube, basePosition=[0, 0, 1])
    p.changeDynamics(block, -1, linearDamping=0, angularDamping=0, lateralFriction=1)
    p.changeDynamics(floor, -1, lateralFriction=MU)
    for step in range(round(T / DT)):
        p.resetBasePositionAndOrientation(floor, [V * step * DT, 0, 0], [0, 0, 0, 1])
        if by_velocity:
            p.resetBaseVelocity(floor, [V, 0, 0])
        p.stepSimulation()
    x = p.getBasePositionAndOrientation(block)[0][0]
    p.disconnect()
    return x


expected, found = V * T - V**2 / (2 * MU * G), carried(by_velocity=False)
moved = carried(by_velocity=True)
print(f"expected {expected:.4f} m = v t - v^2/(2 mu g); by velocity: {moved:.4f}")
print(f"found    {found:.4f} m by positions")
print(__doc__.splitlines()[2])
raise SystemExit(abs(found) > 1e-3)
