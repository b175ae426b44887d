"""DART: a block on a cart, which is on a prismatic joint."""

from dataclasses import replace

import numpy as np

from engines.cart import Seen, cart_mass
from engines.dart.build import DartWorld, numbers, touching
from engines.dart.settings import DartSettings
from engines.parts.quiet import imported
from engines.parts.readback import disagreement
from engines.scene import Scene
from engines.world import Step


class DartCart(DartWorld):
    """A block on a cart; see `engines.cart.Cart`."""

    def __init__(self, scene: Scene, settings: DartSettings, dt_s: float) -> None:
        super().__init__(replace(scene, frame="base"), settings, dt_s)
        dart, n, mass = imported("dartpy"), numbers(scene, settings), cart_mass(scene)
        self._world.removeSkeleton(self._world.getSkeleton("base"))
        cart = dart.dynamics.Skeleton("cart")
        self._rail, self._floor = cart.createPrismaticJointAndBodyNodePair()
        self._rail.setAxis((1.0, 0.0, 0.0))
        self._floor.setMass(mass)
        ground = touching(
            self._floor, dart.dynamics.BoxShape(n.floor), n.beneath, settings.friction
        )
        if settings.restitution is not None:
            ground.getDynamicsAspect().setRestitutionCoeff(settings.base_restitution)
        self._world.addSkeleton(cart)
        pairs = {"mass of the cart": (mass, self._floor.getMass())}
        self._fault = self._fault or disagreement(pairs)

    def push(self, step: Step, force: float) -> None:
        """See `engines.cart.Cart`."""
        self._rail.setForce(0, force * self._unit)
        self.step(step)

    def seen(self) -> Seen:
        """See `engines.cart.Cart`."""
        (pose,), unit = self.state().tolist(), self._unit
        speed = self._block.getLinearVelocity(np.zeros(3)).tolist()[0]
        place, own = self._rail.getPosition(0), self._rail.getVelocity(0)
        return Seen(pose, speed / unit, place / unit, own / unit)
