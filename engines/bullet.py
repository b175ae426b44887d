"""PyBullet: how a scene is built, set, read back and stepped."""

import contextlib
import itertools
import math
import os
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from analytic.block import RigidBlock
from engines.scene import GEOMETRIES, Grip, Pose, Scene, Step, disagreement, one_of

LIBRARY_STEP_S = 1.0 / 240.0
"""The library's own time step [s]."""

LIBRARY_BREAKING_THRESHOLD = 0.02
"""The library's own gap, over a body's size, up to which it keeps a contact."""

LIBRARY_FRICTION = 0.5
"""The library's own coefficient of a body, and of the pair with its plane.urdf, whose own is 1."""

KEPT_GAP = 4.0
"""Gap up to which landing keeps a contact, in units of (p dt sin(alpha))^2 half diagonals. A pivot
rises by (theta' dt)^2 H/4 in a step, so that it is kept up to theta' = 2.8 p alpha. The free corner
must be let go: an anchor that is still kept at the next impact pulls it back to where it stood."""

SOLVERS = {
    "sequential impulse": "CONSTRAINT_SOLVER_LCP_SI",
    "PGS": "CONSTRAINT_SOLVER_LCP_PGS",
    "Dantzig": "CONSTRAINT_SOLVER_LCP_DANTZIG",
}
"""Name of a contact solver -> the library's constant."""

BASES = ("plane", "box")
"""Shape of the base."""

