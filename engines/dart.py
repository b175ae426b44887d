"""DART: settings, presets, and how a scene is built, set, stepped and read back.

The library corrects positions by a velocity of at most 1e-3 units of length a second, and nothing
in Python sets that: a tuned preset counts in hundredths of a millimetre, so that its contacts are
left where they are. In steps that land a beam slides out of the plane as the base does (see
`aside`), and the free corners of what rests on others reach out in the steps of an impact, and are
drawn in before it, so that none comes early.
"""

import math
from dataclasses import dataclass, replace
from typing import Any

from engines.declaration import Engine, Help, Preset, citations, default, landing
from engines.factors import BOTH, DEFAULT, factor, level, moving_base
from engines.parts import Adapter, fall, returned
from engines.run.export import Notes, scaled
from engines.scene import Scene
from engines.settings import Settings, disagreement, one_of, setting
from engines.shapes import Point, counted, floor_half_size, half_size, touching_spheres
from engines.world import ContactPhase, FloatArray, Script, Step

DETECTORS = {
    "DART": "DARTCollisionDetector",
    "FCL": "FCLCollisionDetector",
    "BULLET": "BulletCollisionDetector",
    "ODE": "OdeCollisionDetector",
}
"""The library's names of its collision detectors -> their classes, which every release has."""

DANTZIG, NSGS, FBF = "DantzigBoxedLcpSolver", "NsgsFrictionSolver", "FbfFrictionSolver"
SOLVERS = {"Dantzig": DANTZIG, "NSGS": NSGS, "FBF": FBF}
"""Names of solvers of contact forces -> their classes."""

IN_PLANE, IN_SPACE = (1, 0, 2), (3, 5, 1)
"""Where x, z and theta stand among the coordinates of a joint in the plane, or of a free one."""

