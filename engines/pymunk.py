"""pymunk (Chipmunk2D): settings, presets, and how a scene is built, set, read back and stepped.

The library moves positions before it changes velocities, and scales cached impulses by the ratio
of two steps: a short step before a long one would throw the block. Where steps differ, a preset
therefore keeps the library's step as it is, gives each step its own gravity, and moves the
positions itself, by the library's own function, from the library's own velocities.
"""

import math
from dataclasses import dataclass, replace
from typing import Any

from engines.declaration import Engine, Help, Preset, citations, default, landing
from engines.factors import factor, level, moving_base
from engines.parts import NO_JAM, Adapter, fall, iterations_for, returned
from engines.run.export import Notes, constant, scaled
from engines.scene import BASE, Body, Scene
from engines.settings import Settings, disagreement, setting
from engines.shapes import floor_reach
from engines.world import ContactPhase, FloatArray, Moment, Script, Step

UNIT_S = 1e-3
"""Step [s] that the library is told where the positions are not its own to move."""

LEVEL = 1e-9
"""A block that leans by less [rad] stands on both corners: held to the margin while it falls, the
free corner would come to rest above the base."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PymunkSettings(Settings):
    """Settings of pymunk; None leaves the library's default."""

    # one polygon on one segment, or points at the corners, each on a polygon of its own
    geometry: str = setting("box", names=("box", "corners"))
    friction: float = setting(1.0, least=0.0)
    iterations: int | None = setting(None, least=1)
    slop: float | None = setting(None, least=0.0)  # units of length
    bias: float | None = setting(None, least=0.0, most=1.0)
    # iterations over 1/sin^2(alpha), where they are not given
    sweeps: float | None = setting(None, above=0.0)
    positions: bool = False  # moved after the velocities, by the adapter
    # gap over (alpha p dt)^2 H up to which the pivot is kept in contact; slop is then beyond it
    margin: float | None = setting(None, above=0.0)
    # the pivot's velocity is given back in a swing, by elasticity and surface velocity
    reflection: bool = False
    floor: str = setting("velocity", names=("velocity", "both", "position"))
    unit: float = setting(1.0, above=0.0)  # units of length in a metre
    # elasticity of the corners (a box has none) and of the base: the product counts
    restitution: float = setting(0.0, least=0.0, most=1.0)
    base_restitution: float = setting(1.0, least=0.0, most=1.0)


