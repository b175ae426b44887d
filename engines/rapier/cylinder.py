"""Rapier: a cylinder in space, the library's own shape, whose axis is y."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np

from engines.parts.quiet import imported
from engines.parts.units import counted
from engines.rapier.build import ALOFT, values
from engines.rapier.build import build as build_base
from engines.rapier.settings import RapierSettings
from engines.space import turn_vector

FAR = 20.0
"""How many heights below the plane the box is that blocks stand on."""


class RapierCylinder:
    """A body with one collider, on a half-space.

    On the box of the blocks its deepest point is found by iteration, up to millimetres off: that
    costs ten times as much as all else.
    """

    def __init__(self, scene: Any, settings: RapierSettings, dt_s: float) -> None:
        rapier, it, s = imported("rapier3d"), scene.cylinder, values(scene, settings, dt_s)
        self._unit, self._sunk = settings.unit_of(scene), settings.sunk_of(scene)
        unit, half = self._unit, counted(settings.base_half_size(scene), self._unit)
        away = {"base_half": half, "below": (0.0, 0.0, -FAR * it.height * unit - half[2])}
        made = build_base(rapier, SimpleNamespace(**away, lowered=(0.0, 0.0, 0.0), bodies=[]), s)
        self._world, parameters, _, _ = made
        parameters.dt = dt_s
        plane = rapier.Collider.halfspace((0.0, 0.0, 1.0)).friction(s.friction)
        plane = plane.restitution(s.base_restitution)
        ground = rapier.RigidBody.fixed().translation((0.0, 0.0, -self._sunk))
        self._world.add_body(ground, [plane])
        self._world.gravity = 0.0, 0.0, -scene.gravity * unit
        x, y, z = counted(it.place, unit)
        body = rapier.RigidBody.dynamic().translation((x, y, z - self._sunk))
        body = body.rotation(tuple(turn_vector(it.turn))).angvel(it.spin)
        body = body.linvel(counted(it.velocity, unit))
        if s.sleeping is not None:
            body = body.can_sleep(s.sleeping)
        shape = rapier.Collider.cylinder(0.5 * it.height * unit, it.radius * unit)
        shape = shape.rotation((0.5 * math.pi, 0.0, 0.0)).density(it.density / unit**3)
        shape = shape.friction(s.friction).restitution(s.restitution)
        self._body = self._world.rigid_bodies[self._world.add_body(body, [shape])]
        self._body.recompute_mass_properties_from_colliders(self._world.colliders)

    def step(self) -> None:
        """Advance by a step."""
        self._world.step()

    def state(self) -> Any:
        """Read the state back."""
        body, unit = self._body, self._unit
        at, turn, speed, spin = body.translation, body.rotation, body.linvel, body.angvel
        place = np.array((at.x, at.y, at.z + self._sunk)) / unit
        velocity = np.array((speed.x, speed.y, speed.z)) / unit
        return place, (turn.w, turn.i, turn.j, turn.k), velocity, (spin.x, spin.y, spin.z)

    def fault(self) -> str:
        """Say that the cylinder sleeps while it stands on its rim."""
        turn = self._body.rotation
        if self._body.is_sleeping and 2.0 * math.hypot(turn.i, turn.j) > ALOFT:
            return "the library put the cylinder to sleep aloft"
        return ""

    def close(self) -> None:
        """Release the engine's memory."""
        self._world.clear()
