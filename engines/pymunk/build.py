"""pymunk (Chipmunk2D): how a scene is built, set, read back and stepped.

The library moves positions before it changes velocities, and scales cached impulses by the ratio
of two steps: a short step before a long one would throw the block. Where steps differ, a preset
therefore keeps the library's step as it is, gives each step its own gravity, and moves the
positions itself, by the library's own function, from the library's own velocities.
"""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np

from engines.parts import FLOOR_HEIGHTS, imported
from engines.parts.script import Script, defined, filled, moved, settings_of
from engines.pymunk.settings import LEVEL, PymunkSettings
from engines.scene import BASE, Ability, Body, Scene
from engines.settings import disagreement
from engines.world import ContactPhase, FloatArray, Moment, Pose, Step

UNIT_S = 1e-3
"""Step [s] that the library is told where the positions are not its own to move."""

MOST_REFLECTION = 2.0
"""A step that is much longer than the one before gives back no more than this part."""

LIBRARY_STEP_S = 0.02


def numbers(scene: Scene, unit: float, deeper: float = 0.0) -> SimpleNamespace:
    """Return the numbers of a scene in a unit of length, its floors so much deeper in bodies."""
    far, bodies = FLOOR_HEIGHTS * scene.bodies[0].height * unit, scene.bodies
    deep = [(-far, -far), (far, -far), (far, -deeper), (-far, -deeper)]
    contacts = [
        SimpleNamespace(
            **{"x": 0.5 * bodies[contact.body].width * unit, "body": contact.body},
            **{"z": 0.5 * contact.face * bodies[contact.body].height * unit, "on": contact.on},
            under=deep if contact.on == BASE else boxed(bodies[contact.on], unit, deeper),
        )
        for contact in scene.layout.contacts
    ]
    return SimpleNamespace(
        **{"far": far, "bodies": [of_body(body, unit) for body in bodies], "contacts": contacts},
    )


def of_body(body: Body, unit: float) -> SimpleNamespace:
    """Return the numbers of a body."""
    at = body.at
    return SimpleNamespace(
        **{"mass": body.mass, "inertia": body.inertia[1] * unit**2, "box": boxed(body, unit)},
        **{"place": (at.x * unit, at.z * unit), "angle": -at.theta, "at_rest": at.at_rest},
        **{"velocity": (at.velocity_x * unit, at.velocity_z * unit), "rate": -at.rate},
    )


def boxed(body: Body, unit: float, deeper: float = 0.0) -> list[tuple[float, float]]:
    """Return the corners of a body, about its centre, the lower face so much deeper in it."""
    x, z = 0.5 * body.width * unit, 0.5 * body.height * unit
    return [(-x, deeper - z), (x, deeper - z), (x, z), (-x, z)]


def values(scene: Scene, s: PymunkSettings, dt_s: float) -> SimpleNamespace:
    """Return settings as the library is given them, for ordinary steps dt_s [s]."""
    margin = s.margin_of(scene, dt_s)
    together = s.positions and Ability.STACKED in scene.layout.asks
    return SimpleNamespace(
        **{"geometry": s.geometry, "friction": float(s.friction), "bias": s.bias, "level": -LEVEL},
        **{"iterations": s.iterations_of(scene), "slop": s.slop_of(scene, dt_s)},
        **{"margin": margin, "together": together, "widest": 2.0 * margin if together else margin},
        pivots=[c.face * side for c in scene.layout.contacts for side in (1.0, -1.0)],
    )


