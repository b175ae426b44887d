"""PyBullet: its settings, and how a scene is built, set, read back and stepped."""

import contextlib
import math
from collections.abc import Mapping
from dataclasses import dataclass
from threading import Lock
from typing import Any

from engines.parts import Adapter, imported, iterations_for, silence, yaw_of
from engines.run.export import Notes
from engines.scene import Body, Scene
from engines.settings import Settings, disagreement, given, setting
from engines.shapes import floor_half_size, half_size, hull_points, touching_spheres
from engines.world import ContactPhase, FloatArray, Script, Step

LIBRARY_STEP_S = 1.0 / 240.0
"""The library's own time step [s]."""

LIBRARY_BREAKING_THRESHOLD = 0.02
"""The library's own gap, over a body's size, up to which it keeps a contact."""

SOLVERS = {
    "sequential impulse": "CONSTRAINT_SOLVER_LCP_SI",
    "PGS": "CONSTRAINT_SOLVER_LCP_PGS",
    "Dantzig": "CONSTRAINT_SOLVER_LCP_DANTZIG",
}
"""Name of a contact solver -> the library's constant."""

LARGEST_FRICTION = 10.0
"""The library clamps the coefficient of a pair, the product of the two bodies', to this."""

KEPT_GAP = 4.0
"""Gap up to which landing keeps a contact, in units of (p dt sin(alpha))^2 half diagonals. A pivot
rises by (theta' dt)^2 H/4 in a step, so that it is kept up to theta' = 2.8 p alpha. The free corner
must be let go: an anchor that is still kept at the next impact pulls it back to where it stood."""

ROLLED = 0.75
"""Part of that gap at most by which a corner sphere rolls while the block turns by alpha. An anchor
stays where it was made: from a gap away the library adds a contact, then another, and keeps all."""

FLOOR_MASSES = 100.0
"""Mass of a held base over that of the bodies on it; from ten on it does not matter."""

FLOOR_G = 50.0
"""Most force that holds it, over its weight, as in the library's example of such a constraint: 50 N
on a cube of 0.1 kg. By its weight alone a base sinks; from twice as much on it does not matter."""

NOWHERE, UPRIGHT = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)

held_for_all = Lock()
"""Whose gap it is up to which contacts are kept: the library holds it for the whole process, and
looks at it when two bodies meet first, on a plane while a scene is built."""

