"""A slow body on a floor without friction stands still under TGS.

TGS moves a float32 place by v dt/n in each iteration; what is below half an ulp of it is lost.

Kind: single precision
"""

import numpy as np
import sapien

DT, ITERATIONS = 2.5e-4, 50


def end(x: float, speed: float, tgs: bool) -> float:
    """Return the way [m] that the cube goes in a second."""
    physx = sapien.physx
    physx.set_scene_config(gravity=[0, 0, -9.81], enable_tgs=tgs)
    physx.set_body_config(solver_position_iterations=ITERATIONS, sleep_threshold=0.0)
    system = physx.PhysxCpuSystem()
    system.timestep, scene = DT, sapien.Scene([system])
    smooth = physx.PhysxMaterial(0.0, 0.0, 0.0)
    floor, cube = physx.PhysxRigidStaticComponent(), physx.PhysxRigidDynamicComponent()
    for body, half, at in ((floor, [50, 50, 1], [0, 0, -1]), (cube, [0.5] * 3, [x, 0, 0.5])):
        body.attach(physx.PhysxCollisionShapeBox(half, smooth))
        entity = sapien.Entity()
        entity.add_component(body)
        entity.pose = sapien.Pose(at)
        scene.add_entity(entity)
    cube.linear_velocity = [speed, 0, 0]
    for _ in range(round(1.0 / DT)):
        system.step()
    return float(cube.entity_pose.p[0]) - x


least = 0.5 * float(np.spacing(np.float32(10.0))) * ITERATIONS / DT
pgs, near, found = end(10.0, 0.05, False), end(0.0, 0.05, True), end(10.0, 0.05, True)
print(f"sapien {sapien.__version__}; with PGS {pgs:.4f} m; with TGS at x = 0 {near:.4f} m")
print(f"expected 0.05 m; lost below (ulp/2) n/dt = {least:.4f} m/s at x = 10 m")
print(f"found    {found:.4f} m\n{__doc__.splitlines()[2]}")
raise SystemExit(found > 1e-3)
