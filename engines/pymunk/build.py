"""pymunk (Chipmunk2D): how a scene is built, set, read back and stepped.

The library moves positions before it changes velocities, and scales cached impulses by the ratio
of two steps: a short step before a long one would throw the block. Where steps differ, a preset
therefore keeps the library's step as it is, gives each step its own gravity, and moves the
positions itself, by the library's own function, from the library's own velocities.
"""

import math
from types import SimpleNamespace
from typing import Any

from engines.parts.quiet import imported
from engines.parts.readback import disagreement
from engines.parts.script import Script, defined, filled, settings_of
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


def numbers(scene: Scene) -> SimpleNamespace:
    """Return the numbers of a scene."""
    at, block = scene.beginning, scene.block
    return SimpleNamespace(
        **{"x": 0.5 * block.width, "z": 0.5 * block.height, "far": FLOOR_HEIGHTS * block.height},
        **{"mass": scene.mass, "inertia": scene.inertia[1]},
        **{"place": (at.x, at.z), "angle": -at.theta, "at_rest": at.at_rest},
        **{"velocity": (at.velocity_x, at.velocity_z), "rate": -at.rate},
    )


def values(scene: Scene, s: PymunkSettings, dt_s: float) -> SimpleNamespace:
    """Return settings as the library is given them, for ordinary steps dt_s [s]."""
    return SimpleNamespace(
        **{"geometry": s.geometry, "friction": float(s.friction), "bias": s.bias, "level": -LEVEL},
        **{"iterations": s.iterations_of(scene), "slop": s.slop_of(scene, dt_s)},
        margin=s.margin_of(scene, dt_s),
    )


def build(pymunk: Any, n: Any, s: Any) -> Any:
    """Build a block on a body that does not move by itself; see `engines.parts.script`."""
    space = pymunk.Space()
    if s.iterations is not None:
        space.iterations = s.iterations
    if s.slop is not None:
        space.collision_slop = s.slop
    if s.bias is not None:
        space.collision_bias = s.bias
    base = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    block = pymunk.Body(n.mass, n.inertia)
    block.position, block.angle = n.place, n.angle
    if not n.at_rest:
        block.velocity, block.angular_velocity = n.velocity, n.rate
    if s.geometry == "box":
        corners = [pymunk.Poly(block, [(-n.x, -n.z), (n.x, -n.z), (n.x, n.z), (-n.x, n.z)])]
        floors = [pymunk.Segment(base, (-n.far, 0.0), (n.far, 0.0), 0.0)]
    else:
        corners = [pymunk.Circle(block, 0.0, (x, -n.z)) for x in (-n.x, n.x)]
        deep = [(-n.far, -n.far), (n.far, -n.far), (n.far, 0.0), (-n.far, 0.0)]
        # the radius that a floor is made with bounds the ones that it is given later
        floors = [pymunk.Poly(base, deep, radius=s.margin) for _ in corners]
    for number, pair in enumerate(zip(corners, floors, strict=True)):
        for shape in pair:  # a corner meets its own floor alone
            shape.friction = math.sqrt(s.friction)  # the product counts
            shape.filter = pymunk.ShapeFilter(categories=1 << number, mask=1 << number)
    space.add(base, block, *corners, *floors)
    return space, base, block, corners, floors


def hold(floors: Any, about: float, s: Any) -> None:
    """Keep the corner in contact about which the block turns, both where it turns about neither."""
    for side, floor in zip((-1.0, 1.0), floors, strict=True):
        floor.unsafe_set_radius(s.margin if side * about >= s.level else 0.0)


def script(scene: Scene, settings: PymunkSettings, dt_s: float) -> Script:
    """Return a scene on a base at rest as calls of pymunk; see `engines.parts.script`."""
    s = values(scene, settings, dt_s)
    lines = filled(build, n=numbers(scene), s=s)
    held = defined(hold, s=s) if s.margin else ()
    return Script(
        imports=("import pymunk",),
        settings=(f"space.step({dt_s!r})", *settings_of(lines)),
        build=tuple(line.text for line in (*lines, *held)),
        step=(
            *("hold(floors, -block.angle)",) * bool(held),
            *("space.gravity = pull_x, pull_z", "space.step(DT)"),
        ),
        pose=("theta, rate = -block.angle, -block.angular_velocity",),
        moment=Moment.MIDDLE if settings.positions else Moment.NEXT,
    )


class PymunkWorld:
    """A block on a body that does not move by itself."""

    def __init__(self, scene: Scene, settings: PymunkSettings, dt_s: float) -> None:
        self.settings = settings
        self._pm: Any = imported("pymunk")
        self._half = (0.5 * scene.block.width, 0.5 * scene.block.height)
        self._moving, self._dt = scene.frame == "world", 0.0
        self._values = values(scene, settings, dt_s)
        built = build(self._pm, numbers(scene), self._values)
        self._space, self._base, self._body, self._corners, self._floors = built
        self._base.position_func = _stay
        if settings.positions:
            self._body.position_func = _stay
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

    def _hold(self, step: Step) -> None:
        """Keep the pivot in contact, and give its velocity back while the block turns about it."""
        back, before, self._dt = 0.0, self._dt, step.dt_s
        turning = step.grip in (Grip.SWING, Grip.APPROACH)
        if self.settings.reflection and before and turning:
            back = min(step.dt_s / before, MOST_REFLECTION)
        bounce = self.settings.restitution * self.settings.base_restitution
        # equal steps do not say about which corner
        about = 0.0 if step.grip is Grip.REST else step.side or -self._body.angle
        hold(self._floors, about, self._values)
        for side, corner, floor in zip((-1.0, 1.0), self._corners, self._floors, strict=True):
            returned = back if side * about >= -LEVEL and step.side else 0.0
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
                "iterations": (self._values.iterations, space.iterations),
                "slop": (None if s.margin else s.slop, space.collision_slop),
                "bias": (s.bias, space.collision_bias),
            }
        )


def _stay(body: Any, dt: float) -> None:
    """Leave a body where it is: the adapter moves it."""
