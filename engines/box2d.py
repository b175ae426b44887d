"""Box2D: settings, presets, and how a scene is built, set, read back and stepped.

The library computes in single precision, and clamps without a word what moves further than two
units of length in a step: a tuned preset counts in parts of the block's height. Contacts lie
halfway between the surfaces of two shapes, so that half of the pivot's margin is the corner's
radius, and half is the height by which its floor is raised.
"""

from dataclasses import dataclass, replace
from typing import Any

from engines.declaration import Engine, Help, Precision, Preset, citations, default, landing
from engines.factors import ASLEEP, factor, level, moving_base
from engines.parts import NO_JAM, Adapter, fall, iterations_for, returned
from engines.run.export import Notes, scaled
from engines.scene import BASE, Scene
from engines.settings import disagreement, setting
from engines.shapes import Counted, floor_reach
from engines.world import ContactPhase, FloatArray, Script, Step

DEEPER = 30.0
"""By how many of a pivot's reaches a free corner above is out of reach before an impact: in a swing
a beam sinks by two or three."""

MANUAL_ITERATIONS = 6
"""For velocities: of the library's own hello world."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Box2DSettings(Counted):
    """Settings of Box2D, by default those of its own first example."""

    # one polygon on another, or circles at the corners, each on a polygon of its own
    geometry: str = setting("box", names=("box", "corners"))
    friction: float = setting(1.0, least=0.0)
    iterations: int | None = setting(None, least=1)
    position_iterations: int = setting(2, least=0)
    # iterations over 1/sin^2(alpha), where they are not given; the manual's 6 if neither is
    sweeps: float | None = setting(None, above=0.0)
    units: float | None = setting(None, above=0.0)
    centred: bool = False
    # a floor is lowered by the skins that the library gives polygons, so that it acts where it is
    skins_below: bool = False
    continuous: bool = True  # look for impacts within a step
    # gap over (alpha p dt)^2 H up to which the pivot is kept in contact
    margin: float | None = setting(None, above=0.0)
    # the pivot's velocity is given back in a swing, by the velocity of its floor
    reflection: bool = False
    sleeping: bool = True  # a block that has hardly moved for half a second is left alone
    floor: str = setting("velocity", names=("velocity", "both", "position"))
    restitution: float = setting(0.0, least=0.0, most=1.0)  # of a pair the larger one counts


class Box2DWorld(Adapter):
    """Bodies on one kinematic body, or on one for each corner of a block."""

    library = "Box2D"

    def _build(self, scene: Scene, dt_s: float) -> None:
        s = self._s
        self._friction = float(s.friction)  # of a pair the root of the product counts
        self._unit, self._sunk = s.unit_of(scene), s.sunk_of(scene)
        self._reach = 0.5 * (s.margin or 0.0) * fall(scene, dt_s) * self._unit
        self._free = -self._reach  # height of the floor below a corner that is aloft
        iterations = iterations_for(scene, s.iterations, s.sweeps) or MANUAL_ITERATIONS
        self.iterations = iterations, s.position_iterations
        # a polygon acts from its skin on, and so does another one on it
        skins = s.skins_below * (1.0 if s.geometry == "corners" else 2.0)
        self._lowered: float = skins * self._library.b2_polygonRadius
        self.world = self._library.b2World(gravity=(0.0, 0.0))
        self.world.continuousPhysics = s.continuous
        self.bodies = [self._new_body(scene, number) for number in range(len(scene.bodies))]
        self.floors = self._new_floors(floor_reach(scene) * self._unit)
        first = scene.bodies[0]
        self._half = 0.5 * first.width * self._unit, 0.5 * first.height * self._unit

    def _new_body(self, scene: Scene, number: int) -> Any:
        s, unit, body, box2d = self._s, self._unit, scene.bodies[number], self._library
        at, x, z = body.at, 0.5 * body.width * unit, 0.5 * body.height * unit
        place = (at.x * unit, at.z * unit - self._sunk)
        made = self.world.CreateDynamicBody(position=place, angle=-at.theta)
        if s.geometry == "box":
            shape = box2d.b2PolygonShape(box=(x, z))
            made.CreateFixture(shape=shape, friction=self._friction, restitution=s.restitution)
        else:
            for contact in scene.layout.contacts:
                if contact.body == number:
                    self._new_corners(made, x, contact.face * z, contact.on)
            if scene.layout.rests(number):
                low = self._lowered - z
                shape = box2d.b2PolygonShape(vertices=[(-x, low), (x, low), (x, z), (-x, z)])
                meets = box2d.b2Filter(categoryBits=32, maskBits=16)
                made.CreateFixture(shape=shape, friction=self._friction, filter=meets)
        made.massData = box2d.b2MassData(
            mass=body.mass, center=(body.offset * unit, 0.0), I=body.about_middle * unit**2
        )
        if not at.at_rest:
            mass_at = body.mass_at
            made.linearVelocity = (mass_at.velocity_x * unit, mass_at.velocity_z * unit)
            made.angularVelocity = -at.rate
        made.sleepingAllowed = s.sleeping  # the world's own doSleep is read back, and does nothing
        return made

    def _new_corners(self, made: Any, x: float, z: float, on: int) -> None:
        """Make corners that meet a floor of their own side, or any body that rests on them."""
        box2d = self._library
        for side in (0, 1):
            bits = (1 << side, 4 << side) if on == BASE else (16, 32)
            shape = box2d.b2CircleShape(pos=((-x, x)[side], z), radius=self._reach)
            meets = box2d.b2Filter(categoryBits=bits[0], maskBits=bits[1])
            corner = made.CreateFixture(shape=shape, friction=self._friction, filter=meets)
            corner.restitution = self._s.restitution

    def _new_floors(self, far: float) -> list[Any]:
        box2d, corners, top = self._library, self._s.geometry == "corners", -self._lowered
        place, numbers = (0.0, self._reach - self._sunk), range(2 if corners else 1)
        floors = [self.world.CreateKinematicBody(position=place) for _ in numbers]
        for number, floor in enumerate(floors):
            ground = [(-far, -far), (far, -far), (far, top), (-far, top)]
            shape = box2d.b2PolygonShape(vertices=ground)
            fixture = floor.CreateFixture(shape=shape, friction=self._friction)
            if corners:
                meets = box2d.b2Filter(categoryBits=4 << number, maskBits=1 << number)
                fixture.filterData = meets
        return floors

    def step(self, step: Step) -> None:
        """Advance by a step."""
        self.world.gravity = (step.pull_x * self._unit, step.pull_z * self._unit)
        before, self._dt = self._dt, step.dt_s
        back = returned(step, before) if self._s.reflection else 0.0
        led = self._way == "velocity"
        at = (step.base_x - step.dt_s * step.base_velocity) * self._unit if self._way else 0.0
        felt = step.base_velocity * self._unit if self._way == "both" else 0.0
        for side, floor in zip((-1.0, 1.0), self.floors, strict=False):
            pivot = step.phase is ContactPhase.REST or step.side in (side, 0.0)
            if led:
                felt = (step.base_x * self._unit - floor.position.x) / step.dt_s
            else:
                floor.position = (at, (self._reach if pivot else self._free) - self._sunk)
            velocity = (felt, 0.0)
            if back and pivot:
                corner = side * self._half[0], -self._half[1]
                x, z = self.bodies[0].GetLinearVelocityFromLocalPoint(corner)
                velocity = (felt - back * (x - self._speed), -back * z)
            floor.linearVelocity = velocity
        self.world.Step(step.dt_s, *self.iterations)
        self._speed, self._place = felt, step.base_x if self._way else 0.0
        if led:
            self._place = self.floors[0].position.x / self._unit
            self.lag_m = max(self.lag_m, abs(self._place - step.base_x))

    def state(self) -> FloatArray:
        """Read the bodies' poses back."""
        for number, body in enumerate(self.bodies):
            x, z = body.position
            place, level = x / self._unit - self._place, (z + self._sunk) / self._unit
            self._state[number] = place, level, -body.angle, -body.angularVelocity
        return self._state

    def close(self) -> None:
        """Release the engine's memory."""
        for body in (*self.bodies, *self.floors):
            self.world.DestroyBody(body)

    def _read_back(self, scene: Scene) -> str:
        body, s = self.bodies[0], self._s
        pairs: dict[str, Any] = {
            "friction": (s.friction, body.fixtures[0].friction),
            "restitution": (s.restitution, body.fixtures[0].restitution),
            "sleeping": (s.sleeping, body.sleepingAllowed),
            "continuous": (s.continuous, self.world.continuousPhysics),
        }
        for number, (wanted, found) in enumerate(zip(scene.bodies, self.bodies, strict=True)):
            pairs[f"mass {number}"] = wanted.mass, found.mass
            pairs[f"inertia {number}"] = wanted.about_middle * self._unit**2, found.inertia
        return disagreement(pairs, Precision.SINGLE.value)

    def _script(self, notes: Notes, way: str) -> Script:
        unit = self._unit
        notes.name(world=self.world, floor=self.floors)
        notes.listed(floors=self.floors)
        x, velocity, moves, led = scaled("base_x", unit), scaled("base_velocity", unit), [], ""
        if way:
            shift = f"    floor.position = {x} - DT * {velocity}, floor.position.y"
            felt = {
                "velocity": f"({x} - floor.position.x) / DT",
                "both": velocity,
                "position": "0.0",
            }
            moves = ["for floor in floors:", *([] if way == "velocity" else [shift])]
            moves += [f"    floor.linearVelocity = {felt[way]}, 0.0"]
            led = " - base_x"
            if way == "velocity":
                led = f" - floors[0].position.x / {unit!r}"
        step = f"world.Step({{}}, {', '.join(map(str, self.iterations))})"
        return Script(
            imports=("import Box2D",),
            settings=(
                step.format(repr(self._ordinary)),
                *notes.quoted(
                    "continuous", "CreateFixture(", "filterData", "restitution", "sleeping"
                ),
            ),
            build=notes.lines(),
            step=(
                f"world.gravity = {scaled('pull_x', unit)}, {scaled('pull_z', unit)}",
                *moves,
                step.format("DT"),
            ),
            pose=("theta, rate = -bodies[number].angle, -bodies[number].angularVelocity",),
            place=f"bodies[0].position.x / {unit!r}{led}",
        )


