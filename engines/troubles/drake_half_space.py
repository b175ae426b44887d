"""A box that friction and weight should hold upright leans.

Of a box on a half space there is one contact, at its face's centre while 1 - cos(theta) < 1e-7.

Kind: single contact
"""

import logging
import math
from importlib.metadata import version

import pydrake.all as d

B, H, M, G, PART, K = 0.5, 1.5, 1.0, 9.81, 0.6, 5e5  # K: two surfaces of 1e6 N/m in a row
logging.getLogger("drake").setLevel(logging.ERROR)
print("drake", version("drake"))
builder = d.DiagramBuilder()
plant, _ = d.AddMultibodyPlant(d.MultibodyPlantConfig(time_step=1e-3), builder)
rough = d.ProximityProperties()
d.AddContactMaterial(properties=rough, friction=d.CoulombFriction(1, 1))
block = plant.AddRigidBody("block", d.SpatialInertia.SolidBoxWithMass(M, B, 1, H))
for body, shape in ((plant.world_body(), d.HalfSpace()), (block, d.Box(B, 1, H))):
    plant.RegisterCollisionGeometry(body, d.RigidTransform(), shape, body.name(), rough)
plant.Finalize()
simulator = d.Simulator(builder.Build())
context = plant.GetMyContextFromRoot(simulator.get_mutable_context())
plant.SetFreeBodyPose(context, block, d.RigidTransform([0, 0, 0.5 * H - M * G / K]))
plant.mutable_gravity_field().set_gravity_vector([PART * G * B / H, 0, -G])  # onset at G B/H
simulator.AdvanceTo(3)
q = plant.GetPositions(context)
found, leans = 2 * math.atan2(q[2], q[0]), math.acos(1 - 1e-7)
corners = 0.5 * PART * M * G * B / (K * (B / 2) ** 2 * 4)
print(f"expected {corners:.2e}, a lean on four springs at the corners, at {PART} of the onset")
print(f"found    {found:.2e}; arccos(1 - 1e-7) is {leans:.2e}")
print(__doc__.splitlines()[2])
raise SystemExit(bool(abs(found - leans) > 0.05 * leans))
