"""PhysX's TGS moves a body in each iteration by v dt/n; below half an ulp of its place it stands.

A cube of 1 m without friction slides freely on a box; float32, SAPIEN 3.0.3 (PhysX 5.3.1).
"""

import warnings

import numpy as np

warnings.simplefilter("ignore")
import sapien  # noqa: E402

DT, ITERATIONS, TIME = 2.5e-4, 50, 1.0


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
    for _ in range(round(TIME / DT)):
        system.step()
    return float(cube.entity_pose.p[0]) - x


least = 0.5 * float(np.spacing(np.float32(10.0))) * ITERATIONS / DT
print(f"at x = 10 m TGS loses all below (ulp/2) n/dt = {least:.4f} m/s")
for x, speed, tgs in ((10, 0.05, True), (10, 0.15, True), (10, 0.05, False), (0, 0.05, True)):
    print(f"x {x} m, {speed} m/s, tgs {tgs}: expected {speed} m, found {end(x, speed, tgs):.4f} m")
