"""DART: how a scene is built, set, stepped and read back.

The library corrects positions by a velocity of at most 1e-3 units of length a second, and nothing
in Python sets that: a tuned preset counts in hundredths of a millimetre, so that its contacts are
left where they are.
"""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
from engines.dart.settings import DETECTORS, IN_PLANE, IN_SPACE, SOLVERS, DartSettings

from engines.parts import counted, fall, floor_half_size, half_size, imported, touching_spheres
from engines.parts.reflection import returned
from engines.parts.script import Script, defined, filled, moved, settings_of
from engines.scene import Scene
from engines.settings import disagreement
from engines.world import ContactPhase, FloatArray, Moment, Pose, Step


def numbers(scene: Scene, s: DartSettings) -> SimpleNamespace:
    """Return the numbers of a scene in the settings' unit of length.

    Parameters
    ----------
    scene : Scene
    s : DartSettings

    Returns
    -------
    SimpleNamespace
        What `build` takes as n, lengths in units, of which a metre has s.unit:

        - floor, beneath (3,): size and centre of the base; radius: of corner balls;
        - coordinates (3,): the numbers of x, z and theta in a body's joint;
        - of each of bodies: size (3,), corners (k, 3) about its centre, mass [kg], inertia (3,)
          [kg units2], places (3,) [units, rad] and speeds (3,) [units/s, rad/s] in those
          coordinates.
    """
    unit, floor = s.unit, counted(floor_half_size(scene), s.unit)
    return SimpleNamespace(
        **{"floor": [2.0 * x for x in floor], "beneath": (0.0, 0.0, -floor[2])},
        **{"radius": s.corner_radius * scene.system.width * unit},
        coordinates=IN_PLANE if s.planar else IN_SPACE,
        bodies=[of_body(scene, number, s) for number in range(len(scene.bodies))],
    )


def of_body(scene: Scene, number: int, s: DartSettings) -> SimpleNamespace:
    """Return the numbers of a body, and of the corners by which it touches others."""
    body, unit, radius = scene.bodies[number], s.unit, s.corner_radius * scene.system.width
    at, half = body.at, counted(half_size(body), unit)
    spheres = touching_spheres(scene, number, radius, planar=s.planar)
    corners = [counted(corner, unit) for corner in spheres]
    return SimpleNamespace(
        **{"half": half, "size": [2.0 * x for x in half], "corners": corners},
        **{"mass": body.mass, "inertia": tuple(unit * unit * moment for moment in body.inertia)},
        places=(at.x * unit, at.z * unit, at.theta),
        speeds=(at.velocity_x * unit, at.velocity_z * unit, at.rate),
        **{"named": f"block{number or ''}", "box": s.geometry == "box"},
        carried=scene.layout.rests(number),
    )


def values(s: DartSettings) -> SimpleNamespace:
    """Return settings as the library is given them."""
    return SimpleNamespace(
        **{"geometry": s.geometry, "planar": s.planar, "aside": s.aside},
        actuator="SERVO" if s.floor == "servo" else "VELOCITY",
        **{"friction": float(s.friction), "exact_inertia": s.exact_inertia},
        **{"restitution": s.restitution, "base_restitution": s.base_restitution},
        **{"detector": s.collision and DETECTORS[s.collision], "sleeping": s.sleeping},
        **{"solver": s.solver and SOLVERS[s.solver], "split_impulse": s.split_impulse},
    )


def touching(body: Any, shape: Any, at: Any, friction: float) -> Any:
    """Give a body a shape.

    Parameters
    ----------
    body : BodyNode
    shape : Shape
    at : array_like (3,), centre of the shape in the body's frame [units of length]
    friction : float, its coefficient; of two shapes that touch the smaller one counts

    Returns
    -------
    ShapeNode
    """
    node = body.createShapeNode(shape)
    node.createCollisionAspect()
    node.createDynamicsAspect().setFrictionCoeff(friction)  # the smaller one counts
    node.setRelativeTranslation(at)
    return node


def is_ball(node: Any) -> bool:
    """Say whether a shape is a ball at a corner."""
    return bool(node.getShape().getType() == "SphereShape")


