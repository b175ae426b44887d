"""PyBullet: how a scene is built, set, read back and stepped."""

import contextlib
import math
from collections.abc import Callable, Mapping, Sequence
from functools import cache, partial
from typing import Any

import numpy as np

from analytic.block import RigidBlock
from analytic.motion import SinePulse
from engines.parts.compiled import (
    INTERPRETED,
    SWITCHED_OFF,
    FloatArray,
    interpreted,
    switched_off,
)
from engines.parts.quiet import imported, silence
from engines.parts.readback import disagreement
from engines.pybullet.calls import (
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
    move_call,
)
from engines.pybullet.clients import given_back, held_for_all, taken
from engines.pybullet.fast import (
    Client,
    ContactState,
    begin_contact,
    client_of,
    clients,
    corrected,
    drive,
    once,
)
from engines.pybullet.settings import (
    LANDING,
    BulletSettings,
)
from engines.scene import Scene
from engines.world import ContactPhase, Driver, Moment, Pose, Step

TRIAL = (
    Step(1e-3, 1.0e-3, 5.00e-4, 0.0, -4.9, 0.006, 0.006, 6.00e-6, ContactPhase.SWING, 1.0),
    Step(5e-4, 1.5e-3, 7.50e-4, 0.0, -14.7, 0.009, 0.015, 1.35e-5, ContactPhase.SWING, 1.0),
    Step(2e-3, 3.5e-3, 1.25e-3, 0.0, -6.1, 0.015, 0.030, 7.35e-5, ContactPhase.SWING, 1.0),
    Step(1e-3, 4.5e-3, 1.50e-3, 0.0, -14.7, 0.018, 0.048, 1.22e-4, ContactPhase.APPROACH, 1.0),
    Step(1e-5, 4.51e-3, 5.05e-4, 0.0, -495.4, 0.006, 0.054, 1.22e-4, ContactPhase.STRIKE, 1.0),
    Step(1e-3, 5.51e-3, 5.05e-4, 0.0, -4.95, 0.006, 0.060, 1.82e-4, ContactPhase.REST, 0.0),
)
"""Steps by which a compiled loop is held against Python."""