def build(pymunk: Any, n: Any, s: Any) -> Any:
    """Build bodies on one that does not move by itself; see `engines.parts.script`."""
    space = pymunk.Space()
    if s.iterations is not None:
        space.iterations = s.iterations
    if s.slop is not None:
        space.collision_slop = s.slop
    if s.bias is not None:
        space.collision_bias = s.bias
    base = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    bodies, corners, floors = [], [], []
    for b in n.bodies:
        block = pymunk.Body(b.mass, b.inertia)
        block.position, block.angle = b.place, b.angle
        if not b.at_rest:
            block.velocity, block.angular_velocity = b.velocity, b.rate
        bodies.append(block)
        if s.geometry == "box":
            corners.append(pymunk.Poly(block, b.box))
    if s.geometry == "box":
        floors = [pymunk.Segment(base, (-n.far, 0.0), (n.far, 0.0), 0.0)]
    else:
        for c in n.contacts:
            corners += [pymunk.Circle(bodies[c.body], 0.0, (x, c.z)) for x in (-c.x, c.x)]
            # the radius that a floor is made with bounds the ones that it is given later
            under = [base, *bodies][c.on + 1]
            floors += [pymunk.Poly(under, c.under, radius=s.widest) for _ in (1, 2)]
        for number, pair in enumerate(zip(corners, floors, strict=True)):
            for shape in pair:  # a corner meets its own floor alone
                shape.filter = pymunk.ShapeFilter(categories=1 << number, mask=1 << number)
    for shape in (*corners, *floors):
        shape.friction = math.sqrt(s.friction)  # the product counts
    space.add(base, *bodies, *corners, *floors)
    return space, base, bodies, corners, floors


def hold(floors: Any, about: float, s: Any) -> None:
    """Keep the corner in contact about which the block turns, both where it turns about neither."""
    for side, floor in zip(s.pivots, floors, strict=True):
        floor.unsafe_set_radius(s.margin if side * about >= s.level else 0.0)


TOGETHER = {ContactPhase.APPROACH: 0.0, ContactPhase.STRIKE: 2.0}
"""By how many margins the floors of free corners reach out where those must meet together."""


def hold_together(floors: Any, about: float, phase: ContactPhase, s: Any) -> None:
    """Hold as `hold` does floors that lie a margin deeper, and free corners alike in an impact."""
    free = TOGETHER.get(phase, 1.0)
    for side, floor in zip(s.pivots, floors, strict=True):
        floor.unsafe_set_radius(s.margin * (2.0 if side * about >= s.level else free))


FLOORS = {
    "velocity": ("base.velocity = ({x} - base.position.x) / DT, 0.0",),
    "both": ("base.position_func = lambda body, dt: None", "base.velocity = {v}, 0.0"),
}
"""How a script moves a base that carries, to a place x with velocity v in units of length."""


def script(scene: Scene, settings: PymunkSettings, dt_s: float) -> Script:
    """Return a scene as calls of pymunk; see `engines.parts.script`."""
    s, moves = values(scene, settings, dt_s), scene.frame == "world"
    lines, unit = filled(build, n=numbers(scene, settings.unit), s=s), settings.unit
    held, times = defined(hold, s=s) if s.margin else (), "" if unit == 1.0 else f" * {unit!r}"
    # a base that the library moves is a step ahead
    ahead = " + DT * base.velocity.x" * (settings.floor == "velocity")
    under = f" - base.position.x{ahead}" * moves
    return Script(
        imports=("import pymunk",),
        settings=(f"space.step({dt_s!r})", *settings_of(lines)),
        build=tuple(line.text for line in (*lines, *held)),
        step=(
            *("hold(floors, -bodies[0].angle)",) * bool(held),
            *moved(scene, settings.floor, unit, FLOORS),
            *(f"space.gravity = pull_x{times}, pull_z{times}", "space.step(DT)"),
            *(f"base.position = base_x{times}, 0.0",) * (moves and settings.floor == "both"),
        ),
        pose=("theta, rate = -bodies[number].angle, -bodies[number].angular_velocity",),
        place=f"(bodies[0].position.x{under}) / {unit!r}",
        moment=Moment.MIDDLE if settings.positions else Moment.NEXT,
    )


