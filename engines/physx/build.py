"""PhysX: how a scene is built, set, stepped and read back, by SAPIEN and on the CPU.

The library computes in single precision. Its solver TGS moves a body in every iteration, in the
world: of v dt/iterations nothing is left below half of what its place is told apart by, so that a
body slower than (ulp/2) iterations/dt stands still, the more so the shorter the step and the
farther from the origin it is.
"""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np

from engines.declaration import Precision
from engines.parts import counted, floor_half_size, half_size, imported, touching_spheres
from engines.parts.reflection import returned
from engines.parts.script import Script, filled, moved, settings_of
from engines.physx.settings import PhysxSettings
from engines.scene import Scene
from engines.settings import disagreement, given
from engines.world import FloatArray, Moment, Pose, Step

CORNER, BASE_DEPTH = 1e-3, 1e-2
"""Radius of corner balls and half the depth of the base over the height of the block: contacts are
looked for from the middle of the base, the deeper that is, the more coarsely."""

NOTHING = 1e-9
"""A pull within this part of the weight is the weight: the rounding of a difference wakes a block.
"""


def numbers(scene: Scene, s: PhysxSettings) -> SimpleNamespace:
    """Return the numbers of a scene in the settings' unit of length.

    Parameters
    ----------
    scene : Scene
    s : PhysxSettings

    Returns
    -------
    SimpleNamespace
        What `build` takes as n, lengths in units:

        - radius: of corner balls; gravity (3,) [units/s2];
        - base_half, below, lowered (3,): half the base's size, its centre in its frame, and its
          place;
        - of each of bodies: half (3,) its size, density [kg/units3], mass [kg], inertia (3,)
          [kg units2], corners: each at (3,) about its centre, place (3,), turn (4,): a quaternion,
          its real part first, velocity (3,) [units/s], spin (3,) [rad/s].
    """
    unit, sunk = s.unit_of(scene), s.sunk_of(scene)
    radius = CORNER * scene.bodies[0].height
    x, y, z = floor_half_size(scene)
    half = counted((x, y, BASE_DEPTH * z), unit)
    return SimpleNamespace(
        **{"radius": radius * unit, "base_half": half, "below": (0.0, 0.0, -half[2])},
        **{"lowered": (0.0, 0.0, -sunk), "gravity": (0.0, 0.0, -scene.system.gravity * unit)},
        bodies=[of_body(scene, number, s, radius) for number in range(len(scene.bodies))],
    )


def of_body(scene: Scene, number: int, s: PhysxSettings, radius: float) -> SimpleNamespace:
    """Return the numbers of a body, with balls of a radius [m] at the corners that touch others."""
    body, unit, at = scene.bodies[number], s.unit_of(scene), scene.bodies[number].at
    spheres = touching_spheres(scene, number, radius, planar=s.planar)
    turn = (math.cos(0.5 * at.theta), 0.0, math.sin(0.5 * at.theta), 0.0)
    return SimpleNamespace(
        **{"half": counted(half_size(body), unit), "density": body.density / unit**3},
        **{"mass": body.mass, "inertia": tuple(moment * unit**2 for moment in body.inertia)},
        corners=[SimpleNamespace(at=counted(corner, unit)) for corner in spheres],
        **{"place": (at.x * unit, 0.0, at.z * unit - s.sunk_of(scene)), "turn": turn},
        **{"velocity": (at.velocity_x * unit, 0.0, at.velocity_z * unit), "at_rest": at.at_rest},
        **{"spin": (0.0, at.rate, 0.0), "carried": scene.layout.rests(number)},
    )


def values(scene: Scene, s: PhysxSettings, dt_s: float) -> SimpleNamespace:
    """Return settings as the library is given them, for ordinary steps dt_s [s].

    Parameters
    ----------
    scene : Scene
    s : PhysxSettings
    dt_s : float, ordinary step [s]

    Returns
    -------
    SimpleNamespace
        What `build` takes as s; None leaves a number to the library:

        - dt [s], damping [1/s], depenetration [units/s];
        - scene, shape, solver: arguments of set_scene_config, set_shape_config, set_body_config,
          lengths in units.
    """
    unit = s.unit_of(scene)
    bounce = None if s.bounce_threshold is None else s.bounce_threshold * unit
    fastest = None if s.depenetration is None else s.depenetration * unit
    return SimpleNamespace(
        **{"geometry": s.geometry, "planar": s.planar},
        **{"friction": float(s.friction), "restitution": s.restitution},
        **{"dt": dt_s, "damping": s.angular_damping, "depenetration": fastest},
        scene=given({"bounce_threshold": bounce, "enable_tgs": s.tgs}),
        shape=given({"contact_offset": s.contact_offset}),
        solver=given(
            {
                "solver_position_iterations": s.iterations,
                "solver_velocity_iterations": s.velocity_iterations,
                "sleep_threshold": None if s.sleeping in (None, True) else 0.0,
            }
        ),
    )


