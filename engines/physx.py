"""PhysX, by SAPIEN and on the CPU: settings, presets, and how a scene is built, stepped, read back.

The library computes in single precision. Its solver TGS moves a body in every iteration, in the
world: of v dt/iterations nothing is left below half of what its place is told apart by, so that a
body slower than (ulp/2) iterations/dt stands still, the more so the shorter the step and the
farther from the origin it is.
"""

import math
from dataclasses import dataclass, replace
from typing import Any

from engines.declaration import Engine, Help, Precision, Preset, citations, default, landing
from engines.factors import BOTH, DEFAULT, factor, level, moving_base
from engines.parts import NO_JAM, Adapter, returned, yaw_of
from engines.run.export import Notes, scaled
from engines.scene import Scene
from engines.settings import disagreement, given, setting
from engines.shapes import Counted, counted, floor_half_size, half_size, touching_spheres
from engines.world import FloatArray, Script, Step

MOST = 255
"""Iterations at most: the library counts them in eight bits."""

CORNER, BASE_DEPTH = 1e-3, 1e-2
"""Radius of corner balls and half the depth of the base over the height of the block: contacts are
looked for from the middle of the base, the deeper that is, the more coarsely."""

NOTHING = 1e-9
"""A pull within this part of the weight is the weight: a difference's rounding wakes a block."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PhysxSettings(Counted):
    """Settings of PhysX, by default those of SAPIEN; None leaves a setting to it."""

    # of corners, small balls where those at the base are
    geometry: str = setting("box", names=("box", "corners"))
    # lock what leads out of the plane, and put two corners into the middle plane instead of four at
    # the edges; a box has its four either way
    planar: bool = False
    friction: float = setting(1.0, least=0.0)  # of both; SAPIEN's own is 0.3
    # the solver is TGS, which moves bodies in every iteration, or PGS; its own is TGS
    tgs: bool | None = None
    # with the correction of depths; its own are 10
    iterations: int | None = setting(least=1, most=MOST)
    velocity_iterations: int | None = setting(least=0, most=MOST)  # and then without; 1
    # velocity below which no impact bounces [m/s]; its own is 2
    bounce_threshold: float | None = setting(above=0.0)
    # fastest correction of a depth [m/s]; its own has no limit. A rounding of the depth over a
    # short step is a velocity, too
    depenetration: float | None = setting(above=0.0)
    # part of the angular velocity lost in a second; its own is 0.05
    angular_damping: float | None = setting(least=0.0)
    # a block that has hardly moved for 0.4 s is no longer simulated; its own is on
    sleeping: bool | None = None
    # gap [units of length] below which a contact holds, half of it on each side; its own is 0.01. A
    # block that is held before it strikes does so in two steps
    contact_offset: float | None = setting(above=0.0)
    units: float | None = setting(above=0.0)
    centred: bool = False
    # give the sliding velocity of the corner about which the block turns back to it, by the
    # velocity of the base; not in the steps of an impact
    reflection: bool = False
    # how a base that moves is moved: by a target for the end of the step; as a belt whose targets
    # are where it is, set back before by what it goes in a step, since of a far place less is told
    # apart; or by position alone
    floor: str = setting("target", names=("target", "belt", "position"))
    restitution: float = setting(0.1, least=0.0, most=1.0)  # of both; SAPIEN's own


class PhysxWorld(Adapter):
    """Bodies on a kinematic box, whether that moves or not."""

    library = "sapien"

    def _build(self, scene: Scene, dt_s: float) -> None:
        settings = self._s
        self._unit, self._sunk = settings.unit_of(scene), settings.sunk_of(scene)
        self._reflects, self._weight = settings.reflection, scene.system.gravity
        self._half = counted(half_size(scene.bodies[0]), self._unit)
        self._wanted = self._set_library()
        self.system = self._library.physx.PhysxCpuSystem()
        self.stage = self._library.Scene([self.system])
        friction = float(settings.friction)
        self.material = self._library.physx.PhysxMaterial(friction, friction, settings.restitution)
        self.base = self._new_base(scene)
        self.bodies = [self._new_body(scene, number) for number in range(len(scene.bodies))]

    def _set_library(self) -> tuple[dict[str, Any], ...]:
        """Set, all together, what the library has once for a process; return what was set."""
        s, unit, physx = self._s, self._unit, self._library.physx
        bounce = None if s.bounce_threshold is None else s.bounce_threshold * unit
        sleep = None if s.sleeping in (None, True) else 0.0
        many = {"solver_position_iterations": s.iterations}
        many["solver_velocity_iterations"] = s.velocity_iterations
        scene = given({"bounce_threshold": bounce, "enable_tgs": s.tgs})
        body = given({**many, "sleep_threshold": sleep})
        shape = given({"contact_offset": s.contact_offset})
        physx.set_scene_config(gravity=(0.0, 0.0, -self._weight * unit), **scene)
        physx.set_body_config(**body)
        physx.set_shape_config(**shape)
        return scene, body, shape

    def _new_base(self, scene: Scene) -> Any:
        x, y, z = floor_half_size(scene)
        half = counted((x, y, BASE_DEPTH * z), self._unit)
        floor = self._library.physx.PhysxCollisionShapeBox(half, self.material)
        floor.local_pose = self._library.Pose((0.0, 0.0, -half[2]))
        base = self._library.physx.PhysxRigidDynamicComponent()
        base.attach(floor)
        base.kinematic = True
        self._place_at(base, (0.0, 0.0, -self._sunk))
        return base

    def _new_body(self, scene: Scene, number: int) -> Any:
        s, unit, body, physx = self._s, self._unit, scene.bodies[number], self._library.physx
        at, made = body.at, physx.PhysxRigidDynamicComponent()
        half = counted(half_size(body), unit)
        if s.geometry == "box":
            box = physx.PhysxCollisionShapeBox(half, self.material)
            box.density = body.density / unit**3
            made.attach(box)
        else:
            radius = CORNER * scene.bodies[0].height
            for corner in touching_spheres(scene, number, radius, planar=s.planar):
                ball = physx.PhysxCollisionShapeSphere(radius * unit, self.material)
                ball.local_pose = self._library.Pose(counted(corner, unit))
                made.attach(ball)
            if scene.layout.rests(number):
                made.attach(physx.PhysxCollisionShapeBox(half, self.material))
        if s.geometry != "box" or not body.is_homogeneous:
            made.mass = body.mass
            made.inertia = tuple(moment * unit**2 for moment in body.inertia)
            place = ((body.offset * unit, 0.0, 0.0),) if body.offset else ()
            made.cmass_local_pose = self._library.Pose(*place)
        if s.angular_damping is not None:
            made.angular_damping = s.angular_damping
        if s.depenetration is not None:
            made.max_depenetration_velocity = s.depenetration * unit
        if s.planar:
            made.set_locked_motion_axes([False, True, False, True, False, True])
        turn = (math.cos(0.5 * at.theta), 0.0, math.sin(0.5 * at.theta), 0.0)
        self._place_at(made, (at.x * unit, 0.0, at.z * unit - self._sunk), turn)
        if not at.at_rest:
            mass_at = body.mass_at
            made.linear_velocity = (mass_at.velocity_x * unit, 0.0, mass_at.velocity_z * unit)
            made.angular_velocity = (0.0, at.rate, 0.0)
        return made

    def _place_at(self, component: Any, *pose: Any) -> None:
        entity = self._library.Entity()
        entity.add_component(component)
        entity.pose = self._library.Pose(*pose)
        self.stage.add_entity(entity)

    def step(self, step: Step) -> None:
        """Advance by a step."""
        if self._way or self._reflects:
            self._lead(step)
        if step.dt_s != self._dt:
            self.system.timestep = self._dt = step.dt_s
        x, z = step.pull_x, step.pull_z + self._weight
        if abs(x) + abs(z) > NOTHING * self._weight:
            pull = (x * self._unit, 0.0, z * self._unit)
            for body in self.bodies:
                body.add_force_torque(pull, (0.0, 0.0, 0.0), "acceleration")
        self.system.step()
        led = self._way not in ("", "belt")
        self._came(step, float(self.base.entity_pose.p[0]) if led else None)

    @property
    def yaw(self) -> float | None:
        """How far the first body has turned; see `engines.world.World`."""
        return None if self._s.planar else yaw_of(*self.bodies[0].entity_pose.q.tolist())

    def state(self) -> FloatArray:
        """Read the bodies' poses back."""
        for number, body in enumerate(self.bodies):
            pose = body.entity_pose
            (x, _, z), turn = pose.p.tolist(), pose.q.tolist()
            x, z = (x - self._place) / self._unit, (z + self._sunk) / self._unit
            rate = float(body.angular_velocity[1])
            self._state[number] = x, z, 2.0 * math.atan2(turn[2], turn[0]), rate
        return self._state

    def fault(self) -> str:
        """Say which setting was not taken."""
        step = {"timestep": (self._dt or None, self.system.timestep)}
        return super().fault() or disagreement(step, Precision.SINGLE.value)

    def close(self) -> None:
        """Release the engine's memory."""
        self.stage.clear()

    def _lead(self, step: Step) -> None:
        """Let the library lead the base to its place, from where its velocity is as wanted."""
        place, belt = step.base_x * self._unit if self._way else 0.0, self._way == "belt"
        if self._way == "position":
            self.base.entity.pose = self._at(place)
            return
        if belt or self._reflects:
            back = returned(step, self._dt) if self._reflects else 0.0
            slip = self._slip(step.side) if back else 0.0
            pace = step.base_velocity * self._unit if belt else (place - self._place) / step.dt_s
            place = 0.0 if belt else place
            self._speed = pace - back * slip
            self.base.entity.pose = self._at(place - self._speed * step.dt_s)
        self.base.set_kinematic_target(self._at(place))

    def _at(self, x: float) -> Any:
        return self._library.Pose((x, 0.0, -self._sunk))

    def _slip(self, side: float) -> float:
        """Return the velocity [units/s] at which the corner at a side slides on the base."""
        _, _, theta, rate = self.state()[0]
        level = side * self._half[0] * math.sin(theta) + self._half[2] * math.cos(theta)
        return float(self.bodies[0].linear_velocity[0]) - rate * level - self._speed

    def _read_back(self, scene: Scene) -> str:
        s, block = self._s, self.bodies[0]
        shape = block.collision_shapes[0]
        places = self.system.config, block, shape
        pairs: dict[str, Any] = {
            name: (value, getattr(place, name))
            for place, settings in zip(places, self._wanted, strict=True)
            for name, value in settings.items()
        }
        for number, (body, found) in enumerate(zip(scene.bodies, self.bodies, strict=True)):
            pairs[f"mass {number}"] = (body.mass, found.mass)
            moment = body.inertia[1] * self._unit**2
            pairs[f"moment {number}"] = (moment, float(found.inertia[1]))
        material = shape.physical_material
        pairs |= {
            "static friction": (s.friction, material.static_friction),
            "dynamic friction": (s.friction, material.dynamic_friction),
            "restitution": (s.restitution, material.restitution),
            "angular damping": (s.angular_damping, block.angular_damping),
            "locks": (s.planar, any(block.locked_motion_axes)),
        }
        return disagreement(pairs, Precision.SINGLE.value)

    def _script(self, notes: Notes, way: str) -> Script:
        unit, weight = self._unit, self._weight
        notes.name(system=self.system, stage=self.stage, material=self.material, floor=self.base)
        x, velocity = scaled("base_x", unit), scaled("base_velocity", unit)
        far = "0.0, floor.entity_pose.p[2]]))"
        moves = {
            "": [],
            "belt": [
                f"floor.entity.pose = sapien.Pose([-DT * {velocity}, {far[:-1]}",
                f"floor.set_kinematic_target(sapien.Pose([0.0, {far}",
            ],
            "target": [f"floor.set_kinematic_target(sapien.Pose([{x}, {far}"],
            "position": [f"floor.entity.pose = sapien.Pose([{x}, {far[:-1]}"],
        }
        under = {"": "", "belt": f" - {x}"}.get(way, " - float(floor.entity_pose.p[0])")
        pull = ", 0.0, ".join(scaled(axis, unit) for axis in ("pull_x", f"(pull_z + {weight!r})"))
        words = "_config( Material( damping depenetration locked_motion Sphere block.inertia"
        return Script(
            imports=("import sapien",),
            settings=notes.quoted(*words.split()),
            build=(*notes.lines(), "system.timestep = DT"),
            step=(
                f"pull = {pull}",
                f"if abs(pull_x) + abs(pull_z + {weight!r}) > {NOTHING * weight!r}:",
                "    for body in bodies:",
                "        body.add_force_torque(pull, (0.0, 0.0, 0.0), 'acceleration')",
                *moves[way],
                "system.step()",
            ),
            pose=(
                "turn = bodies[number].entity_pose.q",
                "theta = 2.0 * math.atan2(turn[2], turn[0])",
                "rate = float(bodies[number].angular_velocity[1])",
            ),
            place=f"(float(bodies[0].entity_pose.p[0]){under}) / {unit!r}",
        )


