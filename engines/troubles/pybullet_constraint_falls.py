"""A floor that is held by a fixed constraint falls.

The constraint holds with at most maxForce, 50 N in the manual's example: too little for 10 kg.

Kind: weak constraint
"""

from importlib.metadata import version

import pybullet as p

MASS, FORCE, T, G, DT = 10.0, 50.0, 1.0, 9.81, 1 / 240
print("pybullet", version("pybullet"))
p.connect(p.DIRECT)
p.setGravity(0, 0, -G)
box = p.createCollisionShape(p.GEOM_BOX, halfExtents=[2, 2, 0.5])
floor = p.createMultiBody(MASS, box)
p.changeDynamics(floor, -1, linearDamping=0, angularDamping=0)
held = p.createConstraint(floor, -1, -1, -1, p.JOINT_FIXED, [0, 0, 0], [0, 0, 0], [0, 0, 0])
for _ in range(round(T / DT)):
    p.changeConstraint(held, [0, 0, 0], maxForce=FORCE)
    p.stepSimulation()
found = p.getBasePositionAndOrientation(floor)[0][2]
falls = -0.5 * (G - FORCE / MASS) * T * (T + DT)
print("expected 0.0000 m: it is fixed")
print(f"found    {found:.4f} m; -(g - F/m) t (t + dt)/2 gives {falls:.4f}")
print(__doc__.splitlines()[2])
raise SystemExit(abs(found - falls) > 1e-3)