class Box2DStacks(Box2DWorld):
    """Columns that a beam rests on by a polygon for each side, whose skin says what touches it.

    Free corners meet in the steps of an impact alone: one that is early makes the peak 20 % off.
    """

    def _build(self, scene: Scene, dt_s: float) -> None:
        super()._build(scene, dt_s)
        box2d, (*columns, beam) = self._library, self.bodies
        self.world.warmStarting = False  # from there it would find columns that part
        self._skin, (first,) = box2d.b2_polygonRadius, beam.fixtures
        apart = box2d.b2Filter(categoryBits=128, maskBits=64)
        again = box2d.b2PolygonShape(vertices=first.shape.vertices)
        second = beam.CreateFixture(shape=again, friction=first.friction, filter=apart)
        for corner in (fixture for column in columns for fixture in column.fixtures):
            x, z = corner.shape.pos
            if x > 0.0 and z > 0.0:
                corner.filterData = box2d.b2Filter(categoryBits=64, maskBits=128)
        # a column that turns about its corner at +x bears the beam by the one at -x
        self._tops = (1.0, first.shape), (-1.0, second.shape)

    def step(self, step: Step) -> None:
        """Advance by a step."""
        strikes, reach = step.phase is ContactPhase.STRIKE, self._reach
        free = -DEEPER * reach if step.phase is ContactPhase.APPROACH else -reach
        for side, shape in self._tops:
            touches = strikes or step.phase is ContactPhase.REST or step.side in (side, 0.0)
            shape.radius = max(self._skin + (reach if touches else free), 0.0)
        self._free = free
        super().step(step._replace(side=0.0) if strikes else step)