idle: list[int] = []
"""Clients of this process whose run has ended: most runs are shorter than connecting."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BulletSettings(Settings):
    """Settings of PyBullet, by default its own; None leaves a setting to the library."""

    # of corners, small spheres where those at the base are; of a hull, a convex mesh of all eight
    geometry: str = setting("box", names=("box", "corners", "hull"))
    # put two corner spheres into the middle plane instead of four at the edges
    planar: bool = False
    multibody: bool = True  # build the block in reduced coordinates
    # of block and base; its own is 0.5, with which a block of H/B = 2 slides before it rocks
    friction: float = setting(1.0, least=0.0, most=LARGEST_FRICTION)
    corner_radius: float = setting(1e-6, above=0.0)  # of the spheres, over the width
    # set the block's moments of inertia instead of those of its collision shape
    exact_inertia: bool = False
    damping: float | None = None
    iterations: int | None = setting(None, least=1)  # of the solver, at most
    sweeps: float | None = setting(None, above=0.0)  # iterations over 1/sin^2(alpha)
    residual: float | None = None  # squared velocity at which they end [m2/s2]
    contact_erp: float | None = None  # part of a position error that a step corrects: of contacts
    friction_erp: float | None = None  # of their friction anchor
    # of the constraint that holds a base
    constraint_erp: float | None = setting(least=0.0, most=1.0)
    friction_anchor: bool = False
    contact_slop: float | None = None
    # gap, over the half diagonal, up to which a contact is kept, in the whole process
    breaking_threshold: float = LIBRARY_BREAKING_THRESHOLD
    # keep contacts up to a gap of `KEPT_GAP` instead, out of which no sphere rolls
    gap_by_step: bool = False
    # correct no positions in the short steps around an impact, and no slip at rest
    by_phase: bool = False
    base_geometry: str = setting("plane", names=("plane", "box"))
    # how a base that moves is moved: by a constraint, which holds a box with a mass, by its
    # velocity, or by position alone
    floor: str = setting("constraint", names=("constraint", "velocity", "position"))
    solver: str | None = setting(names=tuple(SOLVERS))
    # part of a column by which bodies begin inside each other: two boxes that only touch have no
    # contact, and a beam that falls in the first step is thrown up
    overlap: float = setting(0.0, least=0.0, most=1e-6)
    warm_starting: float | None = setting(least=0.0, most=1.0)
    split_impulse: bool | None = None
    cone_friction: bool | None = None
    separating_axis: bool | None = None
    restitution: float | None = setting(least=0.0, most=1.0)  # the library multiplies both
    base_restitution: float = setting(1.0, least=0.0, most=1.0)
    restitution_threshold: float | None = setting(least=0.0)
    # of a yielding contact, over m p^2; its damping is over m p
    contact_stiffness: float | None = setting(above=0.0, beside=("contact_damping",))
    contact_damping: float | None = setting(above=0.0)


class BulletWorld(Adapter):
    """Bodies on a base in a PyBullet client that no other run uses meanwhile.

    The base is a multibody without mass if no constraint moves it: friction feels its velocity, and
    on a static rigid body the response to the mirrored motion is not the mirror image.
    """

    library = "pybullet"
    called = "p"
    without = ("physicsClientId",)
    base_x_m = 0.0

    def _build(self, scene: Scene, dt_s: float) -> None:
        self._p, self._ordinary = self._library, dt_s
        self._own, self._client = taken()
        self._constrained = self._way == "constraint"
        self.lag_m = 0.0 if self._constrained else None
        self.holder, self._due, self._offset = -1, 0.0, scene.bodies[0].offset
        self._phase: ContactPhase | None = None
        with held_for_all:
            self._set_engine()
            self._make_base()
            self.bodies = [self._made(number) for number in range(len(scene.bodies))]
            self._fault = self._set_dynamics()
            if self._constrained:
                held = self.base, -1, -1, -1, self._p.JOINT_FIXED, NOWHERE, NOWHERE, self.ground
                self.holder = self._p.createConstraint(*held, physicsClientId=self._client)
            self._set_out()

    def _call(self, name: str, **arguments: Any) -> Any:
        """Call a function of the library in this world's client."""
        return getattr(self._p, name)(**arguments, physicsClientId=self._client)

    def _set_engine(self) -> None:
        s, block = self._s, self._scene.system
        gap = s.breaking_threshold
        self._radius = s.corner_radius * block.width
        if s.gap_by_step:
            gap = KEPT_GAP * (math.sin(block.alpha) * block.p * self._ordinary) ** 2
            self._radius = min(self._radius, ROLLED * (gap * block.R) / block.alpha)
        self._iterations = iterations_for(self._scene, s.iterations, s.sweeps)
        wanted = {
            "numSolverIterations": self._iterations,
            "solverResidualThreshold": s.residual,
            "contactERP": s.contact_erp,
            "frictionERP": s.friction_erp,
            "erp": s.constraint_erp,
            "contactSlop": s.contact_slop,
            "contactBreakingThreshold": gap,
            "constraintSolverType": s.solver and getattr(self._p, SOLVERS[s.solver]),
            "warmStartingFactor": s.warm_starting,
            "useSplitImpulse": s.split_impulse,
            "enableConeFriction": s.cone_friction,
            "enableSAT": s.separating_axis,
            "restitutionVelocityThreshold": s.restitution_threshold,
        }
        # the library announces a solver past Python
        with silence() if s.solver is not None else contextlib.nullcontext():
            self._call("setPhysicsEngineParameter", **given(wanted))

    def _make_base(self) -> None:
        """Make the base; a plane has no inertia with which to be held."""
        p, scene = self._p, self._scene
        boxed = self._s.base_geometry == "box" or self._constrained
        shape = {"shapeType": p.GEOM_PLANE, "planeNormal": (0.0, 0.0, 1.0)}
        if boxed:
            shape = {"shapeType": p.GEOM_BOX, "halfExtents": floor_half_size(scene)}
        self.ground = (0.0, 0.0, -scene.bodies[0].height if boxed else 0.0)
        mass = sum(body.mass for body in scene.bodies)
        self.most_force = FLOOR_G * scene.system.gravity * FLOOR_MASSES * mass
        mass = FLOOR_MASSES * mass if self._constrained else 0.0
        self.shapes = [self._call("createCollisionShape", **shape)]
        self.base = self._body(mass, self.ground, maximal=False)

    def _body(self, mass: float, place: Any, *, maximal: bool) -> Any:
        """Make a body of the last shape; return its number in the library."""
        return self._p.createMultiBody(
            mass,
            self.shapes[-1],
            basePosition=place,
            useMaximalCoordinates=maximal,
            physicsClientId=self._client,
        )

    def _made(self, number: int) -> Any:
        p, s, scene = self._p, self._s, self._scene
        body = scene.bodies[number]
        left = -body.offset  # the library has a body where its mass is
        if s.geometry == "box" or scene.layout.rests(number):
            box: dict[str, Any] = {"shapeType": p.GEOM_BOX, "halfExtents": half_size(body)}
            if body.offset:
                box["collisionFramePosition"] = (left, 0.0, 0.0)
            shape = self._call("createCollisionShape", **box)
        elif s.geometry == "hull":
            points = [(x + left, y, z) for x, y, z in hull_points(body)]
            shape = self._call("createCollisionShape", shapeType=p.GEOM_MESH, vertices=points)
        else:
            corners = touching_spheres(scene, number, self._radius, planar=s.planar)
            corners = [(x + left, y, z) for x, y, z in corners]
            shape = self._call(
                "createCollisionShapeArray",
                shapeTypes=[p.GEOM_SPHERE] * len(corners),
                radii=[self._radius] * len(corners),
                collisionFramePositions=corners,
            )
        place = (body.home[0], 0.0, body.home[1])
        self.shapes.append(shape)
        return self._body(body.mass, place, maximal=not s.multibody)

    def _set_dynamics(self) -> str:
        """Set the bodies' dynamics and say where reading them back disagrees."""
        s, p, faults = self._s, self._scene.system.p, []
        bounce = None if s.restitution is None else s.base_restitution
        base = given({"lateralFriction": 1.0, "restitution": bounce})
        for number, body in enumerate(self._scene.bodies):
            wanted: dict[str, Any] = {
                "lateralFriction": s.friction,
                # without its mass in the same call, a block in maximal coordinates becomes NaN
                "mass": body.mass,
                "localInertiaDiagonal": body.inertia if self._exact(body) else None,
                "linearDamping": s.damping,
                "angularDamping": s.damping,
                "restitution": s.restitution,
            }
            if s.contact_stiffness is not None and s.contact_damping is not None:
                wanted["contactStiffness"] = s.contact_stiffness * body.mass * p * p
                wanted["contactDamping"] = s.contact_damping * body.mass * p
            self._change(self.bodies[number], given(wanted))
            if not number:
                self._change(self.base, base)
            faults.append(self._read_back(number, wanted))
        return next(filter(None, faults), "")

    def _exact(self, body: Body) -> bool:
        """Say whether a body is given its moments of inertia; a shape's are those of even mass."""
        return self._s.exact_inertia or not body.is_homogeneous

    def _change(self, body: int, wanted: Mapping[str, Any]) -> None:
        anchor = {"frictionAnchor": 1} if self._s.friction_anchor else {}
        self._call("changeDynamics", bodyUniqueId=body, linkIndex=-1, **wanted, **anchor)

    def _read_back(self, number: int, wanted: Mapping[str, Any]) -> str:
        s, body = self._s, self._scene.bodies[number]
        block, base = (
            self._own.getDynamicsInfo(each, -1, physicsClientId=self._client)
            for each in (self.bodies[number], self.base)
        )
        engine = self._own.getPhysicsEngineParameters(physicsClientId=self._client)
        pairs: dict[str, tuple[Any, Any]] = {
            "mass": (body.mass, block[0]),
            "friction of the block": (s.friction, block[1]),
            "friction of the base": (1.0, base[1]),
            "numSolverIterations": (self._iterations, engine["numSolverIterations"]),
        }
        if self._exact(body):
            pairs |= {f"inertia {i}": (body.inertia[i], block[2][i]) for i in range(3)}
        if s.multibody:
            # a body in maximal coordinates takes them, too, but reads zeros
            pairs["restitution"] = (s.restitution, block[5])
            pairs["contactDamping"] = (wanted.get("contactDamping"), block[8])
            pairs["contactStiffness"] = (wanted.get("contactStiffness"), block[9])
        return disagreement(pairs)

    def _set_out(self) -> None:
        """Step once far from the base, which sets the inertia, then set out as the scene begins."""
        p, client, bodies = self._p, self._client, self._scene.bodies
        up = 2.0 * bodies[0].height - bodies[0].home[1]
        for number, body in zip(self.bodies, bodies, strict=True):
            place = (body.home[0], 0.0, body.home[1] + up)
            p.resetBasePositionAndOrientation(number, place, UPRIGHT, physicsClientId=client)
        p.stepSimulation(physicsClientId=client)
        for number, body in zip(self.bodies, bodies, strict=True):
            at, half = body.mass_at, 0.5 * body.at.theta
            turned = (0.0, math.sin(half), 0.0, math.cos(half))
            place = at.x, 0.0, at.z * (1.0 - 2.0 * self._s.overlap)
            velocity, rate = (at.velocity_x, 0.0, at.velocity_z), (0.0, at.rate, 0.0)
            p.resetBasePositionAndOrientation(number, place, turned, physicsClientId=client)
            p.resetBaseVelocity(number, velocity, rate, physicsClientId=client)

    def step(self, step: Step) -> None:
        """Advance by a step."""
        p, client = self._p, self._client
        if step.dt_s != self._dt or step.phase is not self._phase:
            erp = self._corrected(step) if self._s.by_phase else {}
            p.setPhysicsEngineParameter(fixedTimeStep=step.dt_s, **erp, physicsClientId=client)
            self._dt, self._phase = step.dt_s, step.phase
        if self._way:
            self._move_base(step)
        p.setGravity(step.pull_x, 0.0, step.pull_z, client)
        p.stepSimulation(client)
        self._due = step.base_x

    def _corrected(self, step: Step) -> dict[str, float]:
        """Return what a step corrects of positions: none at an impact, nor along the base at rest.

        A short step would make a velocity of it; two corners contradict each other by a rounding.
        """
        impact = step.phase in (ContactPhase.APPROACH, ContactPhase.STRIKE)
        part = 0.0 if impact else min(1.0, step.dt_s / self._ordinary)
        across = 0.0 if step.phase is ContactPhase.REST else part * part
        contact, friction = self._s.contact_erp or 0.0, self._s.friction_erp or 0.0
        return {"contactERP": part * part * contact, "frictionERP": across * friction}

    def _move_base(self, step: Step) -> None:
        """Give the base its velocity or its place, or move what holds it there."""
        p, client = self._p, self._client
        place = [step.base_x, 0.0, self.ground[2] + step.base_z]
        if self._constrained:
            p.changeConstraint(self.holder, place, maxForce=self.most_force, physicsClientId=client)
        elif self._s.floor == "velocity":
            velocity = [step.base_velocity, 0.0, step.base_rise]
            p.resetBaseVelocity(self.base, velocity, physicsClientId=client)
        else:
            p.resetBasePositionAndOrientation(self.base, place, UPRIGHT, client)

    @property
    def yaw(self) -> float:
        """How far the first body has turned; see `engines.world.World`."""
        *_, (x, y, z, w) = self._p.getBasePositionAndOrientation(self.bodies[0], self._client)
        return yaw_of(w, x, y, z)

    def state(self) -> FloatArray:
        """Read the bodies' poses back."""
        p, client, moved, raised = self._p, self._client, 0.0, 0.0
        if self._way:
            (moved, _, z), _ = p.getBasePositionAndOrientation(self.base, client)
            raised = z - self.ground[2]
            self.base_x_m = moved
            if self._constrained:
                self.lag_m = max(self.lag_m, abs(moved - self._due))
        for row, body in enumerate(self.bodies):
            (x, _, z), q = p.getBasePositionAndOrientation(body, client)
            rate = p.getBaseVelocity(body, client)[1][1]
            theta = 2.0 * math.atan2(q[1], q[3])
            if self._offset:
                x, z = x - self._offset * math.cos(theta), z + self._offset * math.sin(theta)
            self._state[row] = x - moved, z - raised, theta, rate
        return self._state

    def fault(self) -> str:
        """Say which setting was not taken, or that the step is not the one that was set."""
        engine = self._own.getPhysicsEngineParameters(physicsClientId=self._client)
        step = {"fixedTimeStep": (self._dt or None, engine["fixedTimeStep"])}
        return super().fault() or disagreement(step)

    def close(self) -> None:
        """Empty the client for the next run; a reset keeps the gap and the step: put them back."""
        self._own.resetSimulation(physicsClientId=self._client)
        with held_for_all:
            self._own.setPhysicsEngineParameter(
                contactBreakingThreshold=LIBRARY_BREAKING_THRESHOLD,
                fixedTimeStep=LIBRARY_STEP_S,
                physicsClientId=self._client,
            )
        idle.append(self._client)

    def _script(self, notes: Notes, way: str) -> Script:
        notes.name(floor=self.shapes[0], base=self.base, shape=self.shapes[1:])
        moves = bool(way)
        if way == "constraint":
            notes.name(holder=self.holder)
        heaves = self._scene.heaves
        rise = "base_rise" if heaves else "0.0"
        there = f"[base_x, 0.0, {self.ground[2]!r}{' + base_z' * heaves}]"
        move = {
            "constraint": f"p.changeConstraint(holder, {there}, maxForce={self.most_force!r})",
            "velocity": f"p.resetBaseVelocity(base, [base_velocity, 0.0, {rise}])",
            "position": f"p.resetBasePositionAndOrientation(base, {there}, {UPRIGHT})",
        }.get(way, "")
        at = "p.getBasePositionAndOrientation({})[0][0]"
        said = Script(
            imports=("import pybullet as p",),
            settings=(
                f"p.setTimeStep({self._ordinary!r})",
                *notes.quoted("Parameter", "Shape", "createMultiBody", "changeDynamics"),
            ),
            build=("p.connect(p.DIRECT)", *notes.lines(), "p.setTimeStep(DT)"),
            step=(*[move] * moves, "p.setGravity(pull_x, 0.0, pull_z)", "p.stepSimulation()"),
            pose=(
                "q = p.getBasePositionAndOrientation(bodies[number])[1]",
                "theta = 2.0 * math.atan2(q[1], q[3])",
                "rate = p.getBaseVelocity(bodies[number])[1][1]",
            ),
            place=at.format("bodies[0]") + f" - {at.format('base')}" * moves,
        )
        self.close()
        return said


def taken() -> tuple[Any, int]:
    """Return the library, and a client without a renderer that no run uses, as good as new."""
    p = imported("pybullet")
    if idle:
        return p, idle.pop()
    client = int(p.connect(p.DIRECT))
    with silence():  # a build that has none says so past Python
        renderer = p.loadPlugin("tinyRendererPlugin", physicsClientId=client)
    if renderer >= 0:
        p.unloadPlugin(renderer, physicsClientId=client)
    return p, client
