"""Drake: a cylinder in space, whose rim is the true one."""

from typing import Any

from engines.drake.build import GIVEN_UP, library, one_line, values
from engines.drake.settings import CENIC, DrakeSettings
from engines.parts.quiet import imported


class DrakeCylinder:
    """A free body on a half-space."""

    def __init__(self, scene: Any, settings: DrakeSettings, dt_s: float) -> None:
        drake, it, s = library(), scene.cylinder, values(scene, settings, dt_s)
        self._dt, self._count, self._problem = dt_s, 0, ""
        self._late = 0.0 if settings.solver == CENIC else 0.5
        builder = drake.DiagramBuilder()
        plant, _ = drake.AddMultibodyPlant(drake.MultibodyPlantConfig(**s.config), builder)
        properties = drake.ProximityProperties()
        rough = drake.CoulombFriction(s.friction, s.friction)
        drake.AddContactMaterial(properties=properties, friction=rough, **s.material)
        if s.relaxation is not None:
            properties.AddProperty("material", "relaxation_time", s.relaxation)
        inertia = drake.SpatialInertia.SolidCylinderWithMass(
            it.mass, it.radius, it.height, [0.0, 0.0, 1.0]
        )
        self._body = plant.AddRigidBody("cylinder", inertia)
        round_, here = drake.Cylinder(it.radius, it.height), drake.RigidTransform()
        ground = plant.world_body()
        for body, shape in ((ground, drake.HalfSpace()), (self._body, round_)):
            plant.RegisterCollisionGeometry(body, here, shape, "touching", properties)
        plant.mutable_gravity_field().set_gravity_vector((0.0, 0.0, -scene.gravity))
        plant.Finalize()
        self._plant, self._simulator = plant, drake.Simulator(builder.Build())
        root = self._simulator.get_mutable_context()
        self._context = plant.GetMyMutableContextFromRoot(root)
        turn = imported("pydrake.common.eigen_geometry").Quaternion(it.turn)
        place = drake.RigidTransform(turn, it.place)
        plant.SetFreeBodyPose(self._context, self._body, place)
        speed = drake.SpatialVelocity(w=it.spin, v=it.velocity)
        plant.SetFreeBodySpatialVelocity(self._context, self._body, speed)
        if s.scheme is not None:
            drake.ResetIntegratorFromFlags(
                self._simulator, scheme=s.scheme, max_step_size=s.longest
            )
            self._simulator.get_mutable_integrator().set_fixed_step_mode(s.fixed)
        self._simulator.Initialize()

    def step(self) -> None:
        """Advance by a step."""
        self._count += 1
        try:
            # a discrete plant changes at the beginning of a step: half of one later it has, once
            if not self._problem:
                self._simulator.AdvanceTo((self._count - self._late) * self._dt)
        except GIVEN_UP as error:
            self._problem = one_line(error)

    def state(self) -> Any:
        """Read the state back."""
        q = self._plant.GetPositions(self._context)
        v = self._plant.GetVelocities(self._context)
        return q[4:], q[:4], v[3:], v[:3]

    def fault(self) -> str:
        """Say what the library gave up on."""
        return self._problem

    def close(self) -> None:
        """Release the engine's memory."""
        self._simulator = None
