"""Rapier: how a scene is built, set, stepped and read back.

The library computes in single precision: where a block stands is known to 6e-8 of its size, so that
a step of less than some 1e-6/p has the noise of its contact for a velocity. A tuned preset counts
lengths in heights of the block, from where its centre rests; in metres blocks of one shape err by
their size, those of 30 m by tenths of the peak.
"""

import math
from dataclasses import dataclass, replace
from typing import Any

from engines.declaration import Engine, Help, Precision, Preset, citations, default, landing
from engines.factors import ASLEEP, BOTH, DEFAULT, factor, level, moving_base
from engines.parts import NO_JAM, Adapter, iterations_for, returned, yaw_of
from engines.run.export import Notes, scaled
from engines.scene import Scene
from engines.settings import disagreement, given, one_of, setting
from engines.shapes import Counted, counted, floor_half_size, half_size, touching_spheres
from engines.world import FloatArray, Script, Step

OVERDAMPED = 1e5
"""Damping ratio of a contact that corrects positions and is firm all the same."""

ALOFT = 1e-2
"""A block that sleeps leaning by more than this part of alpha is on one corner; what sleeps on both
leans by what the contact yields: up to 4e-5."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RapierSettings(Counted):
    """Settings of Rapier, by default its own; None leaves a setting to the library."""

    # of corners, small balls where those at the base are
    geometry: str = setting("box", names=("box", "corners"))
    # lock the rotations that lead out of the plane, and put two corners into the middle plane
    # instead of four at the edges; a box has its four either way
    planar: bool = False
    # lock the translation out of the plane: the contact then has no friction
    locked_aside: bool = False
    friction: float = setting(1.0, least=0.0)  # the block's; of a pair the mean counts
    substeps: int | None = setting(least=1)  # in a step
    iterations: int | None = setting(least=1)  # in each
    # those that take out of the velocities what the correction of positions has put in
    stabilization: int | None = setting(least=0)
    # iterations over 1/sin^2(alpha), where they are not given
    sweeps: float | None = setting(above=0.0)
    # of the contact [Hz]; its own is 30, and 60 on what does not move
    frequency: float | None = setting(above=0.0, beside=("damping_ratio",))
    damping_ratio: float | None = setting(above=0.0)  # its own is 10
    # ordinary steps in which a contact corrects a position, in place of the two: in a short step it
    # takes out no more than its share, which else would be a velocity made of rounding
    correction: float | None = setting(above=0.0)
    # gap [units of length] from which on a contact is seen; its own is 0.02
    prediction: float | None = setting(above=0.0)
    recycling: bool | None = None  # take contacts from the last step where bodies have hardly moved
    # part of the last step's impulses from which the solver starts; they are not scaled by the
    # ratio of two steps
    warm_starting: float | None = setting(least=0.0, most=1.0)
    # give each contact a friction of its own instead of one to all four
    coulomb: bool | None = None
    friction_in_bias_pass: bool | None = None  # solve friction, too, where a step corrects depths
    # a block that has hardly moved for half a second is no longer simulated
    sleeping: bool | None = None
    units: float | None = setting(above=0.0)
    centred: bool = False
    # half the depth of the base over the height of the block. Contacts are looked for from the
    # middle of the base: the deeper that is, the more coarsely
    base_depth: float = setting(1.0, above=0.0)
    # over the height. On a deep base a ball whose centre is rounded to where the surface is has no
    # contact for a step
    corner_radius: float = setting(1e-5, above=0.0)
    # give the sliding velocity of the corner about which the block turns back to it, by the
    # velocity of the base; not in the steps of an impact
    reflection: bool = False
    # how a base that moves is moved: by a target for the end of the step or its velocity, which the
    # library leads it by; by both its place and its velocity; by position alone
    floor: str = setting("target", names=("target", "velocity", "both", "position"))
    restitution: float = setting(0.0, least=0.0, most=1.0)
    base_restitution: float | None = setting(least=0.0, most=1.0)  # the block's by default


class RapierWorld(Adapter):
    """Bodies on a kinematic box, whether that moves or not."""

    library = "rapier3d"
    called = "rapier"

    def _build(self, scene: Scene, dt_s: float) -> None:
        s = self._s
        self._led = self._way in ("target", "velocity")
        self._driven = bool(self._way) or s.reflection
        self._unit, self._sunk = s.unit_of(scene), s.sunk_of(scene)
        self._half = counted(half_size(scene.bodies[0]), self._unit)
        self._iterations = iterations_for(scene, s.iterations, s.sweeps)
        self.world = self._library.PhysicsWorld()
        self.parameters = self.world.integration_parameters
        self.named: dict[str, list[Any]] = {"softness": [], "ball": []}  # as a script calls them
        self._set_solver(dt_s)
        self.base = self._new_base(scene)
        self.bodies = [self._new_body(scene, number) for number in range(len(scene.bodies))]
        self._body = self.bodies[0]

    def _set_solver(self, dt_s: float) -> None:
        s = self._s
        settings = {
            "num_solver_iterations": s.substeps,
            "num_internal_pgs_iterations": self._iterations,
            "num_internal_stabilization_iterations": s.stabilization,
            "normalized_prediction_distance": s.prediction,
            "contact_recycling": s.recycling,
            "warmstart_coefficient": s.warm_starting,
            "friction_in_bias_pass": s.friction_in_bias_pass,
        }
        for name, value in given(settings).items():
            setattr(self.parameters, name, value)
        if s.coulomb is not None:
            self.parameters.friction_model = self._library.FrictionModel.COULOMB
        spring = s.frequency, s.damping_ratio
        if s.correction is not None:
            # a spring of frequency f and damping ratio z takes the part dt / (dt + z / (pi f)) of a
            # depth out of it in a step dt
            spring = OVERDAMPED / (math.pi * s.correction * dt_s), OVERDAMPED
        if spring[0] is not None:
            soft = self._library.SpringCoefficients(*spring)
            self.parameters.contact_softness = self.parameters.static_contact_softness = soft
            self.named["softness"].append(soft)

    def _new_base(self, scene: Scene) -> Any:
        s, kind = self._s, self._library.RigidBody
        x, y, z = floor_half_size(scene)
        x, y, z = counted((x, y, s.base_depth * z), self._unit)
        floor = self._library.Collider.cuboid(x, y, z).translation((0.0, 0.0, -z))
        restitution = s.restitution if s.base_restitution is None else s.base_restitution
        floor = floor.friction(float(s.friction)).restitution(restitution)
        targeted = self._way == "target"
        base = kind.kinematic_position_based() if targeted else kind.kinematic_velocity_based()
        base = base.translation((0.0, 0.0, -self._sunk))
        return self.world.rigid_bodies[self.world.add_body(base, [floor])]

    def _new_body(self, scene: Scene, number: int) -> Any:
        s, unit, body = self._s, self._unit, scene.bodies[number]
        at, collider, corners = body.at, self._library.Collider, s.geometry == "corners"
        half = counted(half_size(body), unit)
        if corners:
            radius = s.corner_radius * scene.bodies[0].height
            ball = collider.ball(radius * unit).density(0.0)
            self.named["ball"].append(ball)
            places = touching_spheres(scene, number, radius, planar=s.planar)
            shapes = [ball.translation(counted(place, unit)) for place in places]
            if scene.layout.rests(number):
                shapes.append(collider.cuboid(*half).density(0.0))
        else:
            dense = body.density / unit**3 if body.is_homogeneous else 0.0
            shapes = [collider.cuboid(*half).density(dense)]
        friction = float(s.friction)  # the mean of two counts
        shapes = [shape.friction(friction).restitution(s.restitution) for shape in shapes]
        made = self._library.RigidBody.dynamic()
        made = made.translation((at.x * unit, 0.0, at.z * unit - self._sunk))
        if not at.at_rest:
            mass_at = body.mass_at
            velocity = (mass_at.velocity_x * unit, 0.0, mass_at.velocity_z * unit)
            made = made.rotation((0.0, at.theta, 0.0)).linvel(velocity).angvel((0.0, at.rate, 0.0))
        if s.planar:
            made = made.enabled_rotations((False, True, False))
            made = made.enabled_translations((True, not s.locked_aside, True))
        if s.sleeping is not None:
            made = made.can_sleep(s.sleeping)
        if corners or not body.is_homogeneous:
            inertia = tuple(moment * unit**2 for moment in body.inertia)
            mass = self._library.MassProperties((body.offset * unit, 0.0, 0.0), body.mass, inertia)
            made = made.additional_mass_properties(mass)
        block = self.world.rigid_bodies[self.world.add_body(made, shapes)]
        block.recompute_mass_properties_from_colliders(self.world.colliders)  # else a step late
        return block

    def step(self, step: Step) -> None:
        """Advance by a step."""
        if step.dt_s != self._dt:
            self.parameters.dt = step.dt_s
        self.world.gravity = (step.pull_x * self._unit, 0.0, step.pull_z * self._unit)
        if self._way == "target":
            self.base.set_next_kinematic_translation((step.base_x * self._unit, 0.0, -self._sunk))
        elif self._led:
            along = step.base_x * self._unit - self._place
            self.base.linvel = (along / step.dt_s, 0.0, 0.0)
        elif self._driven:
            self._drive(step)
        self.world.step()
        self._dt = step.dt_s
        self._came(step, self.base.translation.x if self._led else None)

    @property
    def yaw(self) -> float | None:
        """How far the first body has turned; see `engines.world.World`."""
        turn = self._body.rotation
        return None if self._s.planar else yaw_of(turn.w, turn.i, turn.j, turn.k)

    def state(self) -> FloatArray:
        """Read the bodies' poses back."""
        for number, body in enumerate(self.bodies):
            at, turn = body.translation, body.rotation
            theta = 2.0 * math.atan2(turn.j, turn.w)
            x, z = (at.x - self._place) / self._unit, (at.z + self._sunk) / self._unit
            self._state[number] = x, z, theta, body.angvel.y
        return self._state

    def fault(self) -> str:
        """Say which setting was not taken, or that the block sleeps where none can rest."""
        if self._body.is_sleeping and abs(self.state()[0, 2]) > ALOFT * self._scene.system.alpha:
            return "the library put the block to sleep aloft"
        step = {"dt": (self._dt or None, self.parameters.dt)}
        return super().fault() or disagreement(step, Precision.SINGLE.value)

    def close(self) -> None:
        """Release the engine's memory."""
        self.world.clear()

    def _drive(self, step: Step) -> None:
        """Set the base's place and velocity, by which the pivot is given its own back, too."""
        back = returned(step, self._dt) if self._s.reflection else 0.0
        speed = step.base_velocity * self._unit if self._way == "both" else 0.0
        slip = 0.0
        if back:
            corner = (step.side * self._half[0], 0.0, -self._half[2])
            at = self._body.position.transform_point(corner)
            slip = self._body.velocity_at_point(at).x - self._speed
        self.base.translation = (self._place, 0.0, -self._sunk)
        self.base.linvel = (speed - back * slip, 0.0, 0.0)
        self._speed = speed

    def _read_back(self, scene: Scene) -> str:
        base, own = (self.world.colliders[it.colliders[0]] for it in (self.base, self._body))
        pairs = {
            "friction": (self._s.friction, 0.5 * (base.friction + own.friction)),
            "restitution": (self._s.restitution, own.restitution),
            "iterations": (self._iterations, self.parameters.num_internal_pgs_iterations),
            "substeps": (self._s.substeps, self.parameters.num_solver_iterations),
        }
        for number, body in enumerate(scene.bodies):
            pairs[f"mass {number}"] = (body.mass, self.bodies[number].mass)
        return disagreement(pairs, Precision.SINGLE.value)

    def _script(self, notes: Notes, way: str) -> Script:
        unit = self._unit
        notes.name(world=self.world, floor=self.base, **self.named)
        x, velocity = scaled("base_x", unit), scaled("base_velocity", unit)
        moves = {
            "target": [f"floor.set_next_kinematic_translation(({x}, 0.0, floor.translation.z))"],
            "velocity": [f"floor.linvel = ({x} - floor.translation.x) / DT, 0.0, 0.0"],
            "both": [
                f"floor.translation = {x} - DT * {velocity}, 0.0, floor.translation.z",
                f"floor.linvel = {velocity}, 0.0, 0.0",
            ],
            "": [],
        }
        one_of("floor of a script", way, tuple(moves))
        under = {"": "", "both": f" - {x}"}.get(way, " - floor.translation.x")
        return Script(
            imports=("import rapier3d as rapier",),
            settings=(
                f"world.integration_parameters.dt = {self._ordinary!r}",
                *notes.quoted("parameters.", "Spring", ".friction(", "can_sleep", "enabled_"),
            ),
            build=(*notes.lines(), "world.integration_parameters.dt = DT"),
            step=(
                f"world.gravity = {scaled('pull_x', unit)}, 0.0, {scaled('pull_z', unit)}",
                *moves[way],
                "world.step()",
            ),
            pose=(
                "turn = bodies[number].rotation",
                "theta, rate = 2.0 * math.atan2(turn.j, turn.w), bodies[number].angvel.y",
            ),
            place=f"(bodies[0].translation.x{under}) / {unit!r}",
        )


