"""A block that turns about a corner slips, though friction could hold it.

Dantzig's solver bounds friction by the normal force N0 that it found without friction.

Kind: friction model
"""

import math

import dartpy as dart

B, H, G, DT, MU, LEAN, PULL = 0.5, 1.0, 9.81, 1e-3, 1.0, 0.02, 1.2
print("dartpy", dart.__version__)
world = dart.simulation.World()
world.setTimeStep(DT)
world.setGravity((PULL * G, 0, -G))
bodies = []
for size, heavy in (((9, 9, 1), False), ((B, B, H), True)):
    skeleton = dart.dynamics.Skeleton(f"{size}")
    ways = skeleton.createWeldJointAndBodyNodePair, skeleton.createFreeJointAndBodyNodePair
    joint, body = ways[heavy]()
    node = body.createShapeNode(dart.dynamics.BoxShape(size))
    node.createCollisionAspect()
    node.createDynamicsAspect()  # friction 1
    node.setRelativeTranslation((0, 0, 0 if heavy else -size[2] / 2))
    world.addSkeleton(skeleton)
joint.setPosition(1, LEAN)
joint.setPosition(5, 0.5 * (H * math.cos(LEAN) + B * math.sin(LEAN)))
body.setMomentOfInertia((B * B + H * H) / 12, (B * B + H * H) / 12, B * B / 6)
world.step()
found = PULL - body.getCOMLinearVelocity()[0] / DT / G
angle, r2 = math.atan(B / H) - LEAN, 0.75  # 0.75: R^2 over the moment about the corner
turning = r2 * (PULL * math.cos(angle) - math.sin(angle))
needed, normal = PULL - turning * math.cos(angle), 1 + turning * math.sin(angle)
bound = MU / (1 + 3 * math.sin(angle) ** 2)
print(f"expected {needed:.4f} m g of friction holds the corner: below mu N = {MU * normal:.4f} m g")
print(f"found    {found:.4f} m g; mu N0 = mu m g/(1 + 3 sin^2(alpha - lean)) gives {bound:.4f}")
print(__doc__.splitlines()[2])
raise SystemExit(bool(abs(found - bound) > 5e-3))