def build(sapien: Any, n: Any, s: Any) -> Any:
    """Build bodies on a kinematic box.

    Parameters
    ----------
    sapien : module
    n : SimpleNamespace, from `numbers`
    s : SimpleNamespace, from `values`

    Returns
    -------
    stage : Scene
    system : PhysxCpuSystem
    base : PhysxRigidDynamicComponent
    bodies : list of PhysxRigidDynamicComponent, one for each of n.bodies
    """
    physx = sapien.physx
    physx.set_scene_config(gravity=n.gravity, **s.scene)
    physx.set_body_config(**s.solver)
    physx.set_shape_config(**s.shape)
    system = physx.PhysxCpuSystem()
    stage = sapien.Scene([system])
    material = physx.PhysxMaterial(s.friction, s.friction, s.restitution)
    floor = physx.PhysxCollisionShapeBox(n.base_half, material)
    floor.local_pose = sapien.Pose(n.below)
    base = physx.PhysxRigidDynamicComponent()
    base.attach(floor)
    base.kinematic = True
    entity = sapien.Entity()
    entity.add_component(base)
    entity.pose = sapien.Pose(n.lowered)
    stage.add_entity(entity)
    bodies = []
    for b in n.bodies:
        body = physx.PhysxRigidDynamicComponent()
        if s.geometry == "box":
            box = physx.PhysxCollisionShapeBox(b.half, material)
            box.density = b.density
            body.attach(box)
        else:
            for corner in b.corners:
                ball = physx.PhysxCollisionShapeSphere(n.radius, material)
                ball.local_pose = sapien.Pose(corner.at)
                body.attach(ball)
            if b.carried:
                body.attach(physx.PhysxCollisionShapeBox(b.half, material))
            body.mass = b.mass
            body.inertia = b.inertia
            body.cmass_local_pose = sapien.Pose()
        if s.damping is not None:
            body.angular_damping = s.damping
        if s.depenetration is not None:
            body.max_depenetration_velocity = s.depenetration
        if s.planar:
            body.set_locked_motion_axes([False, True, False, True, False, True])
        entity = sapien.Entity()
        entity.add_component(body)
        entity.pose = sapien.Pose(b.place, b.turn)
        stage.add_entity(entity)
        if not b.at_rest:
            body.linear_velocity = b.velocity
            body.angular_velocity = b.spin
        bodies.append(body)
    return stage, system, base, bodies


FLOORS = {
    "belt": (
        "base.entity.pose = sapien.Pose([-DT * {v}, 0.0, base.entity_pose.p[2]])",
        "base.set_kinematic_target(sapien.Pose([0.0, 0.0, base.entity_pose.p[2]]))",
    ),
    "target": ("base.set_kinematic_target(sapien.Pose([{x}, 0.0, base.entity_pose.p[2]]))",),
    "position": ("base.entity.pose = sapien.Pose([{x}, 0.0, base.entity_pose.p[2]])",),
}
"""How a script moves a base, to a place x with velocity v in units of length."""


def script(scene: Scene, settings: PhysxSettings, dt_s: float) -> Script:
    """Return a scene as calls of SAPIEN; see `engines.parts.script`."""
    n, s = numbers(scene, settings), values(scene, settings, dt_s)
    lines, unit = filled(build, n=n, s=s), settings.unit_of(scene)
    times, weight = "" if unit == 1.0 else f" * {unit!r}", scene.system.gravity
    belt = f"base_x{times}" if settings.floor == "belt" else "float(base.entity_pose.p[0])"
    under = f" - {belt}" * (scene.frame == "world")
    return Script(
        imports=("import sapien",),
        settings=settings_of(lines),
        build=(*(line.text for line in lines), "system.timestep = DT"),
        step=(
            f"pull = pull_x{times}, 0.0, (pull_z + {weight!r}){times}",
            f"if abs(pull_x) + abs(pull_z + {weight!r}) > {NOTHING * weight!r}:",
            "    for body in bodies:",
            "        body.add_force_torque(pull, (0.0, 0.0, 0.0), 'acceleration')",
            *moved(scene, settings.floor, unit, FLOORS),
            "system.step()",
        ),
        pose=(
            "turn = bodies[number].entity_pose.q",
            "theta = 2.0 * math.atan2(turn[2], turn[0])",
            "rate = float(bodies[number].angular_velocity[1])",
        ),
        place=f"(float(bodies[0].entity_pose.p[0]){under}) / {unit!r}",
    )