class PymunkWorld(Adapter):
    """Bodies on one that does not move by itself, in a `pymunk.Space`."""

    library = "pymunk"

    def _build(self, scene: Scene, dt_s: float) -> None:
        settings, self._unit = self._s, self._s.unit
        self.moment = Moment.MIDDLE if settings.positions else Moment.NEXT
        self.margin = (settings.margin or 0.0) * fall(scene, dt_s) * self._unit
        # free corners of bodies that rest on others must meet them together
        self._together = settings.positions and scene.stacked
        self.space, slop = self._library.Space(), settings.slop
        self._wanted = {
            "iterations": iterations_for(scene, settings.iterations, settings.sweeps),
            "collision_slop": slop if settings.margin is None else 10.0 * self.margin,
            "collision_bias": settings.bias,
        }
        for name, value in self._wanted.items():
            if value is not None:
                setattr(self.space, name, value)
        self.base = self._library.Body(body_type=self._library.Body.KINEMATIC)
        self.bodies = [self._new_body(body) for body in scene.bodies]
        self.pivots: list[float] = []
        self._at: list[tuple[float, float]] = []
        box = settings.geometry == "box"
        self.corners, self.floors = self._boxes(scene) if box else self._corners(scene)
        root = math.sqrt(settings.friction)  # the product counts
        for shape in (*self.corners, *self.floors):
            shape.friction = constant(root, f"math.sqrt({float(settings.friction)!r})")
        self.space.add(self.base, *self.bodies, *self.corners, *self.floors)
        if self._way not in ("", "velocity"):
            self.base.position_func = stay
        for body in self.bodies if settings.positions else ():
            body.position_func = stay

    def _new_body(self, body: Body) -> Any:
        unit, at = self._unit, body.at
        made = self._library.Body(body.mass, body.inertia[1] * unit**2)
        made.angle, mass_at = -at.theta, body.mass_at
        if body.offset:
            made.center_of_gravity = (body.offset * unit, 0.0)
        made.position = (at.x * unit, at.z * unit)
        if not at.at_rest:
            made.velocity = (mass_at.velocity_x * unit, mass_at.velocity_z * unit)
            made.angular_velocity = -at.rate
        return made

    def _boxes(self, scene: Scene) -> tuple[list[Any], list[Any]]:
        far = floor_reach(scene) * self._unit
        pairs = zip(self.bodies, scene.bodies, strict=True)
        boxes = [self._library.Poly(made, boxed(body, self._unit)) for made, body in pairs]
        return boxes, [self._library.Segment(self.base, (-far, 0.0), (far, 0.0), 0.0)]

    def _corners(self, scene: Scene) -> tuple[list[Any], list[Any]]:
        """Make the corners, and a floor for each, which meets that corner alone."""
        far = floor_reach(scene) * self._unit
        deeper = self.margin if self._together else 0.0
        corners: list[Any] = []
        floors: list[Any] = []
        for number, face, on in scene.layout.contacts:
            body = scene.bodies[number]
            x, z = 0.5 * body.width * self._unit, 0.5 * face * body.height * self._unit
            ground = [(-far, -far), (far, -far), (far, -deeper), (-far, -deeper)]
            ground = ground if on == BASE else boxed(scene.bodies[on], self._unit, deeper)
            # the radius that a floor is made with bounds the ones that it is given later
            widest = 2.0 * self.margin if self._together else self.margin
            for side in (1.0, -1.0):
                under, one = self.base if on == BASE else self.bodies[on], 1 << len(corners)
                corners.append(self._library.Circle(self.bodies[number], 0.0, (-side * x, z)))
                floors.append(self._library.Poly(under, ground, radius=widest))
                for shape in (corners[-1], floors[-1]):
                    shape.filter = self._library.ShapeFilter(categories=one, mask=one)
                self.pivots.append(face * side)
                self._at.append((-side * x, z))
        return corners, floors

    def step(self, step: Step) -> None:
        """Advance by a step."""
        own, unit = self._s.positions, self._unit
        dt = UNIT_S if own else step.dt_s
        pull = unit * step.dt_s / dt
        self.space.gravity = (step.pull_x * pull, step.pull_z * pull)
        if self.pivots:
            self._hold(step)
        if self._way == "velocity":
            self._place = self.base.position.x
            self.base.velocity = ((step.base_x * unit - self._place) / step.dt_s, 0.0)
        elif self._way == "both":
            self.base.velocity = (step.base_velocity * unit, 0.0)
        self.space.step(dt)
        if self._way == "velocity":
            self.lag_m = max(self.lag_m, abs(self.base.position.x / unit - step.base_x))
        elif self._way:
            self._place = step.base_x * unit
            self.base.position = (self._place, 0.0)
        for body in self.bodies if own else ():
            self._library.Body.update_position(body, step.dt_s)

    def _hold(self, step: Step) -> None:
        """Keep the pivot in contact, and give its velocity back while the block turns about it."""
        s, before, self._dt = self._s, self._dt, step.dt_s
        back = returned(step, before) if s.reflection else 0.0
        bounce = s.restitution * s.base_restitution
        # equal steps do not say about which corner
        about = 0.0 if step.phase is ContactPhase.REST else step.side or -self.bodies[0].angle
        free, held = 0.0, 1.0
        if self._together:  # floors lie a margin deeper, and reach out further for an impact
            free = {ContactPhase.APPROACH: 0.0, ContactPhase.STRIKE: 2.0}.get(step.phase, 1.0)
            held = 2.0
        pairs = zip(self.pivots, self._at, self.corners, self.floors, strict=True)
        for side, at, corner, floor in pairs:
            pivot = side * about >= -LEVEL
            floor.unsafe_set_radius(self.margin * (held if pivot else free))
            part = back if pivot else 0.0
            corner.elasticity, floor.elasticity, slip = 1.0, max(part, bounce), 0.0
            if part:
                slip = corner.body.velocity_at_local_point(at)[0] - floor.body.velocity[0]
            corner.surface_velocity = (part * slip, 0.0)

    def state(self) -> FloatArray:
        """Read the poses back; a base that the library moves is a step ahead, and carries then."""
        unit, under = self._unit, self._place
        for number, body in enumerate(self.bodies):
            x, z = body.position
            self._state[number] = (x - under) / unit, z / unit, -body.angle, -body.angular_velocity
        return self._state

    def close(self) -> None:
        """Release the engine's memory."""
        self.space.remove(*self.space.shapes, *self.space.bodies)

    def _read_back(self, scene: Scene) -> str:
        friction = self.corners[0].friction * self.floors[0].friction
        pairs: dict[str, Any] = {"friction": (self._s.friction, friction)}
        for name, value in self._wanted.items():
            pairs[name] = value, getattr(self.space, name)
        for number, (wanted, found) in enumerate(zip(scene.bodies, self.bodies, strict=True)):
            pairs[f"mass {number}"] = wanted.mass, found.mass
            pairs[f"moment {number}"] = wanted.inertia[1] * self._unit**2, found.moment
        return disagreement(pairs)

    def _script(self, notes: Notes, way: str) -> Script:
        unit = self._unit
        notes.name(space=self.space, base=self.base, floor=self.floors)
        notes.name(**{"box" if self._s.geometry == "box" else "corner": self.corners})
        hold = []
        x, velocity = scaled("base_x", unit), scaled("base_velocity", unit)
        if self.margin:  # the corner about which the block turns is kept in contact
            notes.listed(floors=self.floors)
            held = f"{self.margin!r} if -side * bodies[0].angle >= {-LEVEL!r} else 0.0"
            hold.append(f"for side, floor in zip({self.pivots}, floors):")
            hold.append(f"    floor.unsafe_set_radius({held})")
        moves = {"velocity": f"({x} - base.position.x) / DT", "both": velocity}
        under = " - base.position.x" * bool(way)
        if way == "velocity":  # a base that the library moves is a step ahead
            under += " + DT * base.velocity.x"
        place = f"bodies[0].position.x{under}"
        return Script(
            imports=(
                "import pymunk",
                *("stay = lambda body, dt: None",) * (way not in ("", "velocity")),
            ),
            settings=(
                f"space.step({self._ordinary!r})",
                *notes.quoted(
                    "iterations", "collision_", ".Circle(", ".Poly(", ".filter", ".friction"
                ),
            ),
            build=notes.lines(),
            step=(
                *hold,
                *(f"base.velocity = {moves[each]}, 0.0" for each in moves if each == way),
                f"space.gravity = {scaled('pull_x', unit)}, {scaled('pull_z', unit)}",
                "space.step(DT)",
                *(f"base.position = {x}, 0.0",) * (way not in ("", "velocity")),
            ),
            pose=("theta, rate = -bodies[number].angle, -bodies[number].angular_velocity",),
            place=place if unit == 1.0 else f"({place}) / {unit!r}",
            moment=self.moment,
        )