TUNED = PhysxSettings(
    geometry="corners",
    planar=True,
    friction=NO_JAM,
    tgs=False,
    iterations=100,
    velocity_iterations=100,
    depenetration=1e-6,
    angular_damping=0.0,
    sleeping=False,
    contact_offset=1e-6,
    units=1.0,
    centred=True,
    restitution=0.0,
)

EVERY: dict[str, Any] = {"iterations": MOST, "velocity_iterations": MOST}

LANDING = replace(TUNED, **EVERY, contact_offset=None, reflection=True, floor="belt")

SHAPES = "SAPIEN 3.0.3, sapien/pysapien/physx.pyi"
TUNING = "Isaac Lab 3.0.0, concepts/solver-tuning/tune_physx.rst"

DOCUMENTED = citations(f"""
step | 1/100 s | SAPIEN 3.0.3, sapien/example/hello_world.py
iterations | 10 of position, 1 of velocity, by default | {SHAPES}: set_body_config
solver | enable_tgs = True, the default | {SHAPES}: set_scene_config
bounce_threshold | 2.0, the default | {SHAPES}: set_scene_config
sleeping | sleep_threshold = 0.005, the default | {SHAPES}: set_body_config
contact_offset | 0.01, the default | {SHAPES}: set_shape_config
contact_offset | rest_offset 0, the default | {SHAPES}: set_shape_config
manifolds | enable_pcm = True, the default | {SHAPES}: set_scene_config
damping | angular 0.05, linear 0 | {SHAPES}: PhysxRigidDynamicComponent
restitution | 0.1, the default | physx.get_default_material()
friction | 0.3, of a pair the mean; here 1 | physx.get_default_material()
without effect | enable_friction_every_iteration, no enable_ccd, max_angular_velocity 100,
    max_depenetration_velocity 1e32 | {SHAPES}: PhysxSceneConfig, PhysxRigidDynamicComponent
floor | kinematic, set_kinematic_target | {SHAPES}: PhysxRigidDynamicComponent
""")
"""What its documentation sets."""