class PhysxWorld:
    """Bodies on a kinematic box, whether that moves or not."""

    moment = Moment.MIDDLE

    def __init__(self, scene: Scene, settings: PhysxSettings, dt_s: float) -> None:
        self._sapien = imported("sapien")
        n, s = numbers(scene, settings), values(scene, settings, dt_s)
        self._way = settings.floor if scene.frame == "world" else ""
        self._unit, self._sunk = settings.unit_of(scene), settings.sunk_of(scene)
        self._reflects, self._weight = settings.reflection, scene.system.gravity
        self._dt = self._speed = self._place = self.lag_m = 0.0
        self._half = n.bodies[0].half
        self._stage, self._system, self._base, self._bodies = build(self._sapien, n, s)
        self._state = np.zeros((len(self._bodies), len(Pose._fields)))
        self._fault = self._read_back(n, s)

    def step(self, step: Step) -> None:
        """Advance by a step; see `engines.world.SteppedWorld`."""
        if self._way or self._reflects:
            self._lead(step)
        if step.dt_s != self._dt:
            self._system.timestep = self._dt = step.dt_s
        x, z = step.pull_x, step.pull_z + self._weight
        if abs(x) + abs(z) > NOTHING * self._weight:
            pull = (x * self._unit, 0.0, z * self._unit)
            for body in self._bodies:
                body.add_force_torque(pull, (0.0, 0.0, 0.0), "acceleration")
        self._system.step()
        if self._way == "belt":
            self._place = step.base_x * self._unit
        elif self._way:
            self._place = float(self._base.entity_pose.p[0])
            self.lag_m = max(self.lag_m, abs(self._place / self._unit - step.base_x))

    def state(self) -> FloatArray:
        """Read the bodies' poses back."""
        for number, body in enumerate(self._bodies):
            pose = body.entity_pose
            (x, _, z), turn = pose.p.tolist(), pose.q.tolist()
            x, z = (x - self._place) / self._unit, (z + self._sunk) / self._unit
            rate = float(body.angular_velocity[1])
            self._state[number] = x, z, 2.0 * math.atan2(turn[2], turn[0]), rate
        return self._state

    def fault(self) -> str:
        """Say which setting was not taken."""
        step = {"timestep": (self._dt or None, self._system.timestep)}
        return self._fault or disagreement(step, Precision.SINGLE.value)

    def close(self) -> None:
        """Release the engine's memory."""
        self._stage.clear()

    def _lead(self, step: Step) -> None:
        """Let the library lead the base to its place, from where its velocity is as wanted."""
        place = step.base_x * self._unit if self._way else 0.0
        if self._way == "position":
            self._base.entity.pose = self._at(place)
            return
        belt = self._way == "belt"
        if belt or self._reflects:
            back = returned(step, self._dt) if self._reflects else 0.0
            slip = self._slip(step.side) if back else 0.0
            pace = step.base_velocity * self._unit if belt else (place - self._place) / step.dt_s
            place = 0.0 if belt else place
            self._speed = pace - back * slip
            self._base.entity.pose = self._at(place - self._speed * step.dt_s)
        self._base.set_kinematic_target(self._at(place))

    def _at(self, x: float) -> Any:
        return self._sapien.Pose((x, 0.0, -self._sunk))

    def _slip(self, side: float) -> float:
        """Return the velocity [units/s] at which the corner at a side slides on the base."""
        _, _, theta, rate = self.state()[0]
        level = side * self._half[0] * math.sin(theta) + self._half[2] * math.cos(theta)
        return float(self._bodies[0].linear_velocity[0]) - rate * level - self._speed

    def _read_back(self, n: Any, s: Any) -> str:
        config, block = self._system.config, self._bodies[0]
        shape = block.collision_shapes[0]
        material = shape.physical_material
        pairs = {
            name: (wanted, getattr(place, name))
            for place, settings in ((config, s.scene), (block, s.solver), (shape, s.shape))
            for name, wanted in settings.items()
        }
        for number, (wanted, body) in enumerate(zip(n.bodies, self._bodies, strict=True)):
            pairs[f"mass {number}"] = (wanted.mass, body.mass)
            pairs[f"moment {number}"] = (wanted.inertia[1], float(body.inertia[1]))
        pairs |= {
            "static friction": (s.friction, material.static_friction),
            "dynamic friction": (s.friction, material.dynamic_friction),
            "restitution": (s.restitution, material.restitution),
            "angular damping": (s.damping, block.angular_damping),
            "locks": (s.planar, any(block.locked_motion_axes)),
        }
        return disagreement(pairs, Precision.SINGLE.value)
