"""A body with locked motions yields under its load, which then sinks into it.

Contacts are solved as if nothing were locked, and a lock takes its velocity away afterwards.

Kind: weak constraint
"""

import sapien

G, DT, T, RATIO = 9.81, 1e-3, 0.5, 2.0


def sunk(*, kinematic: bool) -> float:
    """Return how far [m] a cube sinks into a floor that is lighter, and may move along x alone."""
    physx = sapien.physx
    physx.set_scene_config(gravity=[0, 0, -G], enable_tgs=False)
    physx.set_body_config(sleep_threshold=0.0)
    system = physx.PhysxCpuSystem()
    system.timestep, scene = DT, sapien.Scene([system])
    rough = physx.PhysxMaterial(1.0, 1.0, 0.0)
    floor, cube = physx.PhysxRigidDynamicComponent(), physx.PhysxRigidDynamicComponent()
    for body, half, mass, at in ((floor, [5, 5, 1], 1.0, -1.0), (cube, [0.5] * 3, RATIO, 0.5)):
        body.attach(physx.PhysxCollisionShapeBox(half, rough))
        body.mass, body.inertia, body.max_depenetration_velocity = mass, [mass] * 3, 1e-6
        entity = sapien.Entity()
        entity.add_component(body)
        entity.pose = sapien.Pose([0, 0, at])
        scene.add_entity(entity)
    floor.disable_gravity, floor.kinematic = True, kinematic
    floor.set_locked_motion_axes([False, True, True, True, True, True])
    for _ in range(round(T / DT)):
        system.step()
    return 0.5 - float(cube.entity_pose.p[2])


found, law = sunk(kinematic=False), RATIO * G * DT * T
print(f"sapien {sapien.__version__}; into a kinematic floor {1e3 * sunk(kinematic=True):.3f} mm")
print(f"expected 0 mm; a floor that yields lets it sink by m/M g dt t = {1e3 * law:.3f} mm")
print(f"found    {1e3 * found:.3f} mm\n{__doc__.splitlines()[2]}")
raise SystemExit(abs(found / law - 1.0) > 0.05)
