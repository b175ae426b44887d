"""PhysX: a cylinder in space, SAPIEN's own shape, whose axis is x: a prism of 32 sides."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np

from engines.parts.quiet import imported
from engines.parts.shapes import floor_half_size
from engines.parts.units import counted
from engines.physx.build import BASE_DEPTH, values
from engines.physx.build import build as build_base
from engines.physx.settings import PhysxSettings

AXIS_UP = (math.sqrt(0.5), 0.0, -math.sqrt(0.5), 0.0)
"""The turn from the shape's axis to the cylinder's."""


class PhysxCylinder:
    """A body with one shape, on a kinematic box.

    SAPIEN has no true cylinder, but a convex mesh (CreateCylinder in its src/physx/mesh.cpp): it
    rolls from corner to corner, and each takes energy.
    """

    def __init__(self, scene: Any, settings: PhysxSettings, dt_s: float) -> None:
        sapien, it, s = imported("sapien"), scene.cylinder, values(scene, settings, dt_s)
        self._unit, self._sunk = settings.unit_of(scene), settings.sunk_of(scene)
        unit, (x, y, z) = self._unit, floor_half_size(scene)
        half = counted((x, y, BASE_DEPTH * z), unit)
        base = {"base_half": half, "below": (0.0, 0.0, -half[2])}
        lowered, pull = (0.0, 0.0, -self._sunk), (0.0, 0.0, -scene.gravity * unit)
        made = SimpleNamespace(**base, lowered=lowered, gravity=pull, bodies=[])
        self._stage, self._system, _, _ = build_base(sapien, made, s)
        self._system.timestep = dt_s
        physx = sapien.physx
        material = physx.PhysxMaterial(s.friction, s.friction, s.restitution)
        sizes = it.radius * unit, 0.5 * it.height * unit
        shape = physx.PhysxCollisionShapeCylinder(*sizes, material)
        shape.local_pose = sapien.Pose((0.0, 0.0, 0.0), AXIS_UP)
        self._body = body = physx.PhysxRigidDynamicComponent()
        body.attach(shape)
        body.mass = it.mass
        body.inertia = counted(it.inertia, unit**2)
        body.cmass_local_pose = sapien.Pose()
        if s.damping is not None:
            body.angular_damping = s.damping
        if s.depenetration is not None:
            body.max_depenetration_velocity = s.depenetration
        entity = sapien.Entity()
        entity.add_component(body)
        x, y, z = counted(it.place, unit)
        entity.pose = sapien.Pose((x, y, z - self._sunk), it.turn)
        self._stage.add_entity(entity)
        body.linear_velocity = counted(it.velocity, unit)
        body.angular_velocity = it.spin

    def step(self) -> None:
        """Advance by a step."""
        self._system.step()

    def state(self) -> Any:
        """Read the state back."""
        pose, unit = self._body.entity_pose, self._unit
        x, y, z = pose.p.tolist()
        place = np.array((x, y, z + self._sunk)) / unit
        velocity = np.asarray(self._body.linear_velocity, dtype=float) / unit
        return place, pose.q, velocity, self._body.angular_velocity

    def fault(self) -> str:
        """Say nothing: the library reports no fault."""
        return ""

    def close(self) -> None:
        """Release the engine's memory."""
        self._stage.clear()