TUNED = RapierSettings(
    geometry="corners",
    planar=True,
    friction=NO_JAM,
    substeps=1,
    sweeps=10.0,
    stabilization=0,
    correction=10.0,
    recycling=False,
    warm_starting=0.0,
    sleeping=False,
    units=1.0,
    centred=True,
    base_depth=0.1,
    floor="both",
)

LANDING = replace(TUNED, reflection=True)

RECYCLED = "a contact of an earlier step: the block slides off its pivot"
FRICTIONLESS = "a contact whose body cannot move aside has no friction at all"
WITHOUT_NORMAL = "a ball whose centre rounds onto a surface has no contact there for a step"
SMOOTH = "the library's own friction: a block of H/B = 2 slides before it rocks"

DOCUMENTED = citations("""
step | 1/60 s, the default | IntegrationParameters.dt
substeps | 4, the default | IntegrationParameters.num_solver_iterations
sleeping | on, the default | RigidBodyBuilder.can_sleep
friction | 0.5, of a pair the mean; here 1 | ColliderBuilder.friction
friction | simplified, one for all points; not solved where depths are corrected |
    IntegrationParameters.friction_model, friction_in_bias_pass
contact | a spring of 30 Hz, damping ratio 10; 60 Hz on what does not move |
    IntegrationParameters.contact_softness, static_contact_softness
contact | from 0.02 away, and kept while bodies move by less than 0.05 |
    IntegrationParameters.normalized_prediction_distance, contact_recycling
iterations | 1 a substep and 1 of stabilization, from all of the last impulses |
    IntegrationParameters.num_internal_pgs_iterations, warmstart_coefficient
without effect | allowed_linear_error 0.005, max_corrective_velocity 3, max_linear_velocity 400,
    max_ccd_substeps 1, contact_clustering; no damping | IntegrationParameters, RigidBodyBuilder
floor | kinematic_position_based, set_next_kinematic_translation; shown second: linvel of one that
    is velocity-based | rapier.rs, user guide for Python, Common recipes: Making a moving platform
""")
"""What its documentation sets, in rapier3d 0.36.1."""

