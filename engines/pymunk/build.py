"""pymunk (Chipmunk2D): how a scene is built, set, read back and stepped.

The library moves positions before it changes velocities, and scales cached impulses by the ratio
of two steps: a short step before a long one would throw the block. Where steps differ, a preset
therefore keeps the library's step as it is, gives each step its own gravity, and moves the
positions itself, by the library's own function, from the library's own velocities.
"""

import math
from typing import Any

from engines.parts.quiet import imported
from engines.parts.readback import disagreement
from engines.parts.shapes import FLOOR_HEIGHTS
from engines.pymunk.settings import LEVEL, PymunkSettings
from engines.scene import Scene
from engines.world import Grip, Moment, Pose, Step

UNIT_S = 1e-3
"""Step [s] that the library is told where the positions are not its own to move."""

MOST_REFLECTION = 2.0
"""A step that is much longer than the one before gives back no more than this part."""

LIBRARY_STEP_S = 0.02
README = "the library's own first example, space.step(0.02)"


class PymunkWorld:
    """A block on a body that does not move by itself."""

    def __init__(self, scene: Scene, settings: PymunkSettings, dt_s: float) -> None:
        self.settings = settings
        self._pm: Any = imported("pymunk")
        self._half = (0.5 * scene.block.width, 0.5 * scene.block.height)
        self._margin = settings.margin_of(scene, dt_s)
        self._moving, self._dt = scene.frame == "world", 0.0
        self._iterations = settings.iterations_of(scene)
        self._space = self._pm.Space()
        self._base = self._pm.Body(body_type=self._pm.Body.KINEMATIC)
        self._body = self._pm.Body(scene.mass, scene.inertia[1])
        self._set(scene, settings.slop_of(scene, dt_s))
        self._space.add(self._base, self._body, *self._shapes(scene))
        self._fault = self._read_back(scene)

    @property
    def moment(self) -> Moment:
        """At which moment of a step the velocity of a pose holds."""
        return Moment.MIDDLE if self.settings.positions else Moment.NEXT

    def step(self, step: Step) -> None:
        """Advance by a step."""
        own = self.settings.positions
        dt = UNIT_S if own else step.dt_s
        self._space.gravity = (step.pull_x * step.dt_s / dt, step.pull_z * step.dt_s / dt)
        if self.settings.geometry == "corners":
            self._hold(step)
        if self._moving and self.settings.base_velocity:
            self._base.velocity = (step.base_velocity, 0.0)
        self._space.step(dt)
        if self._moving:
            self._base.position = (step.base_x, 0.0)
        if own:
            self._pm.Body.update_position(self._body, step.dt_s)

    def pose(self) -> Pose:
        """Read the block's pose back."""
        body, (base_x, _) = self._body, self._base.position
        x, z = body.position
        return Pose(x - base_x, z, -body.angle, -body.angular_velocity)

    def fault(self) -> str:
        """Say which setting was not taken."""
        return self._fault

    def close(self) -> None:
        """Release the engine's memory."""
        self._space.remove(*self._space.shapes, *self._space.bodies)

    def _set(self, scene: Scene, slop: float | None) -> None:
        s, begin = self.settings, scene.beginning
        space, body = self._space, self._body
        for name, value in {
            "iterations": self._iterations,
            "collision_slop": slop,
            "collision_bias": s.bias,
        }.items():
            if value is not None:
                setattr(space, name, value)
        body.position, body.angle = (begin.x, begin.z), -begin.theta
        body.velocity = (begin.velocity_x, begin.velocity_z)
        body.angular_velocity = -begin.rate
        self._base.position_func = _stay
        if s.positions:
            body.position_func = _stay

    def _shapes(self, scene: Scene) -> list[Any]:
        """Make what touches what; a corner and the polygon under it meet no other."""
        pm, s, (x, z) = self._pm, self.settings, self._half
        far = FLOOR_HEIGHTS * scene.block.height
        if s.geometry == "box":
            box = pm.Poly(self._body, [(-x, -z), (x, -z), (x, z), (-x, z)])
            floor = pm.Segment(self._base, (-far, 0.0), (far, 0.0), 0.0)
            self._corners, self._floors = [box], [floor]
        else:
            deep = [(-far, -far), (far, -far), (far, 0.0), (-far, 0.0)]
            self._corners = [pm.Circle(self._body, 0.0, (at, -z)) for at in (-x, x)]
            # the radius that a floor is made with bounds the ones that it is given later
            self._floors = [pm.Poly(self._base, deep, radius=self._margin) for _ in range(2)]
        for number, pair in enumerate(zip(self._corners, self._floors, strict=True)):
            for shape in pair:
                shape.friction = math.sqrt(s.friction)
                bit = 1 << number
                shape.filter = pm.ShapeFilter(categories=bit, mask=bit)
        return [*self._corners, *self._floors]

    def _hold(self, step: Step) -> None:
        """Keep the pivot in contact, and give its velocity back while the block turns about it."""
        back, before, self._dt = 0.0, self._dt, step.dt_s
        turning = step.grip in (Grip.SWING, Grip.APPROACH)
        if self.settings.reflection and before and turning:
            back = min(step.dt_s / before, MOST_REFLECTION)
        bounce = self.settings.restitution * self.settings.base_restitution
        about = step.side or -self._body.angle  # equal steps do not say
        for side, corner, floor in zip((-1.0, 1.0), self._corners, self._floors, strict=True):
            pivot = step.grip is Grip.REST or side * about >= -LEVEL
            floor.unsafe_set_radius(self._margin if pivot else 0.0)
            returned = back if pivot and step.side else 0.0
            corner.elasticity, floor.elasticity = 1.0, max(returned, bounce)
            slip = 0.0
            if returned:
                at = (side * self._half[0], -self._half[1])
                slip = self._body.velocity_at_local_point(at)[0] - self._base.velocity[0]
            corner.surface_velocity = (returned * slip, 0.0)

    def _read_back(self, scene: Scene) -> str:
        s, space = self.settings, self._space
        return disagreement(
            {
                "mass": (scene.mass, self._body.mass),
                "moment": (scene.inertia[1], self._body.moment),
                "friction": (s.friction, self._corners[0].friction * self._floors[0].friction),
                "iterations": (self._iterations, space.iterations),
                "slop": (None if s.margin else s.slop, space.collision_slop),
                "bias": (s.bias, space.collision_bias),
            }
        )


def _stay(body: Any, dt: float) -> None:
    """Leave a body where it is: the adapter moves it."""
