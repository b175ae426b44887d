"""DART: how a scene is built, set, stepped and read back.

The library corrects positions by a velocity of at most 1e-3 units of length a second, and nothing
in Python sets that: a tuned preset counts in hundredths of a millimetre, so that its contacts are
left where they are.
"""

from typing import Any

from engines.dart.settings import (
    DETECTORS,
    IN_PLANE,
    IN_SPACE,
    SOLVERS,
    DartSettings,
)
from engines.parts.quiet import imported
from engines.parts.readback import disagreement
from engines.parts.reflection import returned
from engines.parts.shapes import Point, corner_spheres, fall, floor_half_size, half_size
from engines.scene import Scene
from engines.world import Grip, Moment, Pose, Step


class DartWorld:
    """A block on a box whose joint is driven by its velocity, whether it moves or not."""

    moment = Moment.MIDDLE

    def __init__(self, scene: Scene, settings: DartSettings, dt_s: float) -> None:
        self._s, self._unit = settings, settings.unit
        self._dart = imported("dartpy")
        self._moving = scene.frame == "world"
        self._driven = self._moving or settings.reflection
        self._margin = (settings.margin or 0.0) * fall(scene, dt_s) * self._unit
        self._dt = self._speed = self._place = 0.0
        self._pivot: float | None = None
        self._corners: list[tuple[Any, Point]] = []
        self._world = self._dart.simulation.World()
        self._set_world()
        # a body lives as long as its skeleton, which only the world keeps
        self._ground, self._floor = self._add_base(scene)
        self._joint, self._block = self._add_block(scene)
        self._fault = self._read_back(scene)

    def step(self, step: Step) -> None:
        """Advance by a step; see `engines.world.SteppedWorld`."""
        world, unit = self._world, self._unit
        if step.dt_s != self._dt:
            world.setTimeStep(step.dt_s)
        world.setGravity((step.pull_x * unit, 0.0, step.pull_z * unit))
        if self._margin:
            self._lower(0.0 if step.grip is Grip.REST else step.side)
        if self._driven:
            self._drive(step)
        world.step(False)
        self._dt = step.dt_s
        if self._moving:
            self._place = step.base_x * unit

    def pose(self) -> Pose:
        """Read the block's pose back."""
        x, z, theta = self._at
        q, unit = self._joint.getPositions().tolist(), self._unit
        rate = self._joint.getVelocity(theta)
        return Pose((q[x] - self._place) / unit, q[z] / unit, q[theta], rate)

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
            low = self._margin if pivot * x >= 0.0 else 0.0
            node.setRelativeTranslation((x, y, z - low))

    def _drive(self, step: Step) -> None:
        """Set the base's place and velocity, by which the pivot is given its own back, too."""
        back = returned(step, self._dt) if self._s.reflection else 0.0
        self._ground.setPositions((self._place, 0.0, 0.0))
        speed = step.base_velocity * self._unit if self._moving and self._s.base_velocity else 0.0
        along, up = speed, 0.0
        if back:
            corner = (step.side * self._half[0], 0.0, -self._half[2])
            x, _, z = self._block.getLinearVelocity(corner).tolist()
            along, up = speed - back * (x - self._speed), -back * z
        self._ground.setCommands((along, 0.0, up))
        self._speed = speed

    def _set_world(self) -> None:
        s, world, dart = self._s, self._world, self._dart
        solver = world.getConstraintSolver()
        if s.collision is not None:
            solver.setCollisionDetector(getattr(dart.collision, DETECTORS[s.collision])())
        # what a release does not have is off in it, and reads so
        if s.sleeping is not None and hasattr(world, "setDeactivationOptions"):
            options = world.getDeactivationOptions()
            options.mEnabled = s.sleeping
            world.setDeactivationOptions(options)
        if s.solver is not None:
            solver.setBoxedLcpSolver(getattr(dart.constraint, SOLVERS[s.solver])())
        if s.split_impulse is not None and hasattr(solver, "setSplitImpulseEnabled"):
            solver.setSplitImpulseEnabled(s.split_impulse)

    def _add_base(self, scene: Scene) -> tuple[Any, Any]:
        dart, skeleton = self._dart, self._dart.dynamics.Skeleton("base")
        joint, body = skeleton.createTranslationalJointAndBodyNodePair()
        joint.setActuatorType(dart.dynamics.ActuatorType.VELOCITY)
        if self._s.aside:
            slide, body = skeleton.createPrismaticJointAndBodyNodePair(body)
            slide.setAxis((0.0, 1.0, 0.0))
        x, y, z = (2.0 * size * self._unit for size in floor_half_size(scene))
        top = self._shape(body, dart.dynamics.BoxShape((x, y, z)), (0.0, 0.0, -0.5 * z))
        if self._s.restitution is not None:
            top.getDynamicsAspect().setRestitutionCoeff(self._s.base_restitution)
        self._world.addSkeleton(skeleton)
        return joint, body

    def _add_block(self, scene: Scene) -> tuple[Any, Any]:
        s, dart, unit = self._s, self._dart, self._unit
        skeleton = dart.dynamics.Skeleton("block")
        if s.planar:
            joint, body = skeleton.createPlanarJointAndBodyNodePair()
            joint.setZXPlane()
        else:
            joint, body = skeleton.createFreeJointAndBodyNodePair()
        self._at = IN_PLANE if s.planar else IN_SPACE
        body.setMass(scene.mass)
        if s.exact_inertia:
            body.setMomentOfInertia(*(unit * unit * moment for moment in scene.inertia))
        self._half = tuple(unit * size for size in half_size(scene))
        if s.geometry == "box":
            box = dart.dynamics.BoxShape([2.0 * size for size in self._half])
            self._shape(body, box, (0.0, 0.0, 0.0))
        else:
            self._add_corners(scene, body)
        self._put(scene, joint)
        self._world.addSkeleton(skeleton)
        return joint, body

    def _add_corners(self, scene: Scene, body: Any) -> None:
        radius = self._s.corner_radius * scene.block.width
        ball = self._dart.dynamics.SphereShape(radius * self._unit)
        for x, y, z in corner_spheres(scene, radius, planar=self._s.planar):
            at = (x * self._unit, y * self._unit, z * self._unit)
            self._corners.append((self._shape(body, ball, at), at))

    def _shape(self, body: Any, shape: Any, at: Point) -> Any:
        node = body.createShapeNode(shape)
        node.createCollisionAspect()
        # of a pair the library takes the smaller one
        node.createDynamicsAspect().setFrictionCoeff(self._s.friction)
        if self._s.restitution is not None:
            node.getDynamicsAspect().setRestitutionCoeff(self._s.restitution)
        node.setRelativeTranslation(at)
        return node

    def _put(self, scene: Scene, joint: Any) -> None:
        """Let the block set out from where the scene begins."""
        start, unit = scene.beginning, self._unit
        places = (start.x * unit, start.z * unit, start.theta)
        speeds = (start.velocity_x * unit, start.velocity_z * unit, start.rate)
        for index, place, speed in zip(self._at, places, speeds, strict=True):
            joint.setPosition(index, place)
            joint.setVelocity(index, speed)

    def _read_back(self, scene: Scene) -> str:
        s, world, solver = self._s, self._world, self._world.getConstraintSolver()
        sleeps = hasattr(world, "getDeactivationOptions")
        splits = hasattr(solver, "isSplitImpulseEnabled")
        shapes = [self._floor.getShapeNode(0), self._block.getShapeNode(0)]
        top, own = (node.getDynamicsAspect() for node in shapes)
        moment = scene.inertia[1] * self._unit**2 if s.exact_inertia else None
        return disagreement(
            {
                "mass": (scene.mass, self._block.getMass()),
                "moment": (moment, self._block.getInertia().getMoment()[1, 1]),
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
