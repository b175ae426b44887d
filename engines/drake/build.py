"""Drake: how a scene is built, set, stepped and read back.

A discrete plant has its step from its making, and a solver of velocities for it. A continuous one
is left to the integrator CENIC, which takes steps as it is told, or chooses its own by halving them
and looking at the difference. Forces are constant through a step of either; the base's motion is
therefore told as the mean of its acceleration, step by step or look by look.
"""

import logging
import math
from functools import cache
from types import SimpleNamespace
from typing import Any

from engines.drake.settings import (
    CENIC,
    LONGEST,
    PLANE,
    DrakeSettings,
)
from engines.parts.quiet import imported
from engines.parts.readback import disagreement
from engines.parts.settings import given
from engines.parts.shapes import corner_spheres, half_size
from engines.run.ground import mean_velocity_of
from engines.scene import Scene
from engines.world import Moment, Pose, Step

MODULES = (
    "geometry",
    "math",
    "multibody.math",
    "multibody.plant",
    "multibody.tree",
    "systems.analysis",
    "systems.framework",
)
"""Parts of the library that are needed; all of it takes several times as long to import."""

GIVEN_UP = (RuntimeError, SystemExit)
"""What the library raises; the latter where one of its own conditions does not hold."""

IN_PLANE = (1, 0, 2, 5)
"""Where x, z, theta and its rate stand in the state of a planar joint."""

IN_SPACE = (4, 6, 8)
"""Where x, z and the rate stand in the state of a free body, which begins with a quaternion."""