FREE = {ContactPhase.APPROACH: -1.0, ContactPhase.STRIKE: 1.0}
"""By how many margins the free corners of what rests on others are lowered in a step."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DartSettings(Settings):
    """Settings of DART, by default its own; None leaves a setting to the library."""

    # of corners, small spheres where those at the base are
    geometry: str = setting("box", names=("box", "corners"))
    # a planar joint, and two corners in the middle plane, instead of a free joint and four
    # corners at the edges
    planar: bool = False
    # let the base slide out of the plane. Else nothing moves a block in the plane that way, its
    # friction there has no mass, the Dantzig solver fails on it, and the library takes what its
    # other solver makes of the last step's impulses in a few iterations, without a word
    aside: bool = False
    # the block's and the base's, of which the library takes the smaller
    friction: float = setting(1.0, least=0.0)
    exact_inertia: bool = True  # else the mass alone leaves the moments of inertia at 1 kg m2
    # its own is FCL. By "DART" contacts are known again by where bodies are in memory: where
    # Dantzig's solver fails, answers depend on that
    collision: str | None = setting(names=tuple(DETECTORS))
    # of contact forces; its own, Dantzig's, bounds friction by normal forces that it solves for
    # without it: while a block turns about a corner up to a third too low
    solver: str | None = setting(names=tuple(SOLVERS))
    split_impulse: bool | None = None  # correct penetration without giving it a velocity
    # a block that has hardly moved for half a second is no longer simulated
    sleeping: bool | None = None
    # units of length in a metre. A penetration is corrected by 1 % of it a step, up to 1e-3 units/s
    unit: float = setting(1.0, above=0.0)
    corner_radius: float = setting(1e-6, above=0.0)  # over the width
    # depth over (alpha p dt)^2 H by which the corner about which the block turns is lowered, so
    # that it stays in contact
    margin: float | None = setting(above=0.0)
    # give that corner's velocity back to it, by the velocity of the base; not in the steps of an
    # impact and the first one after it
    reflection: bool = False
    # how a base that moves is moved: by the velocity of its joint, or by a servo that gives it one,
    # both of which lead it by the library; by both its place and its velocity; by position alone
    floor: str = setting("velocity", names=("velocity", "servo", "both", "position"))
    restitution: float | None = setting(least=0.0, most=1.0)  # the library multiplies both
    base_restitution: float = setting(1.0, least=0.0, most=1.0)


class DartWorld(Adapter):
    """Bodies on a box whose joint is driven by its velocity, whether it moves or not."""

    library = "dartpy"
    called = "dart"

    def _build(self, scene: Scene, dt_s: float) -> None:
        settings, self._unit = self._s, self._s.unit
        self._led = self._way in ("velocity", "servo")
        self._driven = bool(self._way) or settings.reflection
        self._margin = (settings.margin or 0.0) * fall(scene, dt_s) * self._unit
        self._half = counted(half_size(scene.bodies[0]), self._unit)
        self.coordinates = IN_PLANE if settings.planar else IN_SPACE
        # what rests on others lands with them
        self._together = scene.stacked and bool(settings.reflection or settings.margin)
        self._lowered = (math.nan, 0.0)
        self._corners: list[tuple[Any, Point]] = []
        self._shapes: list[Any] = []
        self.named: dict[str, list[Any]] = {name: [] for name in ("mount", "aside", "options")}
        self.world = self._library.simulation.World()
        self._set_solver()
        self.mover, self.floor = self._new_base(scene)
        # a body lives as long as its skeleton, which only the world keeps
        made = [self._new_body(scene, number) for number in range(len(scene.bodies))]
        self.joints, self.bodies = [joint for joint, _ in made], [body for _, body in made]
        if settings.restitution is not None:
            for number, shape in enumerate(self._shapes):  # the product counts
                coefficient = settings.restitution if number else settings.base_restitution
                shape.getDynamicsAspect().setRestitutionCoeff(coefficient)
        self._block = self.bodies[0]

    def _set_solver(self) -> None:
        s, dart, solver = self._s, self._library, self.world.getConstraintSolver()
        if s.collision is not None:
            solver.setCollisionDetector(getattr(dart.collision, DETECTORS[s.collision])())
        if s.sleeping is not None:
            options = self.world.getDeactivationOptions()
            options.mEnabled = s.sleeping
            self.named["options"].append(options)
            self.world.setDeactivationOptions(options)
        if s.solver is not None:
            solver.setBoxedLcpSolver(getattr(dart.constraint, SOLVERS[s.solver])())
        if s.split_impulse is not None:
            solver.setSplitImpulseEnabled(s.split_impulse)

    def _new_base(self, scene: Scene) -> Any:
        half = counted(floor_half_size(scene), self._unit)
        base = self._library.dynamics.Skeleton("base")
        drive, floor = base.createTranslationalJointAndBodyNodePair()
        kinds = self._library.dynamics.ActuatorType
        drive.setActuatorType(kinds.SERVO if self._s.floor == "servo" else kinds.VELOCITY)
        if self._s.aside:
            self.named["mount"].append(floor)
            aside, floor = base.createPrismaticJointAndBodyNodePair(floor)  # out of the plane
            aside.setAxis((0.0, 1.0, 0.0))
            self.named["aside"].append(aside)
        box = self._library.dynamics.BoxShape([2.0 * x for x in half])
        self._shapes.append(self._attached(floor, box, (0.0, 0.0, -half[2])))
        self.world.addSkeleton(base)
        return drive, floor

    def _new_body(self, scene: Scene, number: int) -> Any:
        s, unit, body = self._s, self._unit, scene.bodies[number]
        at, half = body.at, counted(half_size(body), unit)
        skeleton = self._library.dynamics.Skeleton(f"block{number or ''}")
        carried = scene.layout.rests(number)
        if self._together and carried:
            aside, between = skeleton.createPrismaticJointAndBodyNodePair()
            aside.setAxis((0.0, 1.0, 0.0))
            joint, block = skeleton.createPlanarJointAndBodyNodePair(between)
            joint.setZXPlane()
        elif s.planar:
            joint, block = skeleton.createPlanarJointAndBodyNodePair()
            joint.setZXPlane()
        else:
            joint, block = skeleton.createFreeJointAndBodyNodePair()
        block.setMass(body.mass)
        if body.offset:
            block.setLocalCOM((body.offset * unit, 0.0, 0.0))
        if s.exact_inertia:
            block.setMomentOfInertia(*(unit * unit * moment for moment in body.inertia))
        if s.geometry == "box" or carried:
            box = self._library.dynamics.BoxShape([2.0 * x for x in half])
            self._shapes.append(self._attached(block, box, (0.0, 0.0, 0.0)))
        if s.geometry == "corners":
            radius = s.corner_radius * scene.system.width
            ball = self._library.dynamics.SphereShape(radius * unit)
            for corner in touching_spheres(scene, number, radius, planar=s.planar):
                place = counted(corner, unit)
                self._shapes.append(self._attached(block, ball, place))
                self._corners.append((self._shapes[-1], place))
        begins = (at.x * unit, at.z * unit, at.theta)
        speeds = (at.velocity_x * unit, at.velocity_z * unit, at.rate)
        for coordinate, begin, speed in zip(self.coordinates, begins, speeds, strict=True):
            joint.setPosition(coordinate, begin)
            joint.setVelocity(coordinate, speed)
        self.world.addSkeleton(skeleton)
        return joint, block

    def _attached(self, body: Any, shape: Any, at: Point) -> Any:
        """Give a body a shape, whose centre is at a place in its frame [units of length]."""
        node = body.createShapeNode(shape)
        node.createCollisionAspect()
        node.createDynamicsAspect().setFrictionCoeff(float(self._s.friction))  # the smaller counts
        node.setRelativeTranslation(at)
        return node

    def step(self, step: Step) -> None:
        """Advance by a step."""
        world, unit = self.world, self._unit
        if step.dt_s != self._dt:
            world.setTimeStep(step.dt_s)
        world.setGravity((step.pull_x * unit, 0.0, step.pull_z * unit))
        if self._margin:
            self._lower(0.0 if step.phase is ContactPhase.REST else step.side, step.phase)
        if self._led:
            speed = (step.base_x * unit - self._place) / step.dt_s
            self.mover.setCommands((speed, 0.0, 0.0))
        elif self._driven:
            self._drive(step)
        world.step(False)
        self._dt = step.dt_s
        self._came(step, self.mover.getPosition(0) if self._led else None)

    @property
    def yaw(self) -> float | None:
        """How far the first body has turned; see `engines.world.World`."""
        turn = self._block.getTransform().rotation()
        return None if self._s.planar else math.atan2(turn[1, 0], turn[0, 0])

    def state(self) -> FloatArray:
        """Read the bodies' poses back."""
        (x, z, theta), unit = self.coordinates, self._unit
        for number, joint in enumerate(self.joints):
            q, rate = joint.getPositions().tolist(), joint.getVelocity(theta)
            self._state[number] = (q[x] - self._place) / unit, q[z] / unit, q[theta], rate
        return self._state

    def fault(self) -> str:
        """Say which setting was not taken, or that the step is not the one that was set."""
        step = {"step": (self._dt or None, self.world.getTimeStep())}
        return super().fault() or disagreement(step)

    def close(self) -> None:
        """Release the engine's memory."""
        world = self.world
        # releases before 6.20 cannot answer removeAllSkeletons
        for number in reversed(range(world.getNumSkeletons())):
            world.removeSkeleton(world.getSkeleton(number))

    def _lower(self, pivot: float, phase: ContactPhase) -> None:
        """Keep the corners about which bodies turn, or all at rest, in contact."""
        free = FREE.get(phase, 0.0) if self._together else 0.0
        if (pivot, free) == self._lowered:
            return
        self._lowered = pivot, free
        for node, (x, y, z) in self._corners:
            part = 1.0 if -pivot * x * z >= 0.0 else free
            node.setRelativeTranslation((x, y, z + math.copysign(1.0, z) * part * self._margin))

    def _drive(self, step: Step) -> None:
        """Set the base's place and velocity, by which the pivot is given its own back, too."""
        back = returned(step, self._dt) if self._s.reflection else 0.0
        self.mover.setPositions((self._place, 0.0, 0.0))
        speed = step.base_velocity * self._unit if self._way == "both" else 0.0
        along, up = speed, 0.0
        if back:
            corner = (step.side * self._half[0], 0.0, -self._half[2])
            x, _, z = self._block.getLinearVelocity(corner).tolist()
            along, up = speed - back * (x - self._speed), -back * z
        self.mover.setCommands((along, 0.0, up))
        self._speed = speed

    def _read_back(self, scene: Scene) -> str:
        s, world, solver = self._s, self.world, self.world.getConstraintSolver()
        shapes = [self.floor.getShapeNode(0), self._block.getShapeNode(0)]
        top, own = (node.getDynamicsAspect() for node in shapes)
        bounce = None if s.restitution is None else s.restitution * s.base_restitution
        bounces = top.getRestitutionCoeff() * own.getRestitutionCoeff()
        pairs: dict[str, tuple[Any, Any]] = {
            "friction": (s.friction, min(top.getFrictionCoeff(), own.getFrictionCoeff())),
            "restitution": (bounce, bounces),
            "solver": (SOLVERS.get(s.solver or ""), type(solver.getBoxedLcpSolver()).__name__),
            "split impulse": (s.split_impulse, solver.isSplitImpulseEnabled()),
            "sleeping": (s.sleeping, world.getDeactivationOptions().mEnabled),
        }
        for number, (wanted, found) in enumerate(zip(scene.bodies, self.bodies, strict=True)):
            moment = wanted.inertia[1] * self._unit**2 if s.exact_inertia else None
            pairs[f"mass {number}"] = (wanted.mass, found.getMass())
            pairs[f"moment {number}"] = (moment, found.getInertia().getMoment()[1, 1])
        return disagreement(pairs)

    def _script(self, notes: Notes, way: str) -> Script:
        unit = self._unit
        notes.name(world=self.world, drive=self.mover, floor=self.floor, joint=self.joints)
        notes.name(**self.named)
        notes.listed(joints=self.joints)
        along, _, theta = self.coordinates
        x, velocity = scaled("base_x", unit), scaled("base_velocity", unit)
        led = [f"drive.setCommands((({x} - drive.getPosition(0)) / DT, 0.0, 0.0))"]
        moves = {
            **{"": [], "velocity": led, "servo": led},
            "both": [
                f"drive.setPositions(({x} - DT * {velocity}, 0.0, 0.0))",
                f"drive.setCommands(({velocity}, 0.0, 0.0))",
            ],
        }
        one_of("floor of a script", way, moves)
        under = {"": "", "both": f" - {x}"}.get(way, " - drive.getPosition(0)")
        words = ("Detector", "Solver(", "Enabled", "ZXPlane", "FrictionCoeff", "RestitutionCoeff")
        return Script(
            imports=("import dartpy as dart",),
            settings=(f"world.setTimeStep({self._ordinary!r})", *notes.quoted(*words)),
            build=(*notes.lines(), "world.setTimeStep(DT)"),
            step=(
                f"world.setGravity(({scaled('pull_x', unit)}, 0.0, {scaled('pull_z', unit)}))",
                *moves[way],
                "world.step(False)",
            ),
            pose=(
                f"theta = joints[number].getPosition({theta})",
                f"rate = joints[number].getVelocity({theta})",
            ),
            place=f"(joints[0].getPosition({along}){under}) / {unit!r}",
        )


