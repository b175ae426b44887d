"""A floor that sets out after a rest of 0.6 s leaves the block behind.

A block at rest for 0.5 s sleeps, and a joint with a VELOCITY actuator that moves wakes nothing.

Kind: sleeping
"""

import dartpy as dart

V, T, DT, REST, G = 0.5, 1.0, 1e-3, 0.6, 9.81
print("dartpy", dart.__version__)


def carried(rest):
    """Return how far [m] a floor that moves V T carries a block, after a rest [s]."""
    world, base, cube = (dart.simulation.World(), *map(dart.dynamics.Skeleton, ("base", "cube")))
    drive, floor = base.createTranslationalJointAndBodyNodePair()
    joint, block = cube.createFreeJointAndBodyNodePair()
    drive.setActuatorType(dart.dynamics.ActuatorType.VELOCITY)
    for body, size in ((floor, (9, 9, 1)), (block, (1, 1, 1))):
        node = body.createShapeNode(dart.dynamics.BoxShape(size))
        node.createCollisionAspect()
        node.createDynamicsAspect()  # friction 1
        world.addSkeleton(body.getSkeleton())
    joint.setPosition(5, 1)
    for step in range(round((rest + T) / DT)):
        drive.setCommands((V if step >= rest / DT else 0, 0, 0))
        world.step()
    return joint.getPosition(3)


expected, found = V * T - V**2 / (2 * G), carried(REST)
print(f"expected {expected:.4f} m = v t - v^2/(2 mu g); after a rest of 0.3 s: {carried(0.3):.4f}")
print(f"found    {found:.4f} m\n{__doc__.splitlines()[2]}")
raise SystemExit(abs(found) > 1e-3)