def build(dart: Any, n: Any, s: Any) -> Any:
    """Build bodies on a box whose joint is driven by its velocity.

    Parameters
    ----------
    dart : module, dartpy
    n : SimpleNamespace, from `numbers`
    s : SimpleNamespace, from `values`

    Returns
    -------
    world : World
    drive : TranslationalJoint, of the base
    floor : BodyNode, the base's
    joints, bodies : list of Joint, list of BodyNode, one for each of n.bodies
    shapes : list of ShapeNode, of all bodies
    """
    world = dart.simulation.World()
    solver = world.getConstraintSolver()
    if s.detector is not None:
        solver.setCollisionDetector(getattr(dart.collision, s.detector)())
    if s.sleeping is not None:  # noqa: SIM102 (decided before, in a script)
        if hasattr(world, "setDeactivationOptions"):  # what a release does not have is off in it
            options = world.getDeactivationOptions()
            options.mEnabled = s.sleeping
            world.setDeactivationOptions(options)
    if s.solver is not None:
        solver.setBoxedLcpSolver(getattr(dart.constraint, s.solver)())
    if s.split_impulse is not None:  # noqa: SIM102
        if hasattr(solver, "setSplitImpulseEnabled"):
            solver.setSplitImpulseEnabled(s.split_impulse)
    base = dart.dynamics.Skeleton("base")
    drive, floor = base.createTranslationalJointAndBodyNodePair()
    drive.setActuatorType(getattr(dart.dynamics.ActuatorType, s.actuator))
    if s.aside:
        aside, floor = base.createPrismaticJointAndBodyNodePair(floor)  # free out of the plane
        aside.setAxis((0.0, 1.0, 0.0))
    ground = touching(floor, dart.dynamics.BoxShape(n.floor), n.beneath, s.friction)
    world.addSkeleton(base)
    joints, bodies, shapes = [], [], []
    for b in n.bodies:
        skeleton = dart.dynamics.Skeleton(b.named)
        if s.planar:
            joint, block = skeleton.createPlanarJointAndBodyNodePair()
            joint.setZXPlane()
        else:
            joint, block = skeleton.createFreeJointAndBodyNodePair()
        block.setMass(b.mass)
        if s.exact_inertia:
            block.setMomentOfInertia(*b.inertia)
        if b.box or b.carried:
            box = dart.dynamics.BoxShape(b.size)
            shapes.append(touching(block, box, (0.0, 0.0, 0.0), s.friction))
        if not b.box:
            ball = dart.dynamics.SphereShape(n.radius)
            shapes += [touching(block, ball, at, s.friction) for at in b.corners]
        for number, place, speed in zip(n.coordinates, b.places, b.speeds, strict=True):
            joint.setPosition(number, place)
            joint.setVelocity(number, speed)
        world.addSkeleton(skeleton)
        joints.append(joint)
        bodies.append(block)
    if s.restitution is not None:
        ground.getDynamicsAspect().setRestitutionCoeff(s.base_restitution)  # the product counts
        for shape in shapes:
            shape.getDynamicsAspect().setRestitutionCoeff(s.restitution)
    return world, drive, floor, joints, bodies, shapes


LED = ("drive.setCommands((({x} - drive.getPosition(0)) / DT, 0.0, 0.0))",)
FLOORS = {
    "velocity": LED,
    "servo": LED,
    "both": (
        "drive.setPositions(({x} - DT * {v}, 0.0, 0.0))",
        "drive.setCommands(({v}, 0.0, 0.0))",
    ),
}
"""How a script moves a base that carries, to a place x with velocity v in units of length."""


def script(scene: Scene, settings: DartSettings, dt_s: float) -> Script:
    """Return a scene as calls of DART; see `engines.parts.script`."""
    n = numbers(scene, settings)
    lines = filled(build, n=n, s=values(settings))
    unit, theta = settings.unit, n.coordinates[2]
    carried = f"base_x * {unit!r}" if settings.floor == "both" else "drive.getPosition(0)"
    under = f" - {carried}" * (scene.frame == "world")
    return Script(
        imports=("import dartpy as dart",),
        settings=(f"world.setTimeStep({dt_s!r})", *settings_of(lines)),
        build=(*(line.text for line in (*defined(touching), *lines)), "world.setTimeStep(DT)"),
        step=(
            f"world.setGravity((pull_x * {unit!r}, 0.0, pull_z * {unit!r}))",
            *moved(scene, settings.floor, unit, FLOORS),
            "world.step(False)",
        ),
        pose=(
            f"theta = joints[number].getPosition({theta})",
            f"rate = joints[number].getVelocity({theta})",
        ),
        place=f"(joints[0].getPosition({n.coordinates[0]}){under}) / {unit!r}",
    )


