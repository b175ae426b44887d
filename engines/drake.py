"""Drake: settings, presets, and how a scene is built, set, stepped and read back.

A discrete plant has one step and a solver of velocities. A continuous one is left to the integrator
CENIC, which takes steps as it is told, or chooses its own by halving them. Forces are constant
through a step of either: a base at rest gets the mean of the motion's acceleration, and one that
moves is a box on a rail whose drive is told where it should be, and how fast.
"""

import logging
import math
from dataclasses import dataclass, replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np

from engines.declaration import Engine, Preset, Stepping, citations, default
from engines.factors import BOTH, DEFAULT, factor, level, moving_base
from engines.parts import NO_JAM, Adapter, imported, yaw_of
from engines.run.export import Notes
from engines.run.ground import mean_velocity_of
from engines.scene import Scene
from engines.settings import Settings, disagreement, given, setting
from engines.shapes import floor_half_size, half_size, touching_spheres
from engines.world import FloatArray, Moment, Script, Step

MODULES = (
    *("geometry", "math", "multibody.math", "multibody.plant", "multibody.tree"),
    *("systems.analysis", "systems.framework"),
)
"""Parts of the library that are needed; all of it takes several times as long to import."""

GIVEN_UP = (RuntimeError, SystemExit)
"""What the library raises; the latter where one of its own conditions does not hold."""

IN_PLANE, IN_SPACE = (1, 0, 2), (4, 6, 1)
"""Where x, z and theta stand among the positions, and velocities, of a planar joint; where x and z
stand among those of a free body, which begin with a quaternion, and its rate among velocities."""

BACKWARDS = -1.0
"""CENIC of 1.51.1 lets a drive run at its desired velocity with the opposite sign."""

WITHIN = 8
"""In so many parts of a look the base is told how fast it is, where steps are the engine's own."""

CENIC = "cenic"
SOLVERS = ("lagged", "similar", "sap", CENIC)
"""The library's models of contact of a discrete plant, and the integrator of a continuous one."""

PLANE = ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))
"""Its columns are z, x and y: a planar joint moves along two axes, and turns about the third."""

LONGEST = 10.0
"""No step that CENIC is told is longer than this many ordinary ones."""

GAINS, SPEED_GAINS = {"p": 1e12, "d": 1e8}, {"p": 0.0, "d": 1e12}
"""Of the drive of a base that moves [N/m, N s/m]: nothing yields, and the ratio is an example's.
Where steps differ, only how fast the base is does not depend on them."""

