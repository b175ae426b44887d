"""A block that rides on a floor at a steady speed is held back.

Each body's damping c of 0.04/s is against the world, not what it rides on: v' = -c v (1 + |v|).

Kind: damping
"""

import math
from importlib.metadata import version

import pybullet as p

V, T, C = 1.0, 10.0, 0.04
print("pybullet", version("pybullet"))
p.connect(p.DIRECT)
p.setGravity(0, 0, -9.81)
floor = p.createMultiBody(0, p.createCollisionShape(p.GEOM_BOX, halfExtents=[99, 9, 0.5]))
cube = p.createCollisionShape(p.GEOM_BOX, halfExtents=[0.5] * 3)
block = p.createMultiBody(1, cube, basePosition=[0, 0, 1])
p.changeDynamics(block, -1, lateralFriction=0)  # so that damping alone acts
p.resetBaseVelocity(block, [V, 0, 0])
for _ in range(round(240 * T)):
    p.stepSimulation()
found = p.getBaseVelocity(block)[0][0]
left = V / (1 + V) * math.exp(-C * T)
damped = left / (1 - left)
print(f"expected {V:.4f} m/s after {T:.0f} s: nothing pulls along the floor")
print(f"found    {found:.4f} m/s; v/(1 + v) = v0/(1 + v0) exp(-c t) gives {damped:.4f}")
print(__doc__.splitlines()[2])
raise SystemExit(abs(found - damped) > 1e-3)
