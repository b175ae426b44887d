"""Rapier: how a scene is built, set, stepped and read back.

The library computes in single precision: where a block stands is known to 6e-8 of its size, so that
a step of less than some 1e-6/p has the noise of its contact for a velocity. A tuned preset counts
lengths in heights of the block, from where its centre rests; in metres blocks of one shape err by
their size, those of 30 m by tenths of the peak.
"""

import math
from typing import Any

from engines.declaration import Precision
from engines.parts.quiet import imported
from engines.parts.readback import disagreement
from engines.parts.reflection import returned
from engines.parts.shapes import corner_spheres, half_size
from engines.parts.units import counted
from engines.rapier.settings import (
    RapierSettings,
    parameters,
)
from engines.scene import Scene
from engines.world import Moment, Pose, Step

FROZEN = 1e-5
"""A block that sleeps while it leans by more than this part of alpha would do so for ever."""


class RapierWorld:
    """A block on a kinematic box, whether that moves or not."""

    moment = Moment.MIDDLE

    def __init__(self, scene: Scene, settings: RapierSettings, dt_s: float) -> None:
        self._s, self._alpha = settings, scene.block.alpha
        self._rapier = imported("rapier3d")
        self._moving = scene.frame == "world"
        self._driven = self._moving or settings.reflection
        self._unit, self._sunk = settings.unit_of(scene), settings.sunk_of(scene)
        self._dt = self._speed = self._place = 0.0
        self._world = self._rapier.PhysicsWorld()
        self._parameters = self._world.integration_parameters
        self._set_parameters(scene, dt_s)
        self._half = counted(half_size(scene), self._unit)
        self._base = self._add_base(scene)
        self._body = self._add_block(scene)
        self._fault = self._read_back(scene)

    def step(self, step: Step) -> None:
        """Advance by a step; see `engines.world.SteppedWorld`."""
        if step.dt_s != self._dt:
            self._parameters.dt = step.dt_s
        self._world.gravity = (step.pull_x * self._unit, 0.0, step.pull_z * self._unit)
        if self._driven:
            self._drive(step)
        self._world.step()
        self._dt = step.dt_s
        if self._moving:
            self._place = step.base_x * self._unit

    def pose(self) -> Pose:
        """Read the block's pose back."""
        at, turn = self._body.translation, self._body.rotation
        theta = 2.0 * math.atan2(turn.j, turn.w)
        x, z = (at.x - self._place) / self._unit, (at.z + self._sunk) / self._unit
        return Pose(x, z, theta, self._body.angvel.y)

    def fault(self) -> str:
        """Say which setting was not taken, or that the block sleeps where none can rest."""
        if self._body.is_sleeping and abs(self.pose().theta) > FROZEN * self._alpha:
            return (
                "the library put the block to sleep aloft, and gravity that changes wakes nothing"
            )
        step = {"dt": (self._dt or None, self._parameters.dt)}
        return self._fault or disagreement(step, Precision.SINGLE.value)

    def close(self) -> None:
        """Release the engine's memory."""
        self._world.clear()

    def _drive(self, step: Step) -> None:
        """Set the base's place and velocity, by which the pivot is given its own back, too."""
        back = returned(step, self._dt) if self._s.reflection else 0.0
        moved = self._moving and self._s.base_velocity
        speed = step.base_velocity * self._unit if moved else 0.0
        slip = 0.0
        if back:
            corner = (step.side * self._half[0], 0.0, -self._half[2])
            at = self._body.position.transform_point(corner)
            slip = self._body.velocity_at_point(at).x - self._speed
        self._base.translation = (self._place, 0.0, -self._sunk)
        self._base.linvel = (speed - back * slip, 0.0, 0.0)
        self._speed = speed

    def _set_parameters(self, scene: Scene, dt_s: float) -> None:
        model, spring = self._rapier.FrictionModel, self._s.spring_of(dt_s)
        for name, value in parameters(self._s, scene).items():
            chosen = getattr(model, value) if isinstance(value, str) else value
            setattr(self._parameters, name, chosen)
        if spring is not None:
            softness = self._rapier.SpringCoefficients(*spring)
            self._parameters.contact_softness = softness
            self._parameters.static_contact_softness = softness

    def _add_base(self, scene: Scene) -> Any:
        rapier, (x, y, z) = self._rapier, counted(self._s.base_half_size(scene), self._unit)
        floor = rapier.Collider.cuboid(x, y, z).translation((0.0, 0.0, -z))
        body = rapier.RigidBody.kinematic_velocity_based().translation((0.0, 0.0, -self._sunk))
        bounce = (
            self._s.restitution if self._s.base_restitution is None else self._s.base_restitution
        )
        return self._add(body, [floor], bounce)

    def _add_block(self, scene: Scene) -> Any:
        rapier, s, start, unit = self._rapier, self._s, scene.beginning, self._unit
        body = (
            rapier.RigidBody.dynamic()
            .translation((start.x * unit, 0.0, start.z * unit - self._sunk))
            .rotation((0.0, start.theta, 0.0))
            .linvel((start.velocity_x * unit, 0.0, start.velocity_z * unit))
            .angvel((0.0, start.rate, 0.0))
        )
        if s.planar:
            body = body.enabled_rotations((False, True, False))
            body = body.enabled_translations((True, not s.locked_aside, True))
        if s.sleeping is not None:
            body = body.can_sleep(s.sleeping)
        if s.geometry == "box":
            box = rapier.Collider.cuboid(*self._half).density(scene.density / unit**3)
            return self._add(body, [box], s.restitution)
        radius = s.corner_radius * scene.block.height
        corners = [
            rapier.Collider.ball(radius * unit).density(0.0).translation(counted(at, unit))
            for at in corner_spheres(scene, radius, planar=s.planar)
        ]
        moments = tuple(moment * unit**2 for moment in scene.inertia)
        inertia = rapier.MassProperties((0.0, 0.0, 0.0), scene.mass, moments)
        return self._add(body.additional_mass_properties(inertia), corners, s.restitution)

    def _add(self, body: Any, colliders: list[Any], restitution: float) -> Any:
        rough = [it.friction(self._s.friction).restitution(restitution) for it in colliders]
        return self._world.rigid_bodies[self._world.add_body(body, rough)]

    def _read_back(self, scene: Scene) -> str:
        # a body takes its mass with its first step, or when it is told to
        self._body.recompute_mass_properties_from_colliders(self._world.colliders)
        colliders = [self._world.colliders[it.colliders[0]] for it in (self._base, self._body)]
        friction = 0.5 * sum(collider.friction for collider in colliders)
        pairs = {
            "mass": (scene.mass, self._body.mass),
            "friction": (self._s.friction, friction),
            "restitution": (self._s.restitution, colliders[1].restitution),
            "iterations": (
                self._s.iterations_of(scene),
                self._parameters.num_internal_pgs_iterations,
            ),
            "substeps": (self._s.substeps, self._parameters.num_solver_iterations),
        }
        return disagreement(pairs, Precision.SINGLE.value)