ACCURACY = 2e-9
"""Error of a step over alpha. CENIC is of first order: its steps go by the root of this, and so
does a rotation's error in units of kappa: 5e-5 at 1e-8, 3e-5 at 2e-9, and no less below."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DrakeSettings(Settings):
    """Settings of Drake, by default its own; None leaves a setting to the library."""

    # a box touches in one point, its deepest; corners are small spheres at those
    geometry: str = setting("box", names=("box", "corners"))
    # a planar joint, and two corners in the middle plane instead of four at the edges
    planar: bool = False
    friction: float = setting(1.0, least=0.0)
    solver: str | None = setting(names=SOLVERS)  # its own is "lagged"
    # of a contact over m/dt^2, dt being the step, or the time between two looks at an engine that
    # chooses its own steps; the library's own is 1e6 N/m, whatever the mass
    stiffness: float | None = setting(above=0.0)
    # time in which "sap" lets a contact relax, over the step
    relaxation: float | None = setting(least=0.0)
    dissipation: float | None = setting(least=0.0)  # of the other solvers, over 1/(p R)
    # speed over p R at which a contact that sticks may slip
    stiction: float | None = setting(above=0.0)
    # of "sap", below which part of what a contact's mass alone would give its stiffness is held
    near_rigid: float | None = setting(least=0.0)
    corner_radius: float = setting(1e-6, above=0.0)  # over the width
    # of "cenic", the error of a step over alpha, by which it chooses its own; without it, it takes
    # those that it is told
    accuracy: float | None = setting(above=0.0, most=1.0)
    floor: str = setting("drive", names=("drive", "position"))  # by its joint's drive, or by place


@cache
def imported_parts() -> SimpleNamespace:
    """Import the library; return all names of its parts together."""
    names: dict[str, Any] = {}
    for part in MODULES:
        names |= vars(imported(f"pydrake.{part}"))
    logging.getLogger("drake").setLevel(logging.ERROR)
    return SimpleNamespace(**names)


class DrakeWorld(Adapter):
    """Bodies on a half-space that does not move, or on a box on a rail."""

    library = staticmethod(imported_parts)
    called = "drake"

    def _build(self, scene: Scene, dt_s: float) -> None:
        settings = self._s
        self._ordinary, self._continuous = dt_s, settings.solver == CENIC
        self.moment = Moment.MIDDLE if settings.accuracy is None else Moment.END
        self._count, self._time, self._problem = 0, 0.0, ""
        self._gravity, self._moving = scene.system.gravity, bool(self._way)
        self._velocity_of, self._rise_of = map(mean_velocity_of, (scene.shaking, scene.heaving))
        self._radius = settings.corner_radius * scene.system.width
        builder = self._library.DiagramBuilder()
        self.plant, self.graph = self._new_plant(scene, builder)
        self.properties = self._new_contact(scene)
        self.ground, self._here = self.plant.world_body(), self._library.RigidTransform()
        self.blocks = self._library.default_model_instance()
        self.floor: Any = None
        self.rail: Any = None
        if self._moving:
            self.floor, self.rail = self._new_floor(scene)
        else:
            self._add_shape(self.ground, self._here, self._library.HalfSpace(), "base")
        turned = None
        if settings.planar:
            turned = self._library.RigidTransform(self._library.RotationMatrix([*map(list, PLANE)]))
        self.bodies = [self._new_body(scene, number, turned) for number in range(len(scene.bodies))]
        self.plant.Finalize()
        self.simulator = self._library.Simulator(builder.Build())
        root = self.simulator.get_mutable_context()
        self.context = self.plant.GetMyMutableContextFromRoot(root)
        self._begin(scene)
        if self._continuous:
            self._integrator = self._new_integrator(scene)
        self.simulator.Initialize()
        if self._moving:
            instance = self.floor.model_instance()
            self.desired = self.plant.get_desired_state_input_port(instance)
        else:
            self.lag_m = None

    def _new_plant(self, scene: Scene, builder: Any) -> Any:
        s, discrete = self._s, not self._continuous
        scale = scene.system.p * scene.system.R
        config = {
            "time_step": self._ordinary if discrete else 0.0,
            "discrete_contact_approximation": s.solver if discrete else None,
            "stiction_tolerance": None if s.stiction is None else s.stiction * scale,
            "sap_near_rigid_threshold": s.near_rigid,
        }
        made = self._library.MultibodyPlantConfig(**given(config))
        return self._library.AddMultibodyPlant(made, builder)

    def _new_contact(self, scene: Scene) -> Any:
        """Return properties of a shape, which has half of a contact's stiffness and relaxation."""
        s, layout = self._s, scene.layout
        stiff, dissipation = s.stiffness, s.dissipation
        if stiff is not None:
            stiff = 2.0 * stiff * layout.carried(layout.contacts[0]) / self._ordinary**2
        if dissipation is not None:
            dissipation = dissipation / (scene.system.p * scene.system.R)
        properties = self._library.ProximityProperties()
        rough = self._library.CoulombFriction(float(s.friction), float(s.friction))
        material = given({"point_stiffness": stiff, "dissipation": dissipation})
        self._library.AddContactMaterial(properties=properties, friction=rough, **material)
        if s.relaxation is not None:
            relaxation = 0.5 * s.relaxation * self._ordinary
            properties.AddProperty("material", "relaxation_time", relaxation)
        return properties

    def _add_shape(self, body: Any, place: Any, shape: Any, name: str) -> None:
        self.plant.RegisterCollisionGeometry(body, place, shape, name, self.properties)

    def _new_floor(self, scene: Scene) -> Any:
        """Return a box on a rail, which a drive leads, and its joint."""
        drake, plant, half = self._library, self.plant, floor_half_size(scene)
        size = [2.0 * x for x in half]
        inertia = drake.SpatialInertia.SolidBoxWithMass(scene.bodies[0].mass, *size)
        floor = plant.AddRigidBody("floor", plant.AddModelInstance("floor"), inertia)
        ends = self.ground.body_frame(), floor.body_frame()
        rail = plant.AddJoint(drake.PrismaticJoint("rail", *ends, [1.0, 0.0, 0.0]))
        gains = drake.PdControllerGains(**(SPEED_GAINS if self._continuous else GAINS))
        plant.AddJointActuator("drive", rail).set_controller_gains(gains)
        below = drake.RigidTransform([0.0, 0.0, -half[2]])
        self._add_shape(floor, below, drake.Box(*size), "base")
        return floor, rail

    def _new_body(self, scene: Scene, number: int, turned: Any) -> Any:
        s, drake, plant, body = self._s, self._library, self.plant, scene.bodies[number]
        name, size = f"block{number or ''}", [2.0 * half for half in half_size(body)]
        inertia = drake.SpatialInertia.SolidBoxWithMass(body.mass, *size)
        if not body.is_homogeneous:
            turning, place = drake.RotationalInertia(*body.inertia), [body.offset, 0.0, 0.0]
            inertia = drake.SpatialInertia.MakeFromCentralInertia(body.mass, place, turning)
        block = plant.AddRigidBody(name, self.blocks, inertia)
        if s.planar:
            ends = (("on the base", self.ground), ("in the plane", block))
            frames = [
                plant.AddFrame(drake.FixedOffsetFrame(f"{name} {where}", end.body_frame(), turned))
                for where, end in ends
            ]
            plant.AddJoint(drake.PlanarJoint(name, *frames))
        if s.geometry == "box" or scene.layout.rests(number):
            self._add_shape(block, self._here, drake.Box(*size), name)
        if s.geometry == "corners":
            corners = touching_spheres(scene, number, self._radius, planar=s.planar)
            for corner, at in enumerate(corners):
                there, ball = drake.RigidTransform(list(at)), drake.Sphere(self._radius)
                self._add_shape(block, there, ball, f"{name} corner {corner}")
        return block

    def _begin(self, scene: Scene) -> None:
        drake, begins = self._library, [body.at for body in scene.bodies]
        if self._s.planar:
            places = [q for at in begins for q in (at.z, at.x, at.theta)]
            speeds = [v for at in begins for v in (at.velocity_z, at.velocity_x, at.rate)]
            self.plant.SetPositionsAndVelocities(self.context, self.blocks, places + speeds)
            return
        for block, at in zip(self.bodies, begins, strict=True):
            turn = drake.RotationMatrix.MakeYRotation(at.theta)
            place = drake.RigidTransform(turn, [at.x, 0.0, at.z])
            self.plant.SetFreeBodyPose(self.context, block, place)
            along, spin = [at.velocity_x, 0.0, at.velocity_z], [0.0, at.rate, 0.0]
            velocity = drake.SpatialVelocity(w=spin, v=along)
            self.plant.SetFreeBodySpatialVelocity(self.context, block, velocity)

    def _new_integrator(self, scene: Scene) -> Any:
        # without an estimate of the error each step goes to where it is told
        told, simulator = self._s.accuracy is None, self.simulator
        longest = LONGEST * self._ordinary if told else self._ordinary
        self._library.ResetIntegratorFromFlags(simulator, scheme=CENIC, max_step_size=longest)
        integrator = simulator.get_mutable_integrator()
        integrator.set_fixed_step_mode(told)
        if self._s.accuracy is not None:
            aim = self._s.accuracy * scene.system.alpha * max(1.0, scene.system.R)
            integrator.set_target_accuracy(aim)
        return integrator

    def step(self, step: Step) -> None:
        """Advance by a step."""
        if self._problem:
            return
        self.plant.mutable_gravity_field().set_gravity_vector((step.pull_x, 0.0, step.pull_z))
        if self._moving:
            self._drive(step.base_x, step.base_velocity)
        self._count += 1
        self._time += step.dt_s
        # a discrete plant changes at the beginning of a step: half of one later it has, once
        self._go_on(self._time if self._continuous else (self._count - 0.5) * self._ordinary)
        if self._moving:
            self._look_back(step.base_x)

    def _go_on(self, end_s: float) -> None:
        """Advance to a time [s], or say why the library gave up."""
        try:
            self.simulator.AdvanceTo(end_s)
        except GIVEN_UP as error:
            self._problem = " ".join(str(error).split())

    def advance(self, end_s: float) -> int:
        """Advance to a time [s] in steps of the engine's own, the base at its mean velocities."""
        if self._problem:
            return 1
        along, up = (
            (of(end_s, end_s) - of(self._time, self._time)) / (end_s - self._time)
            for of in (self._velocity_of, self._rise_of)
        )
        pull = 0.0 if self._moving else -along, 0.0, -self._gravity - up
        self.plant.mutable_gravity_field().set_gravity_vector(pull)
        before = self._integrator.get_num_steps_taken()
        within = np.linspace(self._time, end_s, WITHIN + 1)[1:-1] if self._moving else ()
        for end in (*map(float, within), end_s):
            velocity = self._velocity_of(self._time, end)
            self._place += velocity * (end - self._time)
            if self._moving:
                self._drive(self._place, velocity)
            self._go_on(end)
            if self._problem:
                return 1
            if self._moving:
                self._look_back(self._place)
            self._time = end
        return int(self._integrator.get_num_steps_taken() - before)

    def _drive(self, place: float, velocity: float) -> None:
        """Tell the base's drive where it should be [m], and how fast [m/s]."""
        if self._s.floor == "position":
            self.rail.set_translation(self.context, place)
            velocity = 0.0
        turned = BACKWARDS if self._continuous else 1.0
        self.desired.FixValue(self.context, [place, turned * velocity])

    def _look_back(self, place: float) -> None:
        """Take note of how far the base is from where it should be [m]."""
        self.lag_m = max(self.lag_m, abs(self.rail.get_translation(self.context) - place))

    @property
    def yaw(self) -> float | None:
        """How far the first body has turned; see `engines.world.World`."""
        found = self.plant.GetPositions(self.context, self.blocks)
        return None if self._s.planar else yaw_of(*found[:4].tolist())

    def state(self) -> FloatArray:
        """Read the bodies' poses back."""
        found = self.plant.GetPositionsAndVelocities(self.context, self.blocks).tolist()
        count = len(self._state)
        base_x = self.rail.get_translation(self.context) if self._moving else 0.0
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
        return super().fault() or self._problem

    def close(self) -> None:
        """Release the engine's memory."""
        self.simulator = None

    def _read_back(self, scene: Scene) -> str:
        s, plant, (body, *_), block = self._s, self.plant, scene.bodies, self.bodies[0]
        inspector = self.graph.model_inspector()
        shape = plant.GetCollisionGeometriesForBody(block)[0]
        material = inspector.GetProximityProperties(shape)
        friction = material.GetProperty("material", "coulomb_friction").static_friction()
        inertia = block.CalcSpatialInertiaInBodyFrame(self.context)
        turning = inertia.CalcRotationalInertia().get_moments()
        pairs: dict[str, tuple[Any, Any]] = {
            "mass": (body.mass, block.get_mass(self.context)),
            "moment": (body.about_middle, turning[1]),
            "friction": (s.friction, friction),
            "step": (0.0 if self._continuous else self._ordinary, plant.time_step()),
        }
        if not self._continuous:
            taken = plant.get_discrete_contact_approximation().name.removeprefix("k").lower()
            pairs["solver"] = (s.solver, taken)
        return disagreement(pairs)

    def _script(self, notes: Notes, way: str) -> Script:
        count, planar = len(self.bodies), self._s.planar
        notes.name(
            plant=self.plant, scene_graph=self.graph, properties=self.properties, ground=self.ground
        )
        notes.name(blocks=self.blocks, simulator=self.simulator, context=self.context)
        moving, continuous = bool(way), self._s.solver == CENIC
        if moving:
            notes.name(floor=self.floor, rail=self.rail, desired=self.desired)
        turned = "-base_velocity])  # CENIC turns it round" if continuous else "base_velocity])"
        if planar:
            pose = ("theta = state[3 * number + 2]", f"rate = state[3 * number + {3 * count + 2}]")
        else:
            pose = (
                "theta = 2.0 * math.atan2(state[7 * number + 2], state[7 * number])",
                f"rate = state[6 * number + {7 * count + 1}]",
            )
        along = (IN_PLANE if planar else IN_SPACE)[0]
        words = "Config( Friction( Material( AddProperty Gains( Integrator set_ Sphere("
        return Script(
            imports=("import pydrake.all as drake",),
            settings=notes.quoted(*words.split()),
            # a discrete plant changes at the beginning of a step: half of one later it has, once
            build=(*notes.lines(), f"end = {'0.0' if continuous else '-0.5 * DT'}"),
            step=(
                "global end",
                "plant.mutable_gravity_field().set_gravity_vector((pull_x, 0.0, pull_z))",
                *(f"desired.FixValue(context, [base_x, {turned}",) * moving,
                "end += DT",
                "simulator.AdvanceTo(end)",
            ),
            pose=("state = plant.GetPositionsAndVelocities(context, blocks)", *pose),
            place=f"plant.GetPositions(context, blocks)[{along}]"
            + " - rail.get_translation(context)" * moving,
        )


