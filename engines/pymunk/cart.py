"""pymunk (Chipmunk2D): a block on a cart, which a groove in the static body guides."""

import math
from dataclasses import replace
from typing import Any

from engines.cart import Seen, cart_mass
from engines.parts.readback import disagreement
from engines.parts.shapes import FLOOR_HEIGHTS
from engines.pymunk.build import PymunkWorld
from engines.pymunk.settings import PymunkSettings
from engines.scene import Scene
from engines.world import Step


class PymunkCart(PymunkWorld):
    """A block on a cart; see `engines.cart.Cart`."""

    def __init__(self, scene: Scene, settings: PymunkSettings, dt_s: float) -> None:
        super().__init__(replace(scene, frame="base"), settings, dt_s)
        pymunk, cart, mass = self._pm, self._base, cart_mass(scene)
        cart.body_type = pymunk.Body.DYNAMIC
        cart.mass, cart.moment = mass, math.inf
        if not settings.positions:
            cart.position_func = pymunk.Body.update_position
        far = FLOOR_HEIGHTS * scene.bodies[0].height * self._unit
        ends: Any = (-far, 0.0), (far, 0.0), (0.0, 0.0)
        guide = pymunk.GrooveJoint(self._space.static_body, cart, *ends)
        self._space.add(guide)
        self._fault = self._fault or disagreement({"mass of the cart": (mass, cart.mass)})

    def push(self, step: Step, force: float) -> None:
        """See `engines.cart.Cart`."""
        self._base.force = force * self._unit, 0.0
        self.step(step)

    def seen(self) -> Seen:
        """See `engines.cart.Cart`."""
        (pose,), cart, unit = self.state().tolist(), self._base, self._unit
        speed, own = self._bodies[0].velocity[0], cart.velocity[0]
        pose[1] -= cart.position[1] / unit
        return Seen(pose, speed / unit, cart.position[0] / unit, own / unit)
