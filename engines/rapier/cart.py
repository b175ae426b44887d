"""Rapier: a block on a cart, a dynamic box whose other motions are locked."""

from dataclasses import replace

from engines.cart import Seen, cart_mass
from engines.declaration import Precision
from engines.parts.quiet import imported
from engines.parts.readback import disagreement
from engines.rapier.build import RapierWorld
from engines.rapier.settings import RapierSettings
from engines.scene import Scene
from engines.world import Step


class RapierCart(RapierWorld):
    """A block on a cart; see `engines.cart.Cart`."""

    def __init__(self, scene: Scene, settings: RapierSettings, dt_s: float) -> None:
        super().__init__(replace(scene, frame="base"), settings, dt_s)
        rapier, mass, cart = imported("rapier3d"), cart_mass(scene), self._base
        cart.body_type = rapier.RigidBodyType.DYNAMIC
        cart.enabled_rotations, cart.enabled_translations = (False,) * 3, (True, False, False)
        self._world.colliders[cart.colliders[0]].density = 0.0
        cart.set_additional_mass(mass, True)
        cart.recompute_mass_properties_from_colliders(self._world.colliders)
        if settings.sleeping is False:
            cart.activation = rapier.RigidBodyActivation.cannot_sleep()
        pairs = {"mass of the cart": (mass, self._base.mass)}
        self._fault = self._fault or disagreement(pairs, Precision.SINGLE.value)

    def push(self, step: Step, force: float) -> None:
        """See `engines.cart.Cart`."""
        self._base.reset_forces(True)
        self._base.add_force((force * self._unit, 0.0, 0.0), True)
        self.step(step)

    def seen(self) -> Seen:
        """See `engines.cart.Cart`."""
        (pose,), cart, unit = self.state().tolist(), self._base, self._unit
        place, own = cart.translation.x, cart.linvel.x
        return Seen(pose, self._body.linvel.x / unit, place / unit, own / unit)