RECOMMENDED = citations(f"""
step | dt = 1/120 s, where to start: 'not a universal recommendation' | {TUNING}
iterations | at most 64 of position and 4 of velocity: all of them here | {TUNING}
solver | TGS, the first candidate | {TUNING}
bounce_threshold | 0.2 m/s | {TUNING}
""")

PASTED = citations("""
solver | PGS | measured here
iterations | 50 of position | measured here
contact_offset | 1e-4: of 0.01 a corner is held before it strikes | measured here
shapes | four balls at the lower corners, the body's own inertia | measured here
damping, restitution, sleeping | none | measured here
""")

STUCK = "of a slow move nothing is left in single precision: TGS adds it to the place in parts"
SMOOTH = "SAPIEN's own friction: the block slides before it rocks"

FACTORS = (
    factor("tgs", level("TGS", trap=STUCK, tgs=True), level("PGS", (DEFAULT,), tgs=False)),
    factor(tuple(EVERY), level("255, 255", **EVERY), name="iterations"),
    factor("depenetration"),
    factor("contact_offset"),
    factor("angular_damping"),
    factor("bounce_threshold", level("0.01 m/s", BOTH, bounce_threshold=0.01)),
    factor("restitution"),
    factor(
        ("geometry", "planar"),
        level("4 corners, free", planar=False),
        level("planar box", geometry="box"),
        level("4 corners", (DEFAULT,), geometry="corners"),
    ),
    factor("units", level("metres", units=None)),
    factor("centred", name="origin"),
    factor("sleeping", level("on", sleeping=True), by_default=False),
    factor("friction", level("0.3, SAPIEN's own", (DEFAULT,), SMOOTH, friction=0.3)),
    moving_base("target", "belt", "position"),
)

NAIVE = default(PhysxSettings(), 0.01, DOCUMENTED, friction=0.3)

ENGINE = Engine(
    name="physx",
    title="PhysX",
    library="sapien",
    build=PhysxWorld,
    stacks=True,
    offsets=True,
    presets=(
        NAIVE,
        NAIVE.at_rest(),
        NAIVE.recommended(
            *RECOMMENDED,
            step_s=1.0 / 120.0,
            tgs=True,
            iterations=64,
            velocity_iterations=4,
            bounce_threshold=0.2,
        ),
        NAIVE.pasted(
            *PASTED,
            geometry="corners",
            tgs=False,
            iterations=50,
            contact_offset=1e-4,
            angular_damping=0.0,
            restitution=0.0,
            sleeping=False,
        ),
        Preset(name="tuned", settings=TUNED, step=1e-3),
        landing(LANDING, {Help.REFLECTION: {"reflection": False}}, stacked=None),
    ),
    precision=Precision.SINGLE,
    shortest_step=3e-6,
    script=PhysxWorld.script,
    factors=FACTORS,
)