class PymunkWorld:
    """Bodies on one that does not move by itself."""

    def __init__(self, scene: Scene, settings: PymunkSettings, dt_s: float) -> None:
        self.settings = settings
        self._pm: Any = imported("pymunk")
        self._floor = settings.floor if scene.frame == "world" else ""
        self._dt = self._under = self.lag_m = 0.0
        self._values = values(scene, settings, dt_s)
        self._unit = settings.unit
        n = numbers(scene, self._unit, self._values.margin if self._values.together else 0.0)
        built = build(self._pm, n, self._values)
        self._space, self._base, self._bodies, self._corners, self._floors = built
        self._at = [(x, c.z) for c in n.contacts for x in (-c.x, c.x)]
        self._state = np.zeros((len(self._bodies), len(Pose._fields)))
        if self._floor != "velocity":
            self._base.position_func = _stay
        for body in self._bodies if settings.positions else ():
            body.position_func = _stay
        self._fault = self._read_back(scene)

    @property
    def moment(self) -> Moment:
        """At which moment of a step the velocity of a pose holds."""
        return Moment.MIDDLE if self.settings.positions else Moment.NEXT

    def step(self, step: Step) -> None:
        """Advance by a step."""
        own, unit = self.settings.positions, self._unit
        dt = UNIT_S if own else step.dt_s
        pull = unit * step.dt_s / dt
        self._space.gravity = (step.pull_x * pull, step.pull_z * pull)
        if self.settings.geometry == "corners":
            self._hold(step)
        if self._floor == "velocity":
            self._under = self._base.position.x
            self._base.velocity = ((step.base_x * unit - self._under) / step.dt_s, 0.0)
        elif self._floor == "both":
            self._base.velocity = (step.base_velocity * unit, 0.0)
        self._space.step(dt)
        if self._floor == "velocity":
            self.lag_m = max(self.lag_m, abs(self._base.position.x / unit - step.base_x))
        elif self._floor:
            self._under = step.base_x * unit
            self._base.position = (self._under, 0.0)
        for body in self._bodies if own else ():
            self._pm.Body.update_position(body, step.dt_s)

    def state(self) -> FloatArray:
        """Read the bodies' poses back.

        A base that the library moves is a step ahead: it carries the bodies in the next one.
        """
        unit = self._unit
        for number, body in enumerate(self._bodies):
            x, z = body.position
            self._state[number] = (
                (x - self._under) / unit,
                z / unit,
                -body.angle,
                -body.angular_velocity,
            )
        return self._state

    def fault(self) -> str:
        """Say which setting was not taken."""
        return self._fault

    def close(self) -> None:
        """Release the engine's memory."""
        self._space.remove(*self._space.shapes, *self._space.bodies)

    def _hold(self, step: Step) -> None:
        """Keep the pivot in contact, and give its velocity back while the block turns about it."""
        back, before, self._dt = 0.0, self._dt, step.dt_s
        turning = step.phase in (ContactPhase.SWING, ContactPhase.APPROACH)
        if self.settings.reflection and before and turning:
            back = min(step.dt_s / before, MOST_REFLECTION)
        bounce = self.settings.restitution * self.settings.base_restitution
        # equal steps do not say about which corner
        about = 0.0 if step.phase is ContactPhase.REST else step.side or -self._bodies[0].angle
        if self._values.together:
            hold_together(self._floors, about, step.phase, self._values)
        else:
            hold(self._floors, about, self._values)
        pairs = zip(self._values.pivots, self._at, self._corners, self._floors, strict=True)
        for side, at, corner, floor in pairs:
            returned = back if side * about >= -LEVEL and step.side else 0.0
            corner.elasticity, floor.elasticity = 1.0, max(returned, bounce)
            slip = 0.0
            if returned:
                under = floor.body.velocity[0]
                slip = corner.body.velocity_at_local_point(at)[0] - under
            corner.surface_velocity = (returned * slip, 0.0)

    def _read_back(self, scene: Scene) -> str:
        s, space, masses = self.settings, self._space, {}
        for number, (wanted, found) in enumerate(zip(scene.bodies, self._bodies, strict=True)):
            masses[f"mass {number}"] = (wanted.mass, found.mass)
            masses[f"moment {number}"] = (wanted.inertia[1] * self._unit**2, found.moment)
        return disagreement(
            {
                **masses,
                "friction": (s.friction, self._corners[0].friction * self._floors[0].friction),
                "iterations": (self._values.iterations, space.iterations),
                "slop": (None if s.margin else s.slop, space.collision_slop),
                "bias": (s.bias, space.collision_bias),
            }
        )


def _stay(body: Any, dt: float) -> None:
    """Leave a body where it is: the adapter moves it."""
