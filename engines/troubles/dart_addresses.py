"""The same calls give other results if the bodies lie elsewhere in memory.

The detector keys a contact by its place on the body with the lower address; PGS starts from it.

Kind: memory
"""

import dartpy as dart

R, SPEED, DEPTHS, N = 0.05, 0.01, (0.001, 0.031), 30  # deeper by more than 0.02
print("dartpy", dart.__version__)


def turns(detector, spare):
    """Return a world and how fast a block on two balls turns; `spare` ends in the middle."""
    world, base, top = dart.simulation.World(), *map(dart.dynamics.Skeleton, ("base", "top"))
    world.getConstraintSolver().setCollisionDetector(getattr(dart.collision, detector)())
    floor = base.createWeldJointAndBodyNodePair()[1]
    joint, block = top.createPlanarJointAndBodyNodePair()  # out of the plane Dantzig's fails: PGS
    joint.setZXPlane()
    ball, box = dart.dynamics.SphereShape(R), dart.dynamics.BoxShape((9, 9, 1))
    for body, shape, x in ((floor, box, 0), (block, ball, -0.5), (block, ball, 0.5)):
        node = body.createShapeNode(shape)
        node.createCollisionAspect(), node.createDynamicsAspect()
        node.setRelativeTranslation((x, 0, -0.5))
    world.addSkeleton(base)
    spare.clear()
    world.addSkeleton(top)
    for depth in DEPTHS:
        joint.setPositions((0.5 + R - depth, 0, 0))
        joint.setVelocities((0, SPEED, 0))
        world.step()
    return world, joint, joint.getVelocity(2)


names = "FCLCollisionDetector", "DARTCollisionDetector"
one, found = ({turns(d, [turns(d, []) for _ in range(n)])[2] for n in range(N)} for d in names)
print(f"expected {N} times the same, as with FCL's detector: {one} rad/s\nfound    {found} rad/s")
print(__doc__.splitlines()[2])
raise SystemExit(len(one) != 1 or len(found) == 1)