CONFIG = "MultibodyPlantConfig, drake 1.51.1"
BOTH_CONFIGS = "MultibodyPlantConfig, DefaultProximityProperties, drake 1.51.1"

DOCUMENTED = citations(f"""
step | time_step = 0.001 | {CONFIG}
solver | discrete_contact_approximation = 'lagged', stiction_tolerance = 0.0001 | {CONFIG}
contact | contact_model = 'hydroelastic_with_fallback', compliance_type = 'undefined', that is
    points; point_stiffness = 1000000, hunt_crossley_dissipation = 50 | {BOTH_CONFIGS}
shapes | the table is a <box> with no properties of contact |
    tutorials/authoring_multibody_simulation.ipynb, drake 1.51.1
friction | dynamic_friction = static_friction = 0.5, of a pair 2 a b/(a + b); 1.0 is used |
    DefaultProximityProperties, drake 1.51.1
without effect | penetration_allowance = 0.001, sap_near_rigid_threshold = 1, relaxation_time =
    0.1, contact_surface_representation = 'polygon' | {BOTH_CONFIGS}
floor | 'infinite PD gains for 1-dof joints': a prismatic joint, set_controller_gains,
    get_desired_state_input_port | RobotLocomotion/drake issue 20496; MultibodyPlant, 'Using PD
    controlled actuators', drake 1.51.1
gains | {{1e4, 1}} on a rail that carries 0.1 kg; of 'infinite' ones there is no example: 1e8
    times those are used, and a floor of the block's mass |
    examples/multibody/deformable/deformable_torus.cc
""")