class DrakeWorld:
    """A block on a half-space that does not move."""

    def __init__(self, scene: Scene, settings: DrakeSettings, dt_s: float) -> None:
        self._s, self._dt = settings, dt_s
        self._scale = scene.block.p * scene.block.R
        self._pydrake = library()
        self._continuous = settings.solver == CENIC
        self._count, self._time, self._problem = 0, 0.0, ""
        self._gravity = scene.block.gravity
        self._velocity_of = mean_velocity_of(scene.motion.segments())
        builder = self._pydrake.DiagramBuilder()
        self._plant, scene_graph = self._pydrake.AddMultibodyPlant(self._config(), builder)
        self._block = self._add_block(scene)
        self._plant.Finalize()
        self._field = self._plant.mutable_gravity_field()
        self._simulator = self._pydrake.Simulator(builder.Build())
        self._context = self._plant.GetMyMutableContextFromRoot(
            self._simulator.get_mutable_context()
        )
        self._put(scene)
        self._fault = self._read_back(scene, scene_graph)
        if self._continuous:
            self._integrator = self._integrate(scene)
        self._simulator.Initialize()

    @property
    def moment(self) -> Moment:
        """At which moment of a step the velocity of a pose holds."""
        return Moment.MIDDLE if self._s.accuracy is None else Moment.END

    def step(self, step: Step) -> None:
        """Advance by a step; see `engines.world.SteppedWorld`."""
        if self._problem:
            return
        self._field.set_gravity_vector((step.pull_x, 0.0, step.pull_z))
        self._count += 1
        try:
            # a discrete plant changes at the beginning of a step: half of one later it has, once
            end = step.end_s if self._continuous else (self._count - 0.5) * self._dt
            self._simulator.AdvanceTo(end)
        except GIVEN_UP as error:
            self._problem = one_line(error)

    def advance(self, end_s: float) -> int:
        """Advance to a time [s] in steps of the engine's own."""
        if self._problem:
            return 1
        gained = self._velocity_of(end_s, end_s) - self._velocity_of(self._time, self._time)
        pull_x = -gained / (end_s - self._time)
        self._field.set_gravity_vector((pull_x, 0.0, -self._gravity))
        before = self._integrator.get_num_steps_taken()
        try:
            self._simulator.AdvanceTo(end_s)
        except GIVEN_UP as error:
            self._problem = one_line(error)
            return 1
        self._time = end_s
        return int(self._integrator.get_num_steps_taken() - before)

    def pose(self) -> Pose:
        """Read the block's pose back."""
        state = self._plant.GetPositionsAndVelocities(self._context).tolist()
        if self._s.planar:
            x, z, theta, rate = (state[i] for i in IN_PLANE)
            return Pose(x, z, theta, rate)
        x, z, rate = (state[i] for i in IN_SPACE)
        return Pose(x, z, 2.0 * math.atan2(state[2], state[0]), rate)

    def fault(self) -> str:
        """Say which setting was not taken, or what the library gave up on."""
        return self._fault or self._problem

    def close(self) -> None:
        """Release the engine's memory."""
        self._simulator = None

    def _config(self) -> Any:
        s = self._s
        wanted = {
            "discrete_contact_approximation": None if self._continuous else s.solver,
            "stiction_tolerance": None if s.stiction is None else s.stiction * self._scale,
            "sap_near_rigid_threshold": s.near_rigid,
            "time_step": 0.0 if self._continuous else self._dt,
        }
        return self._pydrake.MultibodyPlantConfig(**given(wanted))

    def _add_block(self, scene: Scene) -> Any:
        drake, plant, s = self._pydrake, self._plant, self._s
        size = [2.0 * half for half in half_size(scene)]
        inertia = drake.SpatialInertia.SolidBoxWithMass(scene.mass, *size)
        block = plant.AddRigidBody("block", inertia)
        if s.planar:
            turned = drake.RigidTransform(drake.RotationMatrix([list(row) for row in PLANE]))
            frames = [
                plant.AddFrame(drake.FixedOffsetFrame(name, body.body_frame(), turned))
                for name, body in (("base plane", plant.world_body()), ("block plane", block))
            ]
            self._joint = plant.AddJoint(drake.PlanarJoint("plane", *frames))
        properties = self._properties(scene)
        nowhere = drake.RigidTransform()
        plant.RegisterCollisionGeometry(
            plant.world_body(), nowhere, drake.HalfSpace(), "base", properties
        )
        if s.geometry == "box":
            box = drake.Box(*size)
            plant.RegisterCollisionGeometry(block, nowhere, box, "block", properties)
            return block
        radius = s.corner_radius * scene.block.width
        for number, at in enumerate(corner_spheres(scene, radius, planar=s.planar)):
            plant.RegisterCollisionGeometry(
                block,
                drake.RigidTransform(list(at)),
                drake.Sphere(radius),
                f"corner {number}",
                properties,
            )
        return block

    def _properties(self, scene: Scene) -> Any:
        """Return what a contact is made of; two shapes of a pair have a half of it each."""
        s, drake = self._s, self._pydrake
        properties = drake.ProximityProperties()
        wanted = {
            "point_stiffness": None
            if s.stiffness is None
            else 2.0 * s.stiffness * scene.mass / self._dt**2,
            "dissipation": None if s.dissipation is None else s.dissipation / self._scale,
            "friction": drake.CoulombFriction(s.friction, s.friction),
        }
        drake.AddContactMaterial(**given(wanted), properties=properties)
        if s.relaxation is not None:
            properties.AddProperty("material", "relaxation_time", 0.5 * s.relaxation * self._dt)
        return properties

    def _put(self, scene: Scene) -> None:
        """Let the block set out from where the scene begins."""
        drake, start = self._pydrake, scene.beginning
        if self._s.planar:
            places = [start.z, start.x, start.theta]
            speeds = [start.velocity_z, start.velocity_x, start.rate]
            self._plant.SetPositionsAndVelocities(self._context, [*places, *speeds])
            return
        turn = drake.RotationMatrix.MakeYRotation(start.theta)
        pose = drake.RigidTransform(turn, [start.x, 0.0, start.z])
        self._plant.SetFreeBodyPose(self._context, self._block, pose)
        velocity = drake.SpatialVelocity(
            w=[0.0, start.rate, 0.0], v=[start.velocity_x, 0.0, start.velocity_z]
        )
        self._plant.SetFreeBodySpatialVelocity(self._context, self._block, velocity)

    def _integrate(self, scene: Scene) -> Any:
        """Put CENIC in charge of the continuous plant."""
        drake, s, simulator = self._pydrake, self._s, self._simulator
        # without an estimate of the error each step goes to where it is told
        longest = LONGEST * self._dt if s.accuracy is None else self._dt
        drake.ResetIntegratorFromFlags(simulator=simulator, scheme=CENIC, max_step_size=longest)
        integrator = simulator.get_mutable_integrator()
        integrator.set_fixed_step_mode(s.accuracy is None)
        if s.accuracy is not None:
            block = scene.block
            integrator.set_target_accuracy(s.accuracy * block.alpha * max(1.0, block.R))
        return integrator

    def _read_back(self, scene: Scene, scene_graph: Any) -> str:
        s, plant = self._s, self._plant
        inspector = scene_graph.model_inspector()
        found = [
            inspector.GetProximityProperties(shape).GetProperty("material", "coulomb_friction")
            for shape in plant.GetCollisionGeometriesForBody(self._block)
        ]
        inertia = self._block.CalcSpatialInertiaInBodyFrame(self._context)
        turning = inertia.CalcRotationalInertia().get_moments()
        problem = disagreement(
            {
                "mass": (scene.mass, self._block.get_mass(self._context)),
                "moment": (scene.inertia[1], turning[1]),
                "friction": (s.friction, found[0].static_friction()),
                "step": (0.0 if self._continuous else self._dt, plant.time_step()),
            }
        )
        if problem or s.solver in (None, CENIC):
            return problem
        taken = plant.get_discrete_contact_approximation().name.removeprefix("k").lower()
        return "" if taken == s.solver else f"solver was set to {s.solver!r} but reads {taken!r}"


@cache
def library() -> SimpleNamespace:
    """Import the library; return all names of its parts together."""
    names: dict[str, Any] = {}
    for part in MODULES:
        names |= vars(imported(f"pydrake.{part}"))
    logging.getLogger("drake").setLevel(logging.ERROR)
    return SimpleNamespace(**names)


def one_line(error: BaseException) -> str:
    """Return what the library says as one line."""
    return " ".join(str(error).split())