class BulletWorld:
    """A block on a base in a PyBullet client that no other run uses meanwhile.

    The base is a multibody without mass, whether it moves or not, if no constraint moves it: of
    the massless bases PyBullet offers, the only one whose velocity friction feels. On a static
    rigid body the response to the mirrored motion is not the mirror image.
    """

    moment = Moment.MIDDLE

    def __init__(self, scene: Scene, settings: BulletSettings, dt_s: float) -> None:
        self._s, self._ordinary = settings, dt_s
        self._p = imported("pybullet")
        most, self._due, self._lag, self.base_x_m = most_force(scene), 0.0, 0.0, 0.0
        self._held_by = -1, most
        self._constrained = constrained(scene, settings)
        loops = scene.compiled and not self.obstacle
        self._client = taken(self._p)
        self._moving = scene.frame == "world"
        self._phase: ContactPhase | None = None
        self._ground = base_place(scene, settings)
        with held_for_all:
            self._set_engine(scene)
            floor = self._do(base_shape(scene, settings))
            self._base = int(self._do(base_body(scene, settings, floor)))
            self._bodies = [self._made(scene, number) for number in range(len(scene.bodies))]
            self._fault = self._set_bodies(scene)
            if self._constrained:
                self._held_by = int(self._do(hold_call(scene, settings, self._base))), most
            self._take_inertia(scene)
        self._put(scene)
        self._holds = ContactState.blank()
        self._held = self._holds[0]
        begin_contact(self._held, scene, settings, dt_s)
        self._held.block, self._held.base = self._bodies[0], self._base
        self._state = np.zeros((len(self._bodies), len(Pose._fields)))
        self._lent = self.lent() if loops else None

    def step(self, step: Step) -> None:
        """Advance by a step; see `engines.world.SteppedWorld`."""
        p, client = self._p, self._client
        if step.dt_s != self._held.dt or step.phase is not self._phase:
            erp = self._erp(step) if self._s.by_phase else {}
            p.setPhysicsEngineParameter(fixedTimeStep=step.dt_s, **erp, physicsClientId=client)
            self._held.dt, self._phase = step.dt_s, step.phase
        if self._moving:
            self._move_base(step)
        p.setGravity(step.pull_x, 0.0, step.pull_z, physicsClientId=client)
        p.stepSimulation(physicsClientId=client)
        self._due = step.base_x

    @property
    def drive(self) -> Driver | None:
        """What takes many steps at once; see `engines.world.DrivenWorld`."""
        return None if self._lent is None else partial(drive, *self._lent)

    @property
    def obstacle(self) -> str:
        """Why nothing takes many steps at once; see `engines.world.DrivenWorld`."""
        if self._constrained:
            return "the base is held by a constraint"
        if switched_off() or interpreted():
            return SWITCHED_OFF if switched_off() else INTERPRETED
        if not clients(self._p).size:
            return "the library is another build, whose clients are not known"
        return "" if loop_agrees() else "its loop does not step as Python does"

    def lent(self) -> tuple[Sequence[ContactState], Client]:
        """Return what a compiled loop steps by."""
        return self._holds, client_of(self._p, self._client, self._bodies[0], self._state)

    def state(self) -> FloatArray:
        """Read the bodies' poses back."""
        p, client, moved, raised = self._p, self._client, 0.0, 0.0
        if self._moving:
            (moved, _, z), _ = p.getBasePositionAndOrientation(self._base, physicsClientId=client)
            raised = z - self._ground[2]
            self.base_x_m, self._lag = moved, max(self._lag, abs(moved - self._due))
        for row, body in zip(self._state, self._bodies, strict=True):
            (x, _, z), q = p.getBasePositionAndOrientation(body, physicsClientId=client)
            rate = p.getBaseVelocity(body, physicsClientId=client)[1][1]
            row[:] = x - moved, z - raised, 2.0 * math.atan2(q[1], q[3]), rate
        return self._state

    @property
    def lag_m(self) -> float | None:
        """How far a held base was from where it should have been; see `engines.world.World`."""
        return self._lag if self._constrained else None

    def fault(self) -> str:
        """Say which setting was not taken, or that the step is not the one that was set."""
        engine = self._p.getPhysicsEngineParameters(physicsClientId=self._client)
        return self._fault or disagreement(
            {"fixedTimeStep": (self._held.dt or None, engine["fixedTimeStep"])}
        )

    def close(self) -> None:
        """Leave the client to the next run."""
        given_back(self._p, self._client)

    def _take_inertia(self, scene: Scene) -> None:
        """Take a step far from the base: only after its first has a body the inertia that was set.

        With the shape's own a block that is lifted or released at once would turn too fast.
        """
        p, client, upright = self._p, self._client, (0.0, 0.0, 0.0, 1.0)
        for body, place in zip(self._bodies, aloft(scene), strict=True):
            p.resetBasePositionAndOrientation(body, place, upright, physicsClientId=client)
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
        place = [step.base_x, *self._ground[1:]]
        self._do(move_call(self._s, self._base, self._held_by, place, step.base_velocity))

    def _erp(self, step: Step) -> dict[str, float]:
        """Return what a step corrects of positions."""
        held = self._held
        normal, across = corrected(step.phase, step.dt_s, held.ordinary)
        return {
            "contactERP": normal * held.contact_erp,
            "frictionERP": across * held.friction_erp,
        }

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


@cache
def loop_agrees() -> bool:
    """Return whether a loop can step a block on a moving base, and as Python does."""
    known = clients(imported("pybullet"))
    return bool(known.size) and _trial(_by_loop) == _trial(_by_calls)


def _trial(after: Callable[[BulletWorld, Step], FloatArray]) -> list[list[float]]:
    """Return the poses after each step of the trial."""
    block = RigidBlock(width=0.5, height=1.5)
    motion = SinePulse(amplitude=1.0, omega=1.0)
    scene = Scene(system=block, motion=motion, start=(0.1, 0.5), frame="world", compiled=False)
    world = BulletWorld(scene, LANDING, TRIAL[0].dt_s)
    try:
        return [after(world, step)[0].tolist() for step in TRIAL]
    finally:
        world.close()


def _by_calls(world: BulletWorld, step: Step) -> FloatArray:
    world.step(step)
    return world.state()


def _by_loop(world: BulletWorld, step: Step) -> FloatArray:
    holds, client = world.lent()
    once(holds, client, (*step[:-2], int(step.phase), step.side))
    return client.state
