"""Drake: how a scene is built, set, stepped and read back.

A discrete plant has its step from its making, and a solver of velocities for it. A continuous one
is left to the integrator CENIC, which takes steps as it is told, or chooses its own by halving them
and looking at the difference. Forces are constant through a step of either; the base's motion is
therefore told as the mean of its acceleration, step by step or look by look. Where the base moves,
it is a box on a rail whose drive is told where it should be, and how fast.
"""

import logging
import math
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np

from engines.drake.settings import CENIC, GAINS, LONGEST, PLANE, SPEED_GAINS, DrakeSettings
from engines.parts import floor_half_size, half_size, imported, touching_spheres
from engines.run.ground import mean_velocity_of
from engines.scene import Scene
from engines.settings import disagreement, given
from engines.world import FloatArray, Moment, Pose, Step

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

IN_PLANE = (1, 0, 2)
"""Where x, z and theta stand among the positions of a planar joint; velocities likewise."""

IN_SPACE = (4, 6, 1)
"""Where x and z stand among the positions of a free body, which begin with a quaternion, and the
rate among its velocities."""

BACKWARDS = -1.0
"""CENIC of 1.51.1 lets a drive run at its desired velocity with the opposite sign."""

WITHIN = 8
"""In so many parts of a look the base is told how fast it is, where steps are the engine's own."""


def numbers(scene: Scene, s: DrakeSettings) -> SimpleNamespace:
    """Return the numbers of a scene.

    Parameters
    ----------
    scene : Scene
    s : DrakeSettings

    Returns
    -------
    SimpleNamespace
        What `build` takes as n, lengths [m]:

        - plane (3, 3): `PLANE`; radius: of corner spheres;
        - moving: whether the base does; floor, below, along (3,): its size, centre and axis; heavy:
          its mass [kg];
        - state (6 bodies,): z, x, theta of every body [m, rad], then their rates [m/s, rad/s];
        - of each of bodies: mass [kg], size (3,), corners (k, 3) about its centre; where it is
          free, place (3,), velocity (3,) [m/s], theta [rad] and spin (3,) [rad/s].
    """
    bodies = [of_body(scene, number, s) for number in range(len(scene.bodies))]
    x, y, z = floor_half_size(scene)
    return SimpleNamespace(
        **{"plane": [list(row) for row in PLANE], "bodies": bodies},
        **{"moving": scene.frame == "world", "floor": [2.0 * x, 2.0 * y, 2.0 * z]},
        **{"below": [0.0, 0.0, -z], "along": [1.0, 0.0, 0.0], "heavy": bodies[0].mass},
        radius=s.corner_radius * scene.system.width,
        state=[q for body in bodies for q in body.state] + [v for b in bodies for v in b.speeds],
    )


def of_body(scene: Scene, number: int, s: DrakeSettings) -> SimpleNamespace:
    """Return the numbers of a body, and of the corners by which it touches others."""
    body, radius = scene.bodies[number], s.corner_radius * scene.system.width
    at, name = body.at, f"block{number or ''}"
    spheres = touching_spheres(scene, number, radius, planar=s.planar)
    corners = [list(corner) for corner in spheres]
    return SimpleNamespace(
        **{"name": name, "on_base": f"{name} on the base", "in_plane": f"{name} in the plane"},
        **{"mass": body.mass, "size": [2.0 * half for half in half_size(body)]},
        **{"corners": corners, "box": s.geometry == "box", "ball": f"{name} corner"},
        carried=scene.layout.rests(number),
        **{"state": [at.z, at.x, at.theta], "speeds": [at.velocity_z, at.velocity_x, at.rate]},
        **{"theta": at.theta, "place": [at.x, 0.0, at.z]},
        **{"spin": [0.0, at.rate, 0.0], "velocity": [at.velocity_x, 0.0, at.velocity_z]},
    )


def values(scene: Scene, s: DrakeSettings, dt_s: float) -> SimpleNamespace:
    """Return settings as the library is given them, for ordinary steps dt_s [s].

    Parameters
    ----------
    scene : Scene
    s : DrakeSettings
    dt_s : float, ordinary step [s], of a discrete plant its own

    Returns
    -------
    SimpleNamespace
        What `build` takes as s; None leaves a number to the library:

        - config: arguments of MultibodyPlantConfig [s, m/s]; material: those of AddContactMaterial,
          the stiffness [N/m] that of one of two shapes, dissipation [s/m];
        - relaxation: of one of two shapes [s]; gains: p [N/m] and d [N s/m] of the base's drive;
        - scheme: of an integrator; longest: its longest step [s]; accuracy: what it aims at; fixed:
          whether it takes its steps as told, without a look at the error.
    """
    block, continuous = scene.system, s.solver == CENIC
    scale = block.p * block.R
    config = {
        "time_step": 0.0 if continuous else dt_s,
        "discrete_contact_approximation": None if continuous else s.solver,
        "stiction_tolerance": None if s.stiction is None else s.stiction * scale,
        "sap_near_rigid_threshold": s.near_rigid,
    }
    # two shapes of a pair have a half of a contact's stiffness and relaxation each
    material = {
        "point_stiffness": None
        if s.stiffness is None
        else 2.0 * s.stiffness * scene.layout.carried(scene.layout.contacts[0]) / dt_s**2,
        "dissipation": None if s.dissipation is None else s.dissipation / scale,
    }
    return SimpleNamespace(
        **{"geometry": s.geometry, "planar": s.planar, "friction": float(s.friction)},
        **{"config": given(config), "material": given(material)},
        relaxation=None if s.relaxation is None else 0.5 * s.relaxation * dt_s,
        **{"scheme": CENIC if continuous else None, "fixed": s.accuracy is None},
        gains=SPEED_GAINS if continuous else GAINS,
        # without an estimate of the error each step goes to where it is told
        longest=LONGEST * dt_s if s.accuracy is None else dt_s,
        accuracy=None if s.accuracy is None else s.accuracy * block.alpha * max(1.0, block.R),
    )


