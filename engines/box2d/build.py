"""Box2D: how a scene is built, set, read back and stepped.

The library computes in single precision, and clamps without a word what moves further than two
units of length in a step: a tuned preset counts in parts of the block's height. Contacts lie
halfway between the surfaces of two shapes, so that half of the pivot's margin is the corner's
radius, and half is the height by which its floor is raised.
"""

from types import SimpleNamespace
from typing import Any

import numpy as np

from engines.box2d.settings import Box2DSettings
from engines.declaration import Precision
from engines.parts import FLOOR_HEIGHTS, imported
from engines.parts.script import Script, filled, moved, settings_of
from engines.scene import BASE, Scene
from engines.settings import disagreement
from engines.world import ContactPhase, FloatArray, Moment, Pose, Step

MOST_REFLECTION = 2.0
"""A step that is much longer than the one before gives back no more than this part."""

LIBRARY_STEP_S = 1.0 / 60.0


def numbers(scene: Scene, s: Box2DSettings, dt_s: float) -> SimpleNamespace:
    """Return the numbers of a scene in the settings' unit of length."""
    unit, sunk, reach = s.unit_of(scene), s.sunk_of(scene), s.reach_of(scene, dt_s)
    return SimpleNamespace(
        **{"unit": unit, "sunk": sunk, "reach": reach, "high": reach - sunk},
        **{"far": FLOOR_HEIGHTS * scene.bodies[0].height * unit},
        bodies=[of_body(scene, number, unit, sunk) for number in range(len(scene.bodies))],
    )


def of_body(scene: Scene, number: int, unit: float, sunk: float) -> SimpleNamespace:
    """Return the numbers of a body, and of the corners by which it touches others."""
    body = scene.bodies[number]
    at, x, z = body.at, 0.5 * body.width * unit, 0.5 * body.height * unit
    corners = [
        SimpleNamespace(at=(side * x, contact.face * z), **filtered(contact.on, k))
        for contact in scene.layout.contacts
        if contact.body == number
        for k, side in enumerate((-1.0, 1.0))
    ]
    return SimpleNamespace(
        **{"x": x, "z": z, "mass": body.mass, "inertia": body.inertia[1] * unit**2},
        **{"place": (at.x * unit, at.z * unit - sunk), "angle": -at.theta, "at_rest": at.at_rest},
        **{"velocity": (at.velocity_x * unit, at.velocity_z * unit), "rate": -at.rate},
        **{"corners": corners, "carried": scene.layout.rests(number)},
    )


def filtered(on: int, side: int) -> dict[str, int]:
    """Return what a corner is and meets: a floor of its own side, or any body that rests on it."""
    return {"own": 1 << side, "meets": 4 << side} if on == BASE else {"own": 16, "meets": 32}


def values(scene: Scene, s: Box2DSettings) -> SimpleNamespace:
    """Return settings as the library is given them."""
    pairs = 2 if s.geometry == "corners" else 1
    return SimpleNamespace(
        **{"geometry": s.geometry, "pairs": pairs, "skins": s.skins_below * 2.0 / pairs},
        **{"friction": float(s.friction), "restitution": s.restitution},
        **{"iterations": s.iterations_of(scene), "position_iterations": s.position_iterations},
        **{"continuous": s.continuous, "sleeping": s.sleeping},
    )


def build(Box2D: Any, n: Any, s: Any) -> Any:
    """Build bodies on one kinematic body, or on one for each corner of a block."""
    world = Box2D.b2World(gravity=(0.0, 0.0))
    world.continuousPhysics = s.continuous
    bodies = []
    for b in n.bodies:
        block = world.CreateDynamicBody(position=b.place, angle=b.angle)
        bodies.append(block)
        if s.geometry == "corners":
            for c in b.corners:
                shape = Box2D.b2CircleShape(pos=c.at, radius=n.reach)
                meets = Box2D.b2Filter(categoryBits=c.own, maskBits=c.meets)
                corner = block.CreateFixture(shape=shape, friction=s.friction, filter=meets)
                corner.restitution = s.restitution
            if b.carried:
                low = s.skins * Box2D.b2_polygonRadius - b.z
                shape = Box2D.b2PolygonShape(
                    vertices=[(-b.x, low), (b.x, low), (b.x, b.z), (-b.x, b.z)]
                )
                meets = Box2D.b2Filter(categoryBits=32, maskBits=16)
                block.CreateFixture(shape=shape, friction=s.friction, filter=meets)
        else:
            shape = Box2D.b2PolygonShape(box=(b.x, b.z))
            block.CreateFixture(shape=shape, friction=s.friction, restitution=s.restitution)
        block.massData = Box2D.b2MassData(mass=b.mass, center=(0.0, 0.0), I=b.inertia)
        if not b.at_rest:
            block.linearVelocity, block.angularVelocity = b.velocity, b.rate
        block.sleepingAllowed = s.sleeping  # the world's own doSleep is read back, and does nothing
    top = -s.skins * Box2D.b2_polygonRadius  # a polygon acts from its skin on
    ground = [(-n.far, -n.far), (n.far, -n.far), (n.far, top), (-n.far, top)]
    floors = [world.CreateKinematicBody(position=(0.0, n.high)) for _ in range(s.pairs)]
    for k, floor in enumerate(floors):
        shape = Box2D.b2PolygonShape(vertices=ground)
        fixture = floor.CreateFixture(shape=shape, friction=s.friction)
        if s.geometry == "corners":
            fixture.filterData = Box2D.b2Filter(categoryBits=4 << k, maskBits=1 << k)
    return world, bodies, floors


