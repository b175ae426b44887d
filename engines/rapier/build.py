"""Rapier: how a scene is built, set, stepped and read back.

The library computes in single precision: where a block stands is known to 6e-8 of its size, so that
a step of less than some 1e-6/p has the noise of its contact for a velocity. A tuned preset counts
lengths in heights of the block, from where its centre rests; in metres blocks of one shape err by
their size, those of 30 m by tenths of the peak.
"""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np

from engines.declaration import Precision
from engines.parts import counted, half_size, imported, touching_spheres
from engines.parts.reflection import returned
from engines.parts.script import Script, filled, moved, settings_of
from engines.rapier.settings import RapierSettings
from engines.scene import Scene
from engines.settings import disagreement
from engines.world import FloatArray, Moment, Pose, Step

ALOFT = 1e-2
"""A block that sleeps while it leans by more than this part of alpha is on one corner.

What sleeps on both leans by what the contact yields: up to 4e-5 of alpha.
"""


def numbers(scene: Scene, s: RapierSettings) -> SimpleNamespace:
    """Return the numbers of a scene in the settings' unit of length."""
    unit, sunk = s.unit_of(scene), s.sunk_of(scene)
    radius = s.corner_radius * scene.bodies[0].height
    x, y, z = counted(s.base_half_size(scene), unit)
    return SimpleNamespace(
        **{"unit": unit, "radius": radius * unit},
        **{"base_half": (x, y, z), "below": (0.0, 0.0, -z), "lowered": (0.0, 0.0, -sunk)},
        bodies=[of_body(scene, number, s, radius) for number in range(len(scene.bodies))],
    )


def of_body(scene: Scene, number: int, s: RapierSettings, radius: float) -> SimpleNamespace:
    """Return the numbers of a body, with balls of a radius [m] at the corners that touch others."""
    body, unit, sunk = scene.bodies[number], s.unit_of(scene), s.sunk_of(scene)
    at = body.at
    spheres = touching_spheres(scene, number, radius, planar=s.planar)
    corners = [counted(corner, unit) for corner in spheres]
    return SimpleNamespace(
        **{"half": counted(half_size(body), unit), "corners": corners},
        **{"mass": body.mass, "density": body.density / unit**3},
        inertia=tuple(moment * unit**2 for moment in body.inertia),
        **{"place": (at.x * unit, 0.0, at.z * unit - sunk), "at_rest": at.at_rest},
        **{"turn": (0.0, at.theta, 0.0), "spin": (0.0, at.rate, 0.0)},
        velocity=(at.velocity_x * unit, 0.0, at.velocity_z * unit),
        carried=scene.layout.rests(number),
    )


def values(scene: Scene, s: RapierSettings, dt_s: float) -> SimpleNamespace:
    """Return settings as the library is given them, for ordinary steps dt_s [s].

    Parameters
    ----------
    scene : Scene
    s : RapierSettings
    dt_s : float, ordinary step [s], from which a contact's spring follows

    Returns
    -------
    SimpleNamespace
        What `build` takes as s: spring is a contact's frequency [Hz] and damping ratio, target
        whether the base is led by its place, the others are as in the settings. None leaves a
        number to the library.
    """
    base = s.restitution if s.base_restitution is None else s.base_restitution
    target = scene.frame == "world" and s.floor == "target"
    return SimpleNamespace(
        **{"geometry": s.geometry, "planar": s.planar, "aside": not s.locked_aside},
        **{"friction": float(s.friction), "restitution": s.restitution, "base_restitution": base},
        **{"substeps": s.substeps, "iterations": s.iterations_of(scene)},
        **{"stabilization": s.stabilization, "recycling": s.recycling, "coulomb": s.coulomb},
        **{"warm_starting": s.warm_starting, "bias_friction": s.friction_in_bias_pass},
        **{"sleeping": s.sleeping, "target": target},
        spring=s.spring_of(dt_s),
    )


