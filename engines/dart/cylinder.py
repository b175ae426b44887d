"""DART: a cylinder in space, of whose rim its collision detectors know more or less."""

from types import SimpleNamespace
from typing import Any

import numpy as np

from engines.dart.build import build as build_base
from engines.dart.build import touching, values
from engines.dart.settings import DartSettings
from engines.parts.quiet import imported
from engines.parts.shapes import floor_half_size
from engines.parts.units import counted
from engines.space import turn_vector


class DartCylinder:
    """A free body on a box whose joint is driven, and stands still."""

    def __init__(self, scene: Any, settings: DartSettings, dt_s: float) -> None:
        dart, it, s = imported("dartpy"), scene.cylinder, values(settings)
        self._unit = unit = settings.unit
        half = counted(floor_half_size(scene), unit)
        floor = {"floor": [2.0 * x for x in half], "beneath": (0.0, 0.0, -half[2])}
        self._world, *_ = build_base(dart, SimpleNamespace(**floor, bodies=[]), s)
        self._world.setTimeStep(dt_s)
        self._world.setGravity((0.0, 0.0, -scene.gravity * unit))
        skeleton = dart.dynamics.Skeleton("cylinder")
        joint, self._body = skeleton.createFreeJointAndBodyNodePair()
        self._body.setMass(it.mass)
        self._body.setMomentOfInertia(*(unit * unit * moment for moment in it.inertia))
        shape = dart.dynamics.CylinderShape(it.radius * unit, it.height * unit)
        touching(self._body, shape, (0.0, 0.0, 0.0), s.friction)
        joint.setPositions((*turn_vector(it.turn), *counted(it.place, unit)))
        # in which axes its own coordinates have a velocity depends on the release
        joint.setAngularVelocity(it.spin)
        joint.setLinearVelocity(counted(it.velocity, unit))
        self._world.addSkeleton(skeleton)

    def step(self) -> None:
        """Advance by a step."""
        self._world.step(False)

    def state(self) -> Any:
        """Read the state back."""
        at, unit = self._body.getTransform(), self._unit
        place = np.asarray(at.translation()).ravel() / unit
        speed = np.asarray(self._body.getCOMLinearVelocity()).ravel() / unit
        return place, at.quaternion().wxyz(), speed, self._body.getAngularVelocity()

    def fault(self) -> str:
        """Say nothing: the library reports no fault."""
        return ""

    def close(self) -> None:
        """Release the engine's memory."""
        for number in reversed(range(self._world.getNumSkeletons())):
            self._world.removeSkeleton(self._world.getSkeleton(number))