def build(drake: Any, n: Any, s: Any) -> Any:
    """Build bodies on a half-space that does not move, or on a box on a rail.

    Parameters
    ----------
    drake : namespace, of `library`
    n : SimpleNamespace, from `numbers`
    s : SimpleNamespace, from `values`

    Returns
    -------
    plant : MultibodyPlant
    scene_graph : SceneGraph
    bodies : list of RigidBody, one for each of n.bodies
    simulator : Simulator
    context : Context, the plant's, at the start of the scene
    """
    builder = drake.DiagramBuilder()
    config = drake.MultibodyPlantConfig(**s.config)
    plant, scene_graph = drake.AddMultibodyPlant(config, builder)
    properties, rough = drake.ProximityProperties(), drake.CoulombFriction(s.friction, s.friction)
    drake.AddContactMaterial(properties=properties, friction=rough, **s.material)
    if s.relaxation is not None:
        properties.AddProperty("material", "relaxation_time", s.relaxation)
    ground, here, bodies = plant.world_body(), drake.RigidTransform(), []
    blocks = drake.default_model_instance()
    if n.moving:
        inertia = drake.SpatialInertia.SolidBoxWithMass(n.heavy, *n.floor)
        floor = plant.AddRigidBody("floor", plant.AddModelInstance("floor"), inertia)
        ends = ground.body_frame(), floor.body_frame()
        rail = plant.AddJoint(drake.PrismaticJoint("rail", *ends, n.along))
        drive = plant.AddJointActuator("drive", rail)
        drive.set_controller_gains(drake.PdControllerGains(**s.gains))
        shape, below = drake.Box(*n.floor), drake.RigidTransform(n.below)
        plant.RegisterCollisionGeometry(floor, below, shape, "base", properties)
    else:
        plant.RegisterCollisionGeometry(ground, here, drake.HalfSpace(), "base", properties)
    turned = drake.RigidTransform(drake.RotationMatrix(n.plane))
    for b in n.bodies:
        inertia = drake.SpatialInertia.SolidBoxWithMass(b.mass, *b.size)
        block = plant.AddRigidBody(b.name, blocks, inertia)
        bodies.append(block)
        if s.planar:
            base_plane = drake.FixedOffsetFrame(b.on_base, ground.body_frame(), turned)
            block_plane = drake.FixedOffsetFrame(b.in_plane, block.body_frame(), turned)
            frames = [plant.AddFrame(frame) for frame in (base_plane, block_plane)]
            plant.AddJoint(drake.PlanarJoint(b.name, *frames))
        if b.box or b.carried:
            plant.RegisterCollisionGeometry(block, here, drake.Box(*b.size), b.name, properties)
        if not b.box:
            for number, at in enumerate(b.corners):
                there, ball = drake.RigidTransform(at), drake.Sphere(n.radius)
                plant.RegisterCollisionGeometry(
                    block, there, ball, f"{b.ball} {number}", properties
                )
    plant.Finalize()
    simulator = drake.Simulator(builder.Build())
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    if s.planar:
        plant.SetPositionsAndVelocities(context, blocks, n.state)
    else:
        for b in n.bodies:
            block = plant.GetBodyByName(b.name)
            start = drake.RigidTransform(drake.RotationMatrix.MakeYRotation(b.theta), b.place)
            plant.SetFreeBodyPose(context, block, start)
            velocity = drake.SpatialVelocity(w=b.spin, v=b.velocity)
            plant.SetFreeBodySpatialVelocity(context, block, velocity)
    if s.scheme is not None:
        drake.ResetIntegratorFromFlags(simulator, scheme=s.scheme, max_step_size=s.longest)
        integrator = simulator.get_mutable_integrator()
        integrator.set_fixed_step_mode(s.fixed)
        if s.accuracy is not None:
            integrator.set_target_accuracy(s.accuracy)
    simulator.Initialize()
    return plant, scene_graph, bodies, simulator, context