class DartWorld:
    """Bodies on a box whose joint is driven by its velocity, whether it moves or not."""

    moment = Moment.MIDDLE

    def __init__(self, scene: Scene, settings: DartSettings, dt_s: float) -> None:
        self._s, self._unit = settings, settings.unit
        self._way = settings.floor if scene.frame == "world" else ""
        self._led = self._way in ("velocity", "servo")
        self._driven = bool(self._way) or settings.reflection
        self.lag_m = 0.0
        self._margin = (settings.margin or 0.0) * fall(scene, dt_s) * self._unit
        self._dt = self._speed = self._place = 0.0
        self._pivot: float | None = None
        n = numbers(scene, settings)
        self._half, self._at = n.bodies[0].half, n.coordinates
        # a body lives as long as its skeleton, which only the world keeps
        built = build(imported("dartpy"), n, values(settings))
        self._world, self._ground, self._floor, self._joints, self._bodies, shapes = built
        self._block, self._state = self._bodies[0], np.zeros((len(self._bodies), len(Pose._fields)))
        balls = [shape for shape in shapes if settings.geometry == "corners" and is_ball(shape)]
        places = [corner for body in n.bodies for corner in body.corners]
        self._corners = list(zip(balls, places, strict=settings.geometry == "corners"))
        self._fault = self._read_back(scene)

    def step(self, step: Step) -> None:
        """Advance by a step."""
        world, unit = self._world, self._unit
        if step.dt_s != self._dt:
            world.setTimeStep(step.dt_s)
        world.setGravity((step.pull_x * unit, 0.0, step.pull_z * unit))
        if self._margin:
            self._lower(0.0 if step.phase is ContactPhase.REST else step.side)
        if self._led:
            speed = (step.base_x * unit - self._place) / step.dt_s
            self._ground.setCommands((speed, 0.0, 0.0))
        elif self._driven:
            self._drive(step)
        world.step(False)
        self._dt = step.dt_s
        if self._led:
            self._place = self._ground.getPosition(0)
            self.lag_m = max(self.lag_m, abs(self._place / unit - step.base_x))
        elif self._way:
            self._place = step.base_x * unit

    def state(self) -> FloatArray:
        """Read the bodies' poses back."""
        (x, z, theta), unit = self._at, self._unit
        for number, joint in enumerate(self._joints):
            q, rate = joint.getPositions().tolist(), joint.getVelocity(theta)
            self._state[number] = (q[x] - self._place) / unit, q[z] / unit, q[theta], rate
        return self._state

    def fault(self) -> str:
        """Say which setting was not taken, or that the step is not the one that was set."""
        return self._fault or disagreement({"step": (self._dt or None, self._world.getTimeStep())})

    def close(self) -> None:
        """Release the engine's memory."""
        world = self._world
        # releases before 6.20 cannot answer removeAllSkeletons
        for number in reversed(range(world.getNumSkeletons())):
            world.removeSkeleton(world.getSkeleton(number))

    def _lower(self, pivot: float) -> None:
        """Keep the corner about which the block turns, or both at rest, in contact."""
        if pivot == self._pivot:
            return
        self._pivot = pivot
        for node, (x, y, z) in self._corners:
            low = self._margin if -pivot * x * z >= 0.0 else 0.0
            node.setRelativeTranslation((x, y, z + math.copysign(low, z)))

    def _drive(self, step: Step) -> None:
        """Set the base's place and velocity, by which the pivot is given its own back, too."""
        back = returned(step, self._dt) if self._s.reflection else 0.0
        self._ground.setPositions((self._place, 0.0, 0.0))
        speed = step.base_velocity * self._unit if self._way == "both" else 0.0
        along, up = speed, 0.0
        if back:
            corner = (step.side * self._half[0], 0.0, -self._half[2])
            x, _, z = self._block.getLinearVelocity(corner).tolist()
            along, up = speed - back * (x - self._speed), -back * z
        self._ground.setCommands((along, 0.0, up))
        self._speed = speed

    def _read_back(self, scene: Scene) -> str:
        s, world, solver = self._s, self._world, self._world.getConstraintSolver()
        sleeps = hasattr(world, "getDeactivationOptions")
        splits = hasattr(solver, "isSplitImpulseEnabled")
        shapes = [self._floor.getShapeNode(0), self._block.getShapeNode(0)]
        top, own = (node.getDynamicsAspect() for node in shapes)
        masses: dict[str, tuple[float | None, float]] = {}
        for number, (wanted, found) in enumerate(zip(scene.bodies, self._bodies, strict=True)):
            moment = wanted.inertia[1] * self._unit**2 if s.exact_inertia else None
            masses[f"mass {number}"] = (wanted.mass, found.getMass())
            masses[f"moment {number}"] = (moment, found.getInertia().getMoment()[1, 1])
        return disagreement(
            {
                **masses,
                "friction": (s.friction, min(top.getFrictionCoeff(), own.getFrictionCoeff())),
                "restitution": (
                    None if s.restitution is None else s.restitution * s.base_restitution,
                    top.getRestitutionCoeff() * own.getRestitutionCoeff(),
                ),
                "solver": (SOLVERS.get(s.solver or ""), type(solver.getBoxedLcpSolver()).__name__),
                "split impulse": (s.split_impulse, splits and solver.isSplitImpulseEnabled()),
                "sleeping": (s.sleeping, sleeps and world.getDeactivationOptions().mEnabled),
            }
        )
