"""A floor that is led by a fixed constraint lags behind.

Of what the constraint is off, a step takes back the part ERP, by default 0.2.

Kind: weak constraint
"""

from importlib.metadata import version

import pybullet as p

V, T, DT, ERP = 1.0, 1.0, 1 / 240, 0.2
print("pybullet", version("pybullet"))
p.connect(p.DIRECT)
box = p.createCollisionShape(p.GEOM_BOX, halfExtents=[2, 2, 0.5])
floor = p.createMultiBody(10, box)
p.changeDynamics(floor, -1, linearDamping=0, angularDamping=0)
held = p.createConstraint(floor, -1, -1, -1, p.JOINT_FIXED, [0, 0, 0], [0, 0, 0], [0, 0, 0])
for step in range(round(T / DT)):
    p.changeConstraint(held, [V * (step + 1) * DT, 0, 0], maxForce=1e9)
    p.stepSimulation()
found = V * T - p.getBasePositionAndOrientation(floor)[0][0]
lag = V * DT * (1 / ERP - 1)
print("expected 0.0000 m behind: it is fixed, by a force without bound")
print(f"found    {found:.4f} m; v dt (1/ERP - 1) gives {lag:.4f}")
print(__doc__.splitlines()[2])
raise SystemExit(abs(found - lag) > 1e-4)