def build(rapier: Any, n: Any, s: Any) -> Any:
    """Build bodies on a kinematic box.

    Parameters
    ----------
    rapier : module, rapier3d
    n : SimpleNamespace, from `numbers`
    s : SimpleNamespace, from `values`

    Returns
    -------
    world : PhysicsWorld
    parameters : IntegrationParameters, of which dt [s] is the step
    base : RigidBody
    bodies : list of RigidBody, one for each of n.bodies
    """
    world = rapier.PhysicsWorld()
    parameters = world.integration_parameters
    if s.substeps is not None:
        parameters.num_solver_iterations = s.substeps
    if s.iterations is not None:
        parameters.num_internal_pgs_iterations = s.iterations
    if s.stabilization is not None:
        parameters.num_internal_stabilization_iterations = s.stabilization
    if s.recycling is not None:
        parameters.contact_recycling = s.recycling
    if s.warm_starting is not None:
        parameters.warmstart_coefficient = s.warm_starting
    if s.coulomb is not None:
        parameters.friction_model = rapier.FrictionModel.COULOMB
    if s.bias_friction is not None:
        parameters.friction_in_bias_pass = s.bias_friction
    if s.spring is not None:
        spring = rapier.SpringCoefficients(*s.spring)
        parameters.contact_softness = parameters.static_contact_softness = spring
    floor = rapier.Collider.cuboid(*n.base_half).translation(n.below)
    floor = floor.friction(s.friction).restitution(s.base_restitution)
    if s.target:
        base = rapier.RigidBody.kinematic_position_based().translation(n.lowered)
    else:
        base = rapier.RigidBody.kinematic_velocity_based().translation(n.lowered)
    base = world.rigid_bodies[world.add_body(base, [floor])]
    bodies = []
    for b in n.bodies:
        body = rapier.RigidBody.dynamic().translation(b.place)
        if not b.at_rest:
            body = body.rotation(b.turn).linvel(b.velocity).angvel(b.spin)
        if s.planar:
            body = body.enabled_rotations((False, True, False))
            body = body.enabled_translations((True, s.aside, True))
        if s.sleeping is not None:
            body = body.can_sleep(s.sleeping)
        if s.geometry == "box":
            shapes = [rapier.Collider.cuboid(*b.half).density(b.density)]
        else:
            mass = rapier.MassProperties((0.0, 0.0, 0.0), b.mass, b.inertia)
            body = body.additional_mass_properties(mass)
            ball = rapier.Collider.ball(n.radius).density(0.0)
            shapes = [ball.translation(at) for at in b.corners]
            if b.carried:
                shapes.append(rapier.Collider.cuboid(*b.half).density(0.0))
        # the mean of two counts
        shapes = [shape.friction(s.friction).restitution(s.restitution) for shape in shapes]
        block = world.rigid_bodies[world.add_body(body, shapes)]
        block.recompute_mass_properties_from_colliders(world.colliders)  # else with its first step
        bodies.append(block)
    return world, parameters, base, bodies


FLOORS = {
    "target": ("base.set_next_kinematic_translation(({x}, 0.0, base.translation.z))",),
    "velocity": ("base.linvel = ({x} - base.translation.x) / DT, 0.0, 0.0",),
    "both": (
        "base.translation = {x} - DT * {v}, 0.0, base.translation.z",
        "base.linvel = {v}, 0.0, 0.0",
    ),
}
"""How a script moves a base that carries, to a place x with velocity v in units of length."""


def script(scene: Scene, settings: RapierSettings, dt_s: float) -> Script:
    """Return a scene as calls of Rapier; see `engines.parts.script`."""
    n, s = numbers(scene, settings), values(scene, settings, dt_s)
    lines, times = filled(build, n=n, s=s), "" if n.unit == 1.0 else f" * {n.unit!r}"
    led = f"base_x{times}" if settings.floor == "both" else "base.translation.x"
    under = f" - {led}" * (scene.frame == "world")
    return Script(
        imports=("import rapier3d as rapier",),
        settings=(f"parameters.dt = {dt_s!r}", *settings_of(lines)),
        build=(*(line.text for line in lines), "parameters.dt = DT"),
        step=(
            f"world.gravity = pull_x{times}, 0.0, pull_z{times}",
            *moved(scene, settings.floor, n.unit, FLOORS),
            "world.step()",
        ),
        pose=(
            "turn = bodies[number].rotation",
            "theta, rate = 2.0 * math.atan2(turn.j, turn.w), bodies[number].angvel.y",
        ),
        place=f"(bodies[0].translation.x{under}) / {n.unit!r}",
    )


