"""DART: bodies that rest on others, in steps that land.

Like the base, a beam slides out of the plane, or friction between two bodies in the plane would
have no mass there, and the library would answer by another solver. The free corners reach out in
the steps of an impact, and are drawn in before it, so that none comes early.
"""

import math

from engines.dart.settings import DartSettings

from engines.dart.build import DartWorld, numbers, touching
from engines.parts import imported
from engines.scene import Scene
from engines.world import ContactPhase, Step

FREE = {ContactPhase.APPROACH: -1.0, ContactPhase.STRIKE: 1.0}
"""By how many margins free corners are lowered in a step."""


class DartStacks(DartWorld):
    """Columns and a beam that slides out of the plane."""

    def __init__(self, scene: Scene, settings: DartSettings, dt_s: float) -> None:
        self._free, self._lowered = 0.0, (math.nan, 0.0)
        super().__init__(scene, settings, dt_s)
        dart, n = imported("dartpy"), numbers(scene, settings)
        *_, it = n.bodies
        self._world.removeSkeleton(self._world.getSkeleton(it.named))
        beam = dart.dynamics.Skeleton(it.named)
        aside, between = beam.createPrismaticJointAndBodyNodePair()
        aside.setAxis((0.0, 1.0, 0.0))
        joint, body = beam.createPlanarJointAndBodyNodePair(between)
        joint.setZXPlane()
        body.setMass(it.mass)
        body.setMomentOfInertia(*it.inertia)
        shape = dart.dynamics.BoxShape(it.size)
        node = touching(body, shape, (0.0, 0.0, 0.0), settings.friction)
        if settings.restitution is not None:
            node.getDynamicsAspect().setRestitutionCoeff(settings.restitution)
        for number, place, speed in zip(n.coordinates, it.places, it.speeds, strict=True):
            joint.setPosition(number, place)
            joint.setVelocity(number, speed)
        self._world.addSkeleton(beam)
        self._joints[-1], self._bodies[-1] = joint, body
        self._fault = self._read_back(scene)

    def step(self, step: Step) -> None:
        """Advance by a step."""
        self._free = FREE.get(step.phase, 0.0)
        super().step(step)

    def _lower(self, pivot: float) -> None:
        """Lower the corners about which columns turn, both at rest, and the free ones likewise."""
        if (pivot, self._free) == self._lowered:
            return
        self._lowered = pivot, self._free
        for node, (x, y, z) in self._corners:
            part = 1.0 if -pivot * x * z >= 0.0 else self._free
            node.setRelativeTranslation((x, y, z + math.copysign(1.0, z) * part * self._margin))