TUNED = DartSettings(
    geometry="corners",
    planar=True,
    aside=True,
    friction=10.0,
    collision="DART",
    sleeping=False,
    unit=1e5,
    floor="both",
)

MASSLESS = "friction without mass: the Dantzig solver fails, and PGS answers in its stead"
UNFINISHED = "an iteration that may end before friction holds: a pivot slides in some cases"
UNIT_INERTIA = "the mass alone leaves the moments of inertia at 1 kg m2"

DOCUMENTED = citations("""
step | 0.001 s, the default | World.getTimeStep
solver | Dantzig's, the default | ConstraintSolver.getBoxedLcpSolver
solver | where it fails PGS, 30 iterations, from the last step's impulses | dart pull request
    1265; PgsBoxedLcpSolverOption; ContactWarmStartCache.hpp
collision | FCL's, the default | ConstraintSolver.getCollisionDetector
contact | of a depth 0.01 a step is corrected, by at most 0.001 a second | ContactConstraint.cpp;
    split impulse is off
sleeping | on, the default since 6.19 | World.getDeactivationOptions
sleeping | after 0.5 s below 0.01 m/s and 0.05 rad/s; commands are said to wake |
    DeactivationOptions.hpp, dart pull request 2920
friction | 1, the default, of a pair the smaller | DynamicsAspect.getFrictionCoeff
floor | a joint of ActuatorType VELOCITY, setCommands; or SERVO, a dynamic one |
    dart/dynamics/detail/JointAspect.hpp, ActuatorType
""")
"""What its documentation sets, in dartpy 6.20.0."""