class RapierWorld:
    """Bodies on a kinematic box, whether that moves or not."""

    moment = Moment.MIDDLE

    def __init__(self, scene: Scene, settings: RapierSettings, dt_s: float) -> None:
        self._s, self._alpha = settings, scene.system.alpha
        self._way = settings.floor if scene.frame == "world" else ""
        self._led = self._way in ("target", "velocity")
        self._driven = bool(self._way) or settings.reflection
        self._dt = self._speed = self._place = self.lag_m = 0.0
        n, s = numbers(scene, settings), values(scene, settings, dt_s)
        self._unit, self._sunk, self._half = n.unit, settings.sunk_of(scene), n.bodies[0].half
        built = build(imported("rapier3d"), n, s)
        self._world, self._parameters, self._base, self._bodies = built
        self._body, self._state = self._bodies[0], np.zeros((len(self._bodies), len(Pose._fields)))
        self._fault = self._read_back(scene)

    def step(self, step: Step) -> None:
        """Advance by a step; see `engines.world.SteppedWorld`."""
        if step.dt_s != self._dt:
            self._parameters.dt = step.dt_s
        self._world.gravity = (step.pull_x * self._unit, 0.0, step.pull_z * self._unit)
        if self._led:
            self._lead(step)
        elif self._driven:
            self._drive(step)
        self._world.step()
        self._dt = step.dt_s
        if self._way:
            self._place = step.base_x * self._unit
        if self._led:
            self._place = self._base.translation.x
            self.lag_m = max(self.lag_m, abs(self._place / self._unit - step.base_x))

    def state(self) -> FloatArray:
        """Read the bodies' poses back."""
        for number, body in enumerate(self._bodies):
            at, turn = body.translation, body.rotation
            theta = 2.0 * math.atan2(turn.j, turn.w)
            x, z = (at.x - self._place) / self._unit, (at.z + self._sunk) / self._unit
            self._state[number] = x, z, theta, body.angvel.y
        return self._state

    def fault(self) -> str:
        """Say which setting was not taken, or that the block sleeps where none can rest."""
        if self._body.is_sleeping and abs(self.state()[0, 2]) > ALOFT * self._alpha:
            return "the library put the block to sleep aloft"
        step = {"dt": (self._dt or None, self._parameters.dt)}
        return self._fault or disagreement(step, Precision.SINGLE.value)

    def close(self) -> None:
        """Release the engine's memory."""
        self._world.clear()

    def _lead(self, step: Step) -> None:
        """Let the library lead the base to its place."""
        x = step.base_x * self._unit
        if self._way == "target":
            self._base.set_next_kinematic_translation((x, 0.0, -self._sunk))
        else:
            self._base.linvel = ((x - self._place) / step.dt_s, 0.0, 0.0)

    def _drive(self, step: Step) -> None:
        """Set the base's place and velocity, by which the pivot is given its own back, too."""
        back = returned(step, self._dt) if self._s.reflection else 0.0
        speed = step.base_velocity * self._unit if self._way == "both" else 0.0
        slip = 0.0
        if back:
            corner = (step.side * self._half[0], 0.0, -self._half[2])
            at = self._body.position.transform_point(corner)
            slip = self._body.velocity_at_point(at).x - self._speed
        self._base.translation = (self._place, 0.0, -self._sunk)
        self._base.linvel = (speed - back * slip, 0.0, 0.0)
        self._speed = speed

    def _read_back(self, scene: Scene) -> str:
        colliders = [self._world.colliders[it.colliders[0]] for it in (self._base, self._body)]
        friction = 0.5 * sum(collider.friction for collider in colliders)
        pairs = {
            **{
                f"mass {number}": (wanted.mass, found.mass)
                for number, (wanted, found) in enumerate(
                    zip(scene.bodies, self._bodies, strict=True)
                )
            },
            "friction": (self._s.friction, friction),
            "restitution": (self._s.restitution, colliders[1].restitution),
            "iterations": (
                self._s.iterations_of(scene),
                self._parameters.num_internal_pgs_iterations,
            ),
            "substeps": (self._s.substeps, self._parameters.num_solver_iterations),
        }
        return disagreement(pairs, Precision.SINGLE.value)
