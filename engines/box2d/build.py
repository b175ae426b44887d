"""Box2D: how a scene is built, set, read back and stepped.

The library computes in single precision, and clamps without a word what moves further than two
units of length in a step: a tuned preset counts in parts of the block's height. Contacts lie
halfway between the surfaces of two shapes, so that half of the pivot's margin is the corner's
radius, and half is the height by which its floor is raised.
"""

from typing import Any

from engines.box2d.settings import Box2DSettings
from engines.declaration import Precision
from engines.parts.quiet import imported
from engines.parts.readback import disagreement
from engines.parts.shapes import FLOOR_HEIGHTS
from engines.scene import Scene
from engines.world import Grip, Moment, Pose, Step

MOST_REFLECTION = 2.0
"""A step that is much longer than the one before gives back no more than this part."""

LIBRARY_STEP_S = 1.0 / 60.0
MANUAL = "the library's own hello world, 1/60 s with 6 and 2 iterations"


class Box2DWorld:
    """A block on one kinematic body, or on one for each corner."""

    moment = Moment.MIDDLE

    def __init__(self, scene: Scene, settings: Box2DSettings, dt_s: float) -> None:
        self.settings = settings
        block, self._box2d = scene.block, imported("Box2D")
        self._unit = settings.unit_of(scene)
        self._moving = scene.frame == "world"
        self._dt = self._speed = self._place = 0.0
        self._half = (0.5 * block.width * self._unit, 0.5 * block.height * self._unit)
        self._sunk = settings.sunk_of(scene)
        self._reach = settings.reach_of(scene, dt_s)
        self._iterations = settings.iterations_of(scene)
        self._world = self._box2d.b2World(gravity=(0.0, 0.0))
        self._world.continuousPhysics = settings.continuous
        self._far = FLOOR_HEIGHTS * block.height * self._unit
        self._body = self._built(scene)
        self._floors = [self._floor(number) for number in range(self._pairs)]
        self._fault = self._read_back(scene)

    def step(self, step: Step) -> None:
        """Advance by a step."""
        self._world.gravity = (step.pull_x * self._unit, step.pull_z * self._unit)
        base = step.base_velocity * self._unit if self._moving else 0.0
        back, before, self._dt = 0.0, self._dt, step.dt_s
        if self.settings.reflection and before and step.grip in (Grip.SWING, Grip.APPROACH):
            back = min(step.dt_s / before, MOST_REFLECTION)
        at = (step.base_x - step.dt_s * step.base_velocity) * self._unit if self._moving else 0.0
        felt = base if self.settings.base_velocity else 0.0
        for side, floor in zip((-1.0, 1.0), self._floors, strict=False):
            pivot = step.grip is Grip.REST or step.side in (side, 0.0)
            floor.position = (at, (self._reach if pivot else -self._reach) - self._sunk)
            velocity = (felt, 0.0)
            if back and pivot and step.side:
                x, z = self._body.GetLinearVelocityFromLocalPoint(
                    (side * self._half[0], -self._half[1])
                )
                velocity = (felt - back * (x - self._speed), -back * z)
            floor.linearVelocity = velocity
        self._world.Step(step.dt_s, self._iterations, self.settings.position_iterations)
        self._speed, self._place = felt, step.base_x if self._moving else 0.0

    def pose(self) -> Pose:
        """Read the block's pose back."""
        body, (x, z) = self._body, self._body.position
        return Pose(
            x / self._unit - self._place,
            (z + self._sunk) / self._unit,
            -body.angle,
            -body.angularVelocity,
        )

    def fault(self) -> str:
        """Say which setting was not taken."""
        return self._fault

    def close(self) -> None:
        """Release the engine's memory."""
        for body in (self._body, *self._floors):
            self._world.DestroyBody(body)

    @property
    def _pairs(self) -> int:
        return 2 if self.settings.geometry == "corners" else 1

    def _built(self, scene: Scene) -> Any:
        b2, s, begin, unit = self._box2d, self.settings, scene.beginning, self._unit
        body = self._world.CreateDynamicBody(
            position=(begin.x * unit, begin.z * unit - self._sunk), angle=-begin.theta
        )
        if s.geometry == "box":
            body.CreateFixture(
                shape=b2.b2PolygonShape(box=self._half),
                friction=s.friction,
                restitution=s.restitution,
            )
        else:
            for number, side in enumerate((-1.0, 1.0)):
                body.CreateFixture(
                    shape=b2.b2CircleShape(
                        pos=(side * self._half[0], -self._half[1]), radius=self._reach
                    ),
                    friction=s.friction,
                    restitution=s.restitution,
                    filter=b2.b2Filter(categoryBits=1 << number, maskBits=4 << number),
                )
        body.massData = b2.b2MassData(
            mass=scene.mass, center=(0.0, 0.0), I=scene.inertia[1] * unit**2
        )
        body.linearVelocity = (begin.velocity_x * unit, begin.velocity_z * unit)
        body.angularVelocity = -begin.rate
        body.sleepingAllowed = s.sleeping  # the world's own doSleep is read back, and does nothing
        return body

    def _floor(self, number: int) -> Any:
        """Make a floor; a polygon acts from its skin on, and a box has one of its own."""
        b2, far = self._box2d, self._far
        if self.settings.geometry == "box":
            skins, meets = 2.0, b2.b2Filter()
        else:
            skins = 1.0
            meets = b2.b2Filter(categoryBits=4 << number, maskBits=1 << number)
        top = -skins * b2.b2_polygonRadius if self.settings.skins_below else 0.0
        floor = self._world.CreateKinematicBody(position=(0.0, 0.0))
        corners = [(-far, -far), (far, -far), (far, top), (-far, top)]
        floor.CreateFixture(
            shape=b2.b2PolygonShape(vertices=corners),
            friction=self.settings.friction,
            filter=meets,
        )
        return floor

    def _read_back(self, scene: Scene) -> str:
        body, s = self._body, self.settings
        return disagreement(
            {
                "mass": (scene.mass, body.mass),
                "inertia": (scene.inertia[1] * self._unit**2, body.inertia),
                "friction": (s.friction, body.fixtures[0].friction),
                "restitution": (s.restitution, body.fixtures[0].restitution),
                "sleeping": (s.sleeping, body.sleepingAllowed),
                "continuous": (s.continuous, self._world.continuousPhysics),
            },
            Precision.SINGLE.value,
        )
