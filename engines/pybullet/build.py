"""PyBullet: how a scene is built, set, read back and stepped."""

import contextlib
import math
from collections.abc import Mapping
from threading import Lock
from typing import Any

import numpy as np

from engines.parts import imported, silence
from engines.pybullet.calls import (
    UPRIGHT,
    Call,
    Constant,
    aloft,
    base_body,
    base_call,
    base_place,
    base_shape,
    body_call,
    body_of,
    body_shape,
    constrained,
    engine_call,
    hold_call,
    most_force,
)
from engines.pybullet.settings import LIBRARY_BREAKING_THRESHOLD, LIBRARY_STEP_S, BulletSettings
from engines.scene import Scene
from engines.settings import disagreement
from engines.world import ContactPhase, FloatArray, Moment, Pose, Step

RENDERER = "tinyRendererPlugin"
"""The library's name of what draws, or would."""

held_for_all = Lock()
"""Whose gap it is up to which contacts are kept: the library holds it for the whole process, and
looks at it when two bodies meet first, on a plane while a scene is built."""

idle: list[int] = []
"""Clients of this process whose run has ended: most runs are shorter than connecting."""


class BulletWorld:
    """A block on a base in a PyBullet client that no other run uses meanwhile.

    The base is a multibody without mass, whether it moves or not, if no constraint moves it: of
    the massless bases PyBullet offers, the only one whose velocity friction feels. On a static
    rigid body the response to the mirrored motion is not the mirror image.
    """

    moment = Moment.MIDDLE

    def __init__(self, scene: Scene, settings: BulletSettings, dt_s: float) -> None:
        self._s, self._ordinary = settings, dt_s
        self._p, self._client = taken()
        self._held_by, self._most = -1, most_force(scene)
        self._due, self._lag, self.base_x_m = 0.0, 0.0, 0.0
        self._constrained = constrained(scene, settings)
        self._moving = scene.frame == "world"
        self._dt: float | None = None
        self._phase: ContactPhase | None = None
        self._ground = base_place(scene, settings)
        with held_for_all:
            self._set_engine(scene)
            floor = self._do(base_shape(scene, settings))
            self._base = int(self._do(base_body(scene, settings, floor)))
            self._bodies = [self._made(scene, number) for number in range(len(scene.bodies))]
            self._fault = self._set_bodies(scene)
            if self._constrained:
                self._held_by = int(self._do(hold_call(scene, settings, self._base)))
            self._take_inertia(scene)
        self._put(scene)
        self._state = np.zeros((len(self._bodies), len(Pose._fields)))

    def step(self, step: Step) -> None:
        """Advance by a step; see `engines.world.SteppedWorld`."""
        p, client = self._p, self._client
        if step.dt_s != self._dt or step.phase is not self._phase:
            erp = self._erp(step) if self._s.by_phase else {}
            p.setPhysicsEngineParameter(fixedTimeStep=step.dt_s, **erp, physicsClientId=client)
            self._dt, self._phase = step.dt_s, step.phase
        if self._moving:
            self._move_base(step)
        p.setGravity(step.pull_x, 0.0, step.pull_z, client)
        p.stepSimulation(client)
        self._due = step.base_x

    def state(self) -> FloatArray:
        """Read the bodies' poses back."""
        p, client, moved, raised = self._p, self._client, 0.0, 0.0
        if self._moving:
            (moved, _, z), _ = p.getBasePositionAndOrientation(self._base, client)
            raised = z - self._ground[2]
            self.base_x_m, self._lag = moved, max(self._lag, abs(moved - self._due))
        for row, body in enumerate(self._bodies):
            (x, _, z), q = p.getBasePositionAndOrientation(body, client)
            rate = p.getBaseVelocity(body, client)[1][1]
            self._state[row] = x - moved, z - raised, 2.0 * math.atan2(q[1], q[3]), rate
        return self._state

    @property
    def lag_m(self) -> float | None:
        """How far a held base was from where it should have been; see `engines.world.World`."""
        return self._lag if self._constrained else None

    def fault(self) -> str:
        """Say which setting was not taken, or that the step is not the one that was set."""
        engine = self._p.getPhysicsEngineParameters(physicsClientId=self._client)
        return self._fault or disagreement({"fixedTimeStep": (self._dt, engine["fixedTimeStep"])})

    def close(self) -> None:
        """Leave the client to the next run."""
        given_back(self._p, self._client)

    def _take_inertia(self, scene: Scene) -> None:
        """Take a step far from the base: only after its first has a body the inertia that was set.

        With the shape's own a block that is lifted or released at once would turn too fast.
        """
        p, client = self._p, self._client
        for body, place in zip(self._bodies, aloft(scene), strict=True):
            p.resetBasePositionAndOrientation(body, place, UPRIGHT, physicsClientId=client)
        p.stepSimulation(physicsClientId=client)

    def _put(self, scene: Scene) -> None:
        """Let the bodies set out from where the scene begins."""
        p, client = self._p, self._client
        for number, body in zip(self._bodies, scene.bodies, strict=True):
            at, half = body.at, 0.5 * body.at.theta
            turned, place = (0.0, math.sin(half), 0.0, math.cos(half)), (at.x, 0.0, at.z)
            velocity, rate = (at.velocity_x, 0.0, at.velocity_z), (0.0, at.rate, 0.0)
            p.resetBasePositionAndOrientation(number, place, turned, physicsClientId=client)
            p.resetBaseVelocity(number, velocity, rate, physicsClientId=client)

    def _move_base(self, step: Step) -> None:
        """Give the base its velocity or its place, or move what holds it there."""
        p, client, place = self._p, self._client, [step.base_x, *self._ground[1:]]
        if self._constrained:
            p.changeConstraint(self._held_by, place, maxForce=self._most, physicsClientId=client)
        elif self._s.floor == "velocity":
            p.resetBaseVelocity(self._base, [step.base_velocity, 0.0, 0.0], physicsClientId=client)
        else:
            p.resetBasePositionAndOrientation(self._base, place, UPRIGHT, client)

    def _erp(self, step: Step) -> dict[str, float]:
        """Return what a step corrects of positions."""
        normal, across = corrected(step.phase, step.dt_s, self._ordinary)
        contact, friction = self._s.contact_erp or 0.0, self._s.friction_erp or 0.0
        return {"contactERP": normal * contact, "frictionERP": across * friction}

    def _set_engine(self, scene: Scene) -> None:
        # the library announces a solver past Python
        with silence() if self._s.solver is not None else contextlib.nullcontext():
            self._do(engine_call(scene, self._s, self._ordinary))

    def _do(self, call: Call) -> Any:
        """Make a call in this world's client."""
        arguments = {name: self._value(value) for name, value in call.arguments.items()}
        return getattr(self._p, call.name)(**arguments, physicsClientId=self._client)

    def _value(self, value: Any) -> Any:
        if isinstance(value, Constant):
            return getattr(self._p, value)
        return [self._value(item) for item in value] if isinstance(value, list) else value

    def _made(self, scene: Scene, number: int) -> int:
        """Make a body; return its number in the library."""
        shape = self._do(body_shape(scene, number, self._s, self._ordinary))
        return int(self._do(body_of(scene.bodies[number], self._s, shape)))

    def _set_bodies(self, scene: Scene) -> str:
        """Set the bodies' dynamics and say where reading them back disagrees."""
        faults = []
        for number, body in enumerate(self._bodies):
            call = body_call(scene, number, self._s, body)
            self._do(call)
            if not number:
                self._do(base_call(self._s, self._base))
            faults.append(self._read_back(scene, number, call.arguments))
        return next(filter(None, faults), "")

    def _read_back(self, scene: Scene, number: int, wanted: Mapping[str, Any]) -> str:
        s, body = self._s, scene.bodies[number]
        block, base = self._dynamics(self._bodies[number]), self._dynamics(self._base)
        engine = self._p.getPhysicsEngineParameters(physicsClientId=self._client)
        pairs: dict[str, tuple[Any, Any]] = {
            "mass": (body.mass, block[0]),
            "friction of the block": (s.friction, block[1]),
            "friction of the base": (1.0, base[1]),
            "numSolverIterations": (s.iterations_of(scene), engine["numSolverIterations"]),
        }
        if s.exact_inertia:
            pairs |= {f"inertia {i}": (body.inertia[i], block[2][i]) for i in range(3)}
        if s.multibody:
            # a body in maximal coordinates takes them, too, but reads zeros
            pairs["restitution"] = (s.restitution, block[5])
            pairs["contactDamping"] = (wanted.get("contactDamping"), block[8])
            pairs["contactStiffness"] = (wanted.get("contactStiffness"), block[9])
        return disagreement(pairs)

    def _dynamics(self, body: int) -> tuple[Any, ...]:
        return tuple(self._p.getDynamicsInfo(body, -1, physicsClientId=self._client))