TUNED = Box2DSettings(
    geometry="corners",
    friction=NO_JAM,
    sweeps=10.0,
    position_iterations=0,
    units=50.0,
    centred=True,
    skins_below=True,
    continuous=False,
    margin=10.0,
    sleeping=False,
    floor="both",
)

DOCUMENTED = citations("""
step | world.Step(1.0 / 60, 6, 2) | Box2D/examples/hello.py
sleeping | on, the default | b2BodyDef.allowSleep
friction | 0.2, of a pair the root of the product; here 1 | b2FixtureDef.friction, b2Contact.h
skin | 0.01 of a polygon, of which 0.005 is left alone | b2_polygonRadius, b2_linearSlop
warm starting | on, the default | b2World.warmStarting
without effect | continuousPhysics on; b2_velocityThreshold 1 below which nothing bounces; no
    damping; speeds up to b2_maxTranslation 2 a step | b2World, b2BodyDef, b2Settings.h
floor | a kinematic body, by its linearVelocity | examples/body_types.py
""")
"""What its documentation sets, in pybox2d 2.3.10."""

RECOMMENDED = citations("""
iterations | 8 for velocity and 3 for position | manual, Hello Box2D
step | 1/60 s; no smaller one for fewer iterations | manual, Dynamics Module
""")

FACTORS = (
    factor("geometry"),
    factor(
        ("iterations", "sweeps"), *(level(f"{count}", iterations=count) for count in (6, 100, 1000))
    ),
    factor("position_iterations", level("2", position_iterations=2)),
    factor("units", level("5 a height", units=5.0), level("200 a height", units=200.0)),
    factor("centred", name="origin"),
    factor("skins_below"),
    factor("continuous"),
    factor("margin", level("1", margin=1.0), level("100", margin=100.0)),
    ASLEEP,
    moving_base("both", "velocity", "position"),
)

NAIVE = default(Box2DSettings(), 1.0 / 60.0, DOCUMENTED, friction=0.2)

ENGINE = Engine(
    name="box2d",
    title="Box2D",
    library="Box2D",
    build=Box2DWorld,
    stacks=True,
    offsets=True,
    presets=(
        NAIVE,
        replace(NAIVE.at_rest(), rest_s=0.0),  # it would count as time to fall asleep
        NAIVE.recommended(*RECOMMENDED, iterations=8, position_iterations=3),
        Preset(name="tuned", settings=TUNED, step=1e-3, helped_by={Help.MARGIN: {"margin": None}}),
        landing(
            replace(TUNED, reflection=True),
            {Help.REFLECTION: {"reflection": False}, Help.MARGIN: {"margin": None}},
            stacked={"sweeps": 200.0},
            stacks=Box2DStacks,
        ),
    ),
    precision=Precision.SINGLE,
    shortest_step=3e-6,
    script=Box2DWorld.script,
    factors=FACTORS,
)