RECOMMENDED = citations("""
sleeping | off, for who needs the path of before | dart pull requests 2920, 3086
solver | Dantzig's, the default, which is more precise | dart issue 961
""")
"""What it recommends: no page of it is on stiff contact."""

PASTED = citations("""
solver | NsgsFrictionSolver: with Dantzig's a pivot slides | measured here
inertia | set beside the mass, which leaves it at 1 kg m² | measured here
sleeping | off, for who needs the path of before | dart pull requests 2920, 3086
""")

FACTORS = (
    factor("aside", level("no", trap=MASSLESS, aside=False), name="base in the plane"),
    factor("unit", level("1e3 a metre", unit=1e3), name="unit of length"),
    factor(
        "solver",
        level("NSGS", BOTH, solver="NSGS"),
        level("FBF", BOTH, trap=UNFINISHED, solver="FBF"),
        name="solver of contact forces",
    ),
    factor("split_impulse", level("on", BOTH, split_impulse=True)),
    factor("sleeping"),
    factor(
        ("geometry", "planar", "aside"),
        level("4 corners", planar=False, aside=False),
        level("planar box", geometry="box"),
    ),
    factor(
        "collision",
        level("FCL", collision="FCL"),
        level("Bullet", BOTH, collision="BULLET"),
        level("ODE", BOTH, collision="ODE"),
        level("DART", (DEFAULT,), collision="DART"),
        name="collision detector",
    ),
    factor(
        "exact_inertia",
        level("of 1 kg m²", BOTH, trap=UNIT_INERTIA, exact_inertia=False),
        name="inertia",
    ),
    factor("corner_radius", level("B/500", corner_radius=2e-3)),
    factor("margin", level("0.5", margin=0.5), level("10", margin=10.0)),
    factor("friction"),
    moving_base("both", "velocity", "servo", "position"),
)

NAIVE = default(DartSettings(), 1e-3, DOCUMENTED)

ENGINE = Engine(
    name="dart",
    title="DART",
    library="dartpy",
    build=DartWorld,
    stacks=True,
    offsets=True,
    presets=(
        NAIVE,
        NAIVE.at_rest(),
        NAIVE.recommended(*RECOMMENDED, sleeping=False),
        NAIVE.pasted(*PASTED, solver="NSGS", sleeping=False),
        Preset(name="tuned", settings=TUNED, step=5e-4),
        landing(
            replace(TUNED, margin=0.5, reflection=True),
            {Help.REFLECTION: {"reflection": False}, Help.MARGIN: {"margin": None}},
            stacked={"margin": 30.0, "unit": 1e7},
        ),
    ),
    rest_factor=1.0,
    script=DartWorld.script,
    factors=FACTORS,
)