FLOORS = {
    "velocity": (
        "for floor in floors:",
        "    floor.linearVelocity = ({x} - floor.position.x) / DT, 0.0",
    ),
    "both": (
        "for floor in floors:",
        "    floor.position = {x} - DT * {v}, floor.position.y",
        "    floor.linearVelocity = {v}, 0.0",
    ),
}
"""How a script moves a floor that carries, to a place x with velocity v in units of length."""


def script(scene: Scene, settings: Box2DSettings, dt_s: float) -> Script:
    """Return a scene as calls of Box2D; see `engines.parts.script`."""
    n, s = numbers(scene, settings, dt_s), values(scene, settings)
    lines = filled(build, n=n, s=s)
    step = f"world.Step({{}}, {s.iterations}, {s.position_iterations})"
    led = f"floors[0].position.x / {n.unit!r}" if settings.floor == "velocity" else "base_x"
    under = f" - {led}" * (scene.frame == "world")
    return Script(
        imports=("import Box2D",),
        settings=(step.format(repr(dt_s)), *settings_of(lines)),
        build=tuple(line.text for line in lines),
        step=(
            f"world.gravity = pull_x * {n.unit!r}, pull_z * {n.unit!r}",
            *moved(scene, settings.floor, n.unit, FLOORS),
            step.format("DT"),
        ),
        pose=("theta, rate = -bodies[number].angle, -bodies[number].angularVelocity",),
        place=f"bodies[0].position.x / {n.unit!r}{under}",
    )


class Box2DWorld:
    """Bodies on one kinematic body, or on one for each corner of a block."""

    moment = Moment.MIDDLE

    def __init__(self, scene: Scene, settings: Box2DSettings, dt_s: float) -> None:
        self.settings = settings
        self._way = settings.floor if scene.frame == "world" else ""
        self._dt = self._speed = self._place = self.lag_m = 0.0
        n, self._values = numbers(scene, settings, dt_s), values(scene, settings)
        self._unit, self._sunk, self._reach = n.unit, n.sunk, n.reach
        self._half = n.bodies[0].x, n.bodies[0].z
        self._world, self._bodies, self._floors = build(imported("Box2D"), n, self._values)
        self._body, self._state = self._bodies[0], np.zeros((len(self._bodies), len(Pose._fields)))
        self._fault = self._read_back(scene)

    def step(self, step: Step) -> None:
        """Advance by a step."""
        self._world.gravity = (step.pull_x * self._unit, step.pull_z * self._unit)
        back, before, self._dt = 0.0, self._dt, step.dt_s
        if (
            self.settings.reflection
            and before
            and step.phase in (ContactPhase.SWING, ContactPhase.APPROACH)
        ):
            back = min(step.dt_s / before, MOST_REFLECTION)
        led = self._way == "velocity"
        at = (step.base_x - step.dt_s * step.base_velocity) * self._unit if self._way else 0.0
        felt = step.base_velocity * self._unit if self._way == "both" else 0.0
        for side, floor in zip((-1.0, 1.0), self._floors, strict=False):
            pivot = step.phase is ContactPhase.REST or step.side in (side, 0.0)
            if led:
                felt = (step.base_x * self._unit - floor.position.x) / step.dt_s
            else:
                floor.position = (at, (self._reach if pivot else -self._reach) - self._sunk)
            velocity = (felt, 0.0)
            if back and pivot and step.side:
                x, z = self._body.GetLinearVelocityFromLocalPoint(
                    (side * self._half[0], -self._half[1])
                )
                velocity = (felt - back * (x - self._speed), -back * z)
            floor.linearVelocity = velocity
        s = self._values
        self._world.Step(step.dt_s, s.iterations, s.position_iterations)
        self._speed, self._place = felt, step.base_x if self._way else 0.0
        if led:
            self._place = self._floors[0].position.x / self._unit
            self.lag_m = max(self.lag_m, abs(self._place - step.base_x))

    def state(self) -> FloatArray:
        """Read the bodies' poses back."""
        for number, body in enumerate(self._bodies):
            x, z = body.position
            place, level = x / self._unit - self._place, (z + self._sunk) / self._unit
            self._state[number] = place, level, -body.angle, -body.angularVelocity
        return self._state

    def fault(self) -> str:
        """Say which setting was not taken."""
        return self._fault

    def close(self) -> None:
        """Release the engine's memory."""
        for body in (*self._bodies, *self._floors):
            self._world.DestroyBody(body)

    def _read_back(self, scene: Scene) -> str:
        body, s, masses = self._body, self.settings, {}
        for number, (wanted, found) in enumerate(zip(scene.bodies, self._bodies, strict=True)):
            masses[f"mass {number}"] = (wanted.mass, found.mass)
            inertia = wanted.inertia[1] * self._unit**2
            masses[f"inertia {number}"] = (inertia, found.inertia)
        return disagreement(
            {
                **masses,
                "friction": (s.friction, body.fixtures[0].friction),
                "restitution": (s.restitution, body.fixtures[0].restitution),
                "sleeping": (s.sleeping, body.sleepingAllowed),
                "continuous": (s.continuous, self._world.continuousPhysics),
            },
            Precision.SINGLE.value,
        )