class DrakeWorld:
    """Bodies on a half-space that does not move, or on a box on a rail."""

    def __init__(self, scene: Scene, settings: DrakeSettings, dt_s: float) -> None:
        self._s, self._dt = settings, dt_s
        self._continuous = settings.solver == CENIC
        self._count, self._time, self._problem = 0, 0.0, ""
        self._gravity = scene.system.gravity
        self._velocity_of = mean_velocity_of(scene.motion.segments())
        n = numbers(scene, settings)
        built = build(library(), n, values(scene, settings, dt_s))
        self._plant, scene_graph, self._bodies, self._simulator, self._context = built
        self._blocks = self._bodies[0].model_instance()
        self._moving, self._place = n.moving, 0.0
        if self._moving:
            self._rail: Any = self._plant.GetJointByName("rail")
            floor = self._plant.GetModelInstanceByName("floor")
            self._desired = self._plant.get_desired_state_input_port(floor)
            self.lag_m = 0.0
        self._state = np.zeros((len(self._bodies), len(Pose._fields)))
        self._field = self._plant.mutable_gravity_field()
        if self._continuous:
            self._integrator = self._simulator.get_mutable_integrator()
        self._fault = self._read_back(scene, scene_graph)

    @property
    def moment(self) -> Moment:
        """At which moment of a step the velocity of a pose holds."""
        return Moment.MIDDLE if self._s.accuracy is None else Moment.END

    def step(self, step: Step) -> None:
        """Advance by a step."""
        if self._problem:
            return
        self._field.set_gravity_vector((step.pull_x, 0.0, step.pull_z))
        if self._moving:
            self._drive(step.base_x, step.base_velocity)
        self._count += 1
        try:
            # a discrete plant changes at the beginning of a step: half of one later it has, once
            end = step.end_s if self._continuous else (self._count - 0.5) * self._dt
            self._simulator.AdvanceTo(end)
        except GIVEN_UP as error:
            self._problem = one_line(error)
        if self._moving:
            self._look_back(step.base_x)

    def advance(self, end_s: float) -> int:
        """Advance to a time [s] in steps of the engine's own."""
        if self._problem:
            return 1
        gained = self._velocity_of(end_s, end_s) - self._velocity_of(self._time, self._time)
        pull_x = 0.0 if self._moving else -gained / (end_s - self._time)
        self._field.set_gravity_vector((pull_x, 0.0, -self._gravity))
        before = self._integrator.get_num_steps_taken()
        try:
            if self._moving:
                for end in np.linspace(self._time, end_s, WITHIN + 1)[1:-1]:
                    self._carry(float(end))
                self._carry(end_s)
            else:
                self._simulator.AdvanceTo(end_s)
        except GIVEN_UP as error:
            self._problem = one_line(error)
            return 1
        self._time = end_s
        return int(self._integrator.get_num_steps_taken() - before)

    def _carry(self, end_s: float) -> None:
        """Advance to a time [s], the base at its mean velocity."""
        velocity = self._velocity_of(self._time, end_s)
        self._place += velocity * (end_s - self._time)
        self._drive(self._place, velocity)
        self._simulator.AdvanceTo(end_s)
        self._look_back(self._place)
        self._time = end_s

    def _drive(self, place: float, velocity: float) -> None:
        """Tell the base's drive where it should be [m], and how fast [m/s]."""
        if self._s.floor == "position":
            self._rail.set_translation(self._context, place)
            velocity = 0.0
        turned = BACKWARDS if self._continuous else 1.0
        self._desired.FixValue(self._context, [place, turned * velocity])

    def _look_back(self, place: float) -> None:
        """Take note of how far the base is from where it should be [m]."""
        self.lag_m = max(self.lag_m, abs(self._rail.get_translation(self._context) - place))

    def state(self) -> FloatArray:
        """Read the bodies' poses back."""
        found = self._plant.GetPositionsAndVelocities(self._context, self._blocks).tolist()
        count, base_x = len(self._state), 0.0
        if self._moving:
            base_x = self._rail.get_translation(self._context)
        for number, row in enumerate(self._state):
            if self._s.planar:
                x, z, theta = (found[3 * number + i] for i in IN_PLANE)
                row[:] = x - base_x, z, theta, found[3 * (count + number) + IN_PLANE[2]]
            else:
                q = found[7 * number : 7 * number + 7]
                x, z, turning = IN_SPACE
                rate = found[7 * count + 6 * number + turning]
                row[:] = q[x] - base_x, q[z], 2.0 * math.atan2(q[2], q[0]), rate
        return self._state

    def fault(self) -> str:
        """Say which setting was not taken, or what the library gave up on."""
        return self._fault or self._problem

    def close(self) -> None:
        """Release the engine's memory."""
        self._simulator = None

    def _read_back(self, scene: Scene, scene_graph: Any) -> str:
        s, plant, (body, *_), block = self._s, self._plant, scene.bodies, self._bodies[0]
        inspector = scene_graph.model_inspector()
        found = [
            inspector.GetProximityProperties(shape).GetProperty("material", "coulomb_friction")
            for shape in plant.GetCollisionGeometriesForBody(block)
        ]
        inertia = block.CalcSpatialInertiaInBodyFrame(self._context)
        turning = inertia.CalcRotationalInertia().get_moments()
        problem = disagreement(
            {
                "mass": (body.mass, block.get_mass(self._context)),
                "moment": (body.inertia[1], turning[1]),
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