RECOMMENDED = citations("""
solver | similar, where impacts are to be resolved | DiscreteContactApproximation
shapes | small spheres at the corners | contact_model_doxygen.h, Point contact
contact | stiffness by the depth under the weight: 1e7 N/m | the same, Stiffness
""")
"""What it recommends for rigid contact; the stiffness is for 375 kg, and follows the mass."""

PASTED = citations("""
solver | similar, where impacts are to be resolved | DiscreteContactApproximation
shapes | small spheres at the corners | contact_model_doxygen.h, Point contact
contact | 4 m/dt² a contact, 8 m/dt² of each of its two bodies | measured here
""")

TUNED = DrakeSettings(
    geometry="corners",
    planar=True,
    friction=100.0,
    solver=CENIC,
    stiffness=1.0,
    dissipation=1e3,
    stiction=1e-5,
)

LAGGED = "friction goes by the normal force of the last step, which no impact has foreseen"
DEEPEST = "a box touches a half-space in one point, its deepest"

FACTORS = (
    factor(
        ("solver", "relaxation", "near_rigid"),
        level("SAP, relaxation 10", solver="sap", relaxation=10.0, near_rigid=0.0),
        level("SAP, relaxation 1", solver="sap", relaxation=1.0, near_rigid=0.0),
        level("SAP", (DEFAULT,), solver="sap"),
        level("similar", BOTH, solver="similar"),
    ),
    factor("stiffness", level("10", stiffness=10.0), level("0.1", stiffness=0.1)),
    factor(
        "dissipation", level("100", dissipation=1e2), level("1e4", trap=LAGGED, dissipation=1e4)
    ),
    factor("stiction", level("1e-4", stiction=1e-4)),
    factor(
        ("geometry", "planar"),
        level("4 corners", BOTH, geometry="corners", planar=False),
        level("planar box", trap=DEEPEST, geometry="box"),
        traps={"tuned": DEEPEST},
    ),
    factor("corner_radius", level("B/500", corner_radius=2e-3)),
    factor("friction", level("1.3", friction=NO_JAM)),
    moving_base("drive", "position"),
)

NAIVE = default(DrakeSettings(), 1e-3, DOCUMENTED, friction=0.5)

ENGINE = Engine(
    name="drake",
    title="Drake",
    library="pydrake",
    packages=("drake",),
    build=DrakeWorld,
    stacks=True,
    offsets=True,
    presets=(
        NAIVE,
        NAIVE.at_rest(),
        NAIVE.recommended(*RECOMMENDED, solver="similar", geometry="corners", stiffness=0.0133),
        NAIVE.pasted(*PASTED, solver="similar", geometry="corners", stiffness=4.0),
        Preset(name="tuned", settings=TUNED, step=3e-4),
        Preset(
            name="error-controlled",
            title="steps of its own, by its own estimate of the error",
            settings=replace(TUNED, stiffness=2.5e3, accuracy=ACCURACY),
            stepping=Stepping.OWN,
            accuracy_knob=("accuracy", (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 2e-9)),
        ),
    ),
    script=DrakeWorld.script,
    factors=FACTORS,
)