RECOMMENDED = citations("""
step | 1/120 s | rapier.rs, user guide for Python, Integration parameters
substeps | 8, for a more accurate simulation | the same page
friction_model | Coulomb, the more accurate one | integration_parameters.rs
""")

PASTED = citations("""
substeps | 8, for a more accurate simulation | rapier.rs, user guide for Python
contact | 1000 Hz, damping ratio 1, from 0.001 away | measured here
contact | neither taken from the last step nor started from it | measured here
iterations | none of stabilization | measured here
sleeping | off: gravity that turns wakes nothing | measured here
""")

FACTORS = (
    factor(
        ("frequency", "damping_ratio", "correction"),
        level("1e3 Hz", frequency=1e3, damping_ratio=1.0, correction=None),
        level("1e6 Hz", frequency=1e6, damping_ratio=1.0, correction=None),
        level("1 step", correction=1.0),
        level("1000 steps", correction=1000.0),
        name="contact spring",
    ),
    factor("recycling", traps={"tuned": RECYCLED}, name="contact recycling"),
    ASLEEP,
    factor("locked_aside", level("y locked", trap=FRICTIONLESS, locked_aside=True), name="locks"),
    factor("stabilization", traps={"default": "without it a pivot slides away"}),
    factor("substeps"),
    factor(
        ("iterations", "sweeps"), level("10", BOTH, iterations=10), level("1000", iterations=1000)
    ),
    factor("warm_starting"),
    factor("coulomb", level("Coulomb", BOTH, coulomb=True), name="friction model"),
    factor(
        "friction_in_bias_pass",
        level("on", BOTH, friction_in_bias_pass=True),
        name="friction while depths are corrected",
    ),
    factor("friction", level("0.5, the library's own", (DEFAULT,), SMOOTH, friction=0.5)),
    factor(
        ("geometry", "planar"),
        level("4 corners, free", planar=False),
        level("planar box", geometry="box"),
    ),
    factor("units", level("1.5 a height", units=1.5)),
    factor("centred", name="origin"),
    factor(
        ("base_depth", "corner_radius"),
        level("1 H", base_depth=1.0),
        level("1 H, corners of 1e-7 H", trap=WITHOUT_NORMAL, base_depth=1.0, corner_radius=1e-7),
        name="depth of the base",
        by_default=False,
    ),
    factor(
        "corner_radius", level("H/1000", corner_radius=1e-3), level("1e-7 H", corner_radius=1e-7)
    ),
    moving_base("both", "target", "velocity", "position"),
)

NAIVE = default(RapierSettings(), 1.0 / 60.0, DOCUMENTED, friction=0.5)

ENGINE = Engine(
    name="rapier",
    title="Rapier",
    library="rapier3d",
    build=RapierWorld,
    stacks=True,
    offsets=True,
    presets=(
        NAIVE,
        replace(NAIVE.at_rest(), rest_s=0.0),  # it would count as time to fall asleep
        NAIVE.recommended(*RECOMMENDED, step_s=1.0 / 120.0, substeps=8, coulomb=True),
        NAIVE.pasted(
            *PASTED,
            substeps=8,
            stabilization=0,
            frequency=1e3,
            damping_ratio=1.0,
            prediction=1e-3,
            recycling=False,
            warm_starting=0.0,
            sleeping=False,
        ),
        Preset(name="tuned", settings=TUNED, step=5e-4),
        landing(LANDING, {Help.REFLECTION: {"reflection": False}}, stacked=None),
    ),
    precision=Precision.SINGLE,
    shortest_step=3e-6,
    script=RapierWorld.script,
    factors=FACTORS,
)