def boxed(body: Body, unit: float, deeper: float = 0.0) -> list[tuple[float, float]]:
    """Return the corners of a body, about its centre, the lower face so much deeper in it."""
    x, z = 0.5 * body.width * unit, 0.5 * body.height * unit
    return [(-x, deeper - z), (x, deeper - z), (x, z), (-x, z)]


def stay(body: Any, dt: float) -> None:
    """Leave a body where it is: the adapter moves it."""


TUNED = PymunkSettings(
    geometry="corners", friction=NO_JAM, sweeps=20.0, bias=0.0, margin=10.0, floor="both"
)

DOCUMENTED = citations("""
step | space.step(0.02) | README, the first example
iterations | 10, the default | Space.iterations
collision_slop | 0.1, the default | Space.collision_slop
sleeping | off: sleep_time_threshold is inf | Space.sleep_time_threshold
friction | 0, of a pair the product; here 1 | Shape.friction, cpArbiter.c
warm starting | all of the last step's impulses | cpSpaceStep.c
collision_persistence | 3 steps; with 0 nothing is left to start from, and a block slides |
    cpSpace.c
without effect | collision_bias 0.9^60 a second, of what exceeds the slop; damping 1; elasticity 0
    | cpSpace.c, cpShape.c
floor | Body.KINEMATIC, by its velocity | Body.KINEMATIC, on platforms
""")
"""What its documentation sets, in pymunk 7.3.1."""

RECOMMENDED = citations("""
step | 0.002 s, a tenth of 0.02 | Space.step: multiple calls with a smaller dt
collision_slop | as high as you can without noticeable overlapping: here 1 mm |
    Space.collision_slop
""")

FACTORS = (
    factor("geometry"),
    factor("positions", level("moved by the adapter", positions=True), by_default=False),
    factor(("iterations", "sweeps"), level("100", iterations=100)),
    factor("margin", level("1", margin=1.0), level("0.1", margin=0.1)),
    factor("bias", level("the library's", bias=(1.0 - 0.1) ** 60)),
    factor("unit", level("the README's 100 in a metre", ("default",), unit=100.0)),
    factor("slop", level("0", ("default",), slop=0.0), level("1e-4 m", ("default",), slop=1e-4)),
    factor("friction", level("5", friction=5.0, trap="Painlevé's paradox: the pivot jams")),
    moving_base("both", "velocity", "position"),
)

NAIVE = default(PymunkSettings(), 0.02, DOCUMENTED, friction=0.0)

ENGINE = Engine(
    name="pymunk",
    title="pymunk",
    library="pymunk",
    build=PymunkWorld,
    stacks=True,
    offsets=True,
    presets=(
        NAIVE,
        NAIVE.at_rest(),
        NAIVE.recommended(*RECOMMENDED, step_s=0.002, slop=1e-3),
        Preset(
            name="tuned", settings=TUNED, step=2.5e-4, helped_by={Help.MARGIN: {"margin": None}}
        ),
        landing(
            replace(TUNED, positions=True, reflection=True),
            {
                Help.POSITIONS: {"positions": False},
                Help.REFLECTION: {"reflection": False},
                Help.MARGIN: {"margin": None},
            },
            stacked={"sweeps": 400.0},  # the heavier what rests on others, the slower they converge
        ),
    ),
    script=PymunkWorld.script,
    factors=FACTORS,
)