def taken() -> tuple[Any, int]:
    """Return the library, and a client that no run uses, as good as new.

    It is without a renderer, whose meshes take longer to make than the bodies.
    """
    p = imported("pybullet")
    if idle:
        return p, idle.pop()
    client = int(p.connect(p.DIRECT))
    with silence():  # a build that has none says so past Python
        renderer = p.loadPlugin(RENDERER, physicsClientId=client)
    if renderer >= 0:
        p.unloadPlugin(renderer, physicsClientId=client)
    return p, client


def given_back(p: Any, client: int) -> None:
    """Empty a client of the library for the next run, and put back what a reset keeps."""
    p.resetSimulation(physicsClientId=client)
    with held_for_all:
        p.setPhysicsEngineParameter(
            contactBreakingThreshold=LIBRARY_BREAKING_THRESHOLD,
            fixedTimeStep=LIBRARY_STEP_S,
            physicsClientId=client,
        )
    idle.append(client)


def corrected(phase: ContactPhase, dt_s: float, ordinary_s: float) -> tuple[float, float]:
    """Return the parts of a position's error to correct, along a contact's normal and across it.

    None in a step around an impact: a short step would make a velocity of it. None across at rest,
    where the places that two corners are held at contradict each other by a rounding, and the
    solver would look for a compromise until its iterations end.

    Parameters
    ----------
    phase : ContactPhase, of the step
    dt_s, ordinary_s : float, its length, and that of an ordinary one [s]

    Returns
    -------
    (float, float)
        Each from 0 to 1.
    """
    if phase in (ContactPhase.APPROACH, ContactPhase.STRIKE):
        return 0.0, 0.0
    part = min(1.0, dt_s / ordinary_s)
    return part * part, 0.0 if phase is ContactPhase.REST else part * part