LARGEST_FRICTION = 10.0
"""The library clamps the coefficient of a pair, the product of the two bodies', to this."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BulletSettings:
    """Settings of PyBullet; None leaves the library's default.

    Attributes
    ----------
    geometry : str
        "box", "corners": small spheres where the corners at the base are, or "hull": a convex
        mesh of the block's eight corners.
    planar : bool
        Put two corner spheres into the middle plane instead of four at the edges; a box has its
        four corners either way.
    multibody : bool
        Build the block in reduced coordinates, as the library does by default.
    friction : float
        Coefficient between block and base, at most 10.
    step : float or None
        p dt.
    corner_radius : float
        Radius of the corner spheres over the width.
    exact_inertia : bool
        Set the moments of inertia of the homogeneous block instead of those the library derives
        from the collision shape.
    damping : float or None
        Linear and angular damping of the block.
    iterations, residual : int, float or None
        Of the contact solver: how many, and the squared velocity [m2/s2] at which they end.
    contact_erp, friction_erp : float or None
        Part of a position error that a step corrects.
    friction_anchor : bool
        Hold the point of contact by its position, too.
    contact_slop : float or None
        Penetration [m] that is left alone.
    breaking_threshold : float
        Gap, over the half diagonal, up to which a contact is kept. The library holds this once
        for the whole process, so every scene sets it.
    landing : bool
        Keep contacts only up to a gap of 4 (p dt sin(alpha))^2 half diagonals, and correct no
        positions in the short steps around an impact.
    base_geometry : str
        "plane" or "box".
    base_velocity : bool
        Give a moving base its velocity; else it is moved by position alone.
    solver : str or None
        Of the contacts: "sequential impulse", "PGS" or "Dantzig".
    warm_starting : float or None
        Part of the last step's impulses from which the solver starts.
    split_impulse, cone_friction, separating_axis : bool or None
        Correct penetration without giving it a velocity; bound friction by a cone instead of a
        pyramid; find contacts of polyhedra by separating axes.
    contact_stiffness, contact_damping : float or None
        Of a yielding contact, over m p^2 and m p; both or neither.
    """

    geometry: str = "corners"
    planar: bool = True
    multibody: bool = False
    friction: float = LARGEST_FRICTION
    step: float | None = 5e-4
    corner_radius: float = 1e-6
    exact_inertia: bool = True
    damping: float | None = 0.0
    iterations: int | None = 1000
    residual: float | None = 1e-20
    contact_erp: float | None = 1.0
    friction_erp: float | None = 0.0
    friction_anchor: bool = False
    contact_slop: float | None = 0.0
    breaking_threshold: float = LIBRARY_BREAKING_THRESHOLD
    landing: bool = False
    base_geometry: str = "plane"
    base_velocity: bool = True
    solver: str | None = None
    warm_starting: float | None = None
    split_impulse: bool | None = None
    cone_friction: bool | None = None
    separating_axis: bool | None = None
    contact_stiffness: float | None = None
    contact_damping: float | None = None

    def __post_init__(self) -> None:
        one_of("geometry", self.geometry, GEOMETRIES)
        one_of("base_geometry", self.base_geometry, BASES)
        if self.solver is not None:
            one_of("solver", self.solver, tuple(SOLVERS))
        if self.warm_starting is not None and not 0.0 <= self.warm_starting <= 1.0:
            raise ValueError(f"warm_starting is {self.warm_starting!r}; it must be from 0 to 1")
        self._check_yielding()
        if self.friction > LARGEST_FRICTION:
            raise ValueError(
                f"friction is {self.friction!r}; PyBullet allows at most {LARGEST_FRICTION:g}"
            )

    def _check_yielding(self) -> None:
        pair = (self.contact_stiffness, self.contact_damping)
        if (pair[0] is None) != (pair[1] is None):
            raise ValueError(
                f"contact_stiffness, contact_damping are {pair!r}; "
                "they must be given together or not at all"
            )
        for name in ("contact_stiffness", "contact_damping"):
            value = getattr(self, name)
            if value is not None and not 0.0 < value < math.inf:
                raise ValueError(f"{name} is {value!r}; it must be positive")


PRESETS: Mapping[str, BulletSettings] = {
    "naive": BulletSettings(
        geometry="box",
        planar=False,
        multibody=True,
        friction=LIBRARY_FRICTION,
        step=None,
        exact_inertia=False,
        damping=None,
        iterations=None,
        residual=None,
        contact_erp=None,
        friction_erp=None,
        contact_slop=None,
    ),
    "fixed": BulletSettings(),
    "landing": BulletSettings(
        step=None, residual=1e-32, friction_erp=1.0, friction_anchor=True, landing=True
    ),
}


class BulletWorld:
    """A block on a base in a PyBullet client of its own.

    The base is a multibody without mass, whether it moves or not: of the bases PyBullet offers,
    the only one whose velocity friction feels. On a static rigid body the response to the mirrored
    motion is not the mirror image.
    """

    def __init__(self, scene: Scene) -> None:
        self.settings = scene.choose(PRESETS[scene.preset])
        self.dt_s = scene.ordinary_step(self.settings.step, LIBRARY_STEP_S)
        self._p = _library()
        self._client = self._p.connect(self._p.DIRECT)
        self._gravity = scene.block.gravity
        self._moving = scene.frame == "world"
        self._grip: Grip | None = None
        self._velocity = self._moved = self._dt = 0.0
        self._set_engine(scene.block)
        self._ground = (0.0, 0.0, 0.0)
        if self.settings.base_geometry == "box":
            self._ground = (0.0, 0.0, -scene.block.height)
        self._base = self._add(0.0, self._floor(scene), False, self._ground)
        centre = (0.0, 0.0, 0.5 * scene.block.height)
        self._body = self._add(scene.mass, self._shape(scene), not self.settings.multibody, centre)
        self._fault = self._set_bodies(scene)

    def step(self, step: Step) -> None:
        """Advance by a step; see `engines.scene.World`."""
        p, client, dt_s = self._p, self._client, step.dt_s
        if dt_s != self._dt or step.grip is not self._grip:
            p.setTimeStep(dt_s, physicsClientId=client)
            if self.settings.landing:
                self._hold(step.grip, dt_s)
            self._dt, self._grip = dt_s, step.grip
        pull = -self._gravity * step.kick_s / dt_s
        if self._moving:
            self._move_base(step.base_kick)
            p.setGravity(0.0, 0.0, pull, physicsClientId=client)
        else:
            p.setGravity(-step.base_kick / dt_s, 0.0, pull, physicsClientId=client)
        p.stepSimulation(physicsClientId=client)

    def _move_base(self, base_kick: float) -> None:
        self._velocity += base_kick
        if self.settings.base_velocity:
            velocity = (self._velocity, 0.0, 0.0)
            self._p.resetBaseVelocity(self._base, velocity, physicsClientId=self._client)
            return
        self._moved += self._dt * self._velocity
        place, upright = (self._moved, *self._ground[1:]), (0.0, 0.0, 0.0, 1.0)
        self._p.resetBasePositionAndOrientation(
            self._base, place, upright, physicsClientId=self._client
        )

    def _hold(self, grip: Grip, dt_s: float) -> None:
        """Correct positions in ordinary steps alone: a short one would make a velocity of them."""
        s, part = self.settings, 0.0
        if grip not in (Grip.APPROACH, Grip.STRIKE):
            part = min(1.0, dt_s / self.dt_s) ** 2
        self._p.setPhysicsEngineParameter(
            contactERP=part * (s.contact_erp or 0.0),
            frictionERP=part * (s.friction_erp or 0.0),
            physicsClientId=self._client,
        )

    def pose(self) -> Pose:
        """Read the block's pose back."""
        p, client = self._p, self._client
        (x, _, z), q = p.getBasePositionAndOrientation(self._body, physicsClientId=client)
        rate = p.getBaseVelocity(self._body, physicsClientId=client)[1][1]
        if self._moving:
            x -= p.getBasePositionAndOrientation(self._base, physicsClientId=client)[0][0]
        return Pose(x, z, 2.0 * math.atan2(q[1], q[3]), rate)

    def fault(self) -> str:
        """Say which setting was not taken, or that the step is not the one that was set."""
        engine = self._p.getPhysicsEngineParameters(physicsClientId=self._client)
        return self._fault or disagreement({"fixedTimeStep": (self._dt, engine["fixedTimeStep"])})

    def close(self) -> None:
        """Disconnect the client, and give the library back what it holds for the process."""
        self._p.setPhysicsEngineParameter(
            contactBreakingThreshold=LIBRARY_BREAKING_THRESHOLD, physicsClientId=self._client
        )
        self._p.disconnect(self._client)

    def _set_engine(self, block: RigidBlock) -> None:
        s = self.settings
        threshold = s.breaking_threshold
        if s.landing:
            threshold = KEPT_GAP * (math.sin(block.alpha) * block.p * self.dt_s) ** 2
        wanted = {
            "numSolverIterations": s.iterations,
            "solverResidualThreshold": s.residual,
            "contactERP": s.contact_erp,
            "frictionERP": s.friction_erp,
            "contactSlop": s.contact_slop,
            "contactBreakingThreshold": threshold,
            "constraintSolverType": s.solver and getattr(self._p, SOLVERS[s.solver]),
            "warmStartingFactor": s.warm_starting,
            "useSplitImpulse": s.split_impulse,
            "enableConeFriction": s.cone_friction,
            "enableSAT": s.separating_axis,
        }
        # the library announces a solver past Python
        with _silence() if s.solver is not None else contextlib.nullcontext():
            self._p.setPhysicsEngineParameter(**_given(wanted), physicsClientId=self._client)

    def _floor(self, scene: Scene) -> int:
        if self.settings.base_geometry == "box":
            block = scene.block
            return self._box((100.0 * block.height, 100.0 * scene.depth_m, block.height))
        return int(
            self._p.createCollisionShape(
                self._p.GEOM_PLANE, planeNormal=(0.0, 0.0, 1.0), physicsClientId=self._client
            )
        )

    def _shape(self, scene: Scene) -> int:
        p, s = self._p, self.settings
        half = (0.5 * scene.block.width, 0.5 * scene.depth_m, 0.5 * scene.block.height)
        if s.geometry == "box":
            return self._box(half)
        if s.geometry == "hull":
            vertices = list(itertools.product(*((-size, size) for size in half)))
            hull = p.createCollisionShape(
                p.GEOM_MESH, vertices=vertices, physicsClientId=self._client
            )
            return int(hull)
        radius = s.corner_radius * scene.block.width
        depths = (0.0,) if s.planar else (-half[1], half[1])
        corners = [(x, y, radius - half[2]) for x in (-half[0], half[0]) for y in depths]
        spheres = p.createCollisionShapeArray(
            shapeTypes=[p.GEOM_SPHERE] * len(corners),
            radii=[radius] * len(corners),
            collisionFramePositions=corners,
            physicsClientId=self._client,
        )
        return int(spheres)

    def _box(self, half: tuple[float, float, float]) -> int:
        p, client = self._p, self._client
        return int(p.createCollisionShape(p.GEOM_BOX, halfExtents=half, physicsClientId=client))

    def _add(self, mass: float, shape: int, rigid: bool, position: tuple[float, ...]) -> int:
        body = self._p.createMultiBody(
            baseMass=mass,
            baseCollisionShapeIndex=shape,
            basePosition=position,
            useMaximalCoordinates=rigid,
            physicsClientId=self._client,
        )
        return int(body)

    def _set_bodies(self, scene: Scene) -> str:
        """Set the bodies' dynamics and say where reading them back disagrees."""
        s = self.settings
        wanted = {
            # without its mass in the same call, a block in maximal coordinates becomes NaN
            "mass": scene.mass,
            "localInertiaDiagonal": scene.inertia if s.exact_inertia else None,
            "linearDamping": s.damping,
            "angularDamping": s.damping,
        }
        if s.contact_stiffness is not None and s.contact_damping is not None:
            p = scene.block.p
            wanted["contactStiffness"] = s.contact_stiffness * scene.mass * p * p
            wanted["contactDamping"] = s.contact_damping * scene.mass * p
        self._change(self._body, lateralFriction=s.friction, **_given(wanted))
        self._change(self._base, lateralFriction=1.0)
        block, base = self._dynamics(self._body), self._dynamics(self._base)
        pairs: dict[str, tuple[Any, Any]] = {
            "mass": (scene.mass, block[0]),
            "friction of the block": (s.friction, block[1]),
            "friction of the base": (1.0, base[1]),
        }
        if s.exact_inertia:
            pairs |= {f"inertia {i}": (scene.inertia[i], block[2][i]) for i in range(3)}
        if s.iterations is not None:
            engine = self._p.getPhysicsEngineParameters(physicsClientId=self._client)
            pairs["numSolverIterations"] = (s.iterations, engine["numSolverIterations"])
        if s.multibody and s.contact_stiffness is not None:
            # a body in maximal coordinates takes them, too, but reads zeros
            pairs["contactDamping"] = (wanted["contactDamping"], block[8])
            pairs["contactStiffness"] = (wanted["contactStiffness"], block[9])
        return disagreement(pairs)

    def _change(self, body: int, **wanted: Any) -> None:
        if self.settings.friction_anchor:
            wanted["frictionAnchor"] = 1
        self._p.changeDynamics(body, -1, physicsClientId=self._client, **wanted)

    def _dynamics(self, body: int) -> tuple[Any, ...]:
        return tuple(self._p.getDynamicsInfo(body, -1, physicsClientId=self._client))


def build(scene: Scene) -> BulletWorld:
    """Build a scene, the block at rest on its base."""
    return BulletWorld(scene)


def _given(settings: Mapping[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in settings.items() if value is not None}


def _library() -> Any:
    """Import PyBullet without the line that it writes past Python to the process's output."""
    if "pybullet" in sys.modules:
        return sys.modules["pybullet"]
    with _silence():
        return import_module("pybullet")


@contextlib.contextmanager
def _silence() -> Iterator[None]:
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.flush()
    kept = {number: os.dup(number) for number in (1, 2)}
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        for number in kept:
            os.dup2(nowhere, number)
        yield
    finally:
        os.close(nowhere)
        for number, copy in kept.items():
            os.dup2(copy, number)
            os.close(copy)
