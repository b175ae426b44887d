"""With CENIC an evaluated velocity is that of the step before.

The plant has a new state, but returns the velocity that it evaluated from the old one.

Kind: stale values
"""

from importlib.metadata import version

import numpy as np
import pydrake.all as drake

G, DT, STEPS = 9.81, 1e-3, 10
builder = drake.DiagramBuilder()
plant, _ = drake.AddMultibodyPlantSceneGraph(builder, time_step=0.0)
inertia = drake.SpatialInertia.SolidBoxWithMass(1.0, 1.0, 1.0, 1.0)
cube = plant.AddRigidBody("cube", inertia)
rail = drake.PrismaticJoint("rail", plant.world_frame(), cube.body_frame(), [0.0, 0.0, 1.0])
plant.AddJoint(rail)
plant.Finalize()
simulator = drake.Simulator(builder.Build())
context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
drake.ResetIntegratorFromFlags(simulator, scheme="cenic", max_step_size=DT)
simulator.get_mutable_integrator().set_fixed_step_mode(True)
simulator.Initialize()
for step in range(1, STEPS + 1):
    simulator.AdvanceTo(step * DT)
    found = cube.EvalSpatialVelocityInWorld(context).translational()[2]
    state = plant.GetVelocities(context)[0]
print("drake", version("drake"))
print(f"expected {state:.6f} m/s, the plant's state; -g t is {-G * STEPS * DT:.6f} m/s")
print(f"found    {found:.6f} m/s; a step before it was {state + G * DT:.6f} m/s")
print(__doc__.splitlines()[2])
raise SystemExit(not np.isclose(found, state + G * DT, atol=1e-9))
