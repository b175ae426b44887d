"""PhysX: a block on a cart, a dynamic box whose other motions are locked."""

from dataclasses import replace

from engines.cart import Seen, cart_mass
from engines.declaration import Precision
from engines.parts.readback import disagreement
from engines.physx.build import PhysxWorld
from engines.physx.settings import PhysxSettings
from engines.scene import Scene
from engines.world import Step


class PhysxCart(PhysxWorld):
    """A block on a cart; see `engines.cart.Cart`."""

    def __init__(self, scene: Scene, settings: PhysxSettings, dt_s: float) -> None:
        super().__init__(replace(scene, frame="base"), settings, dt_s)
        cart, mass = self._base, cart_mass(scene)
        cart.kinematic = False
        cart.set_locked_motion_axes([False, True, True, True, True, True])
        cart.disable_gravity = True
        cart.linear_damping = 0.0
        cart.mass, cart.inertia = mass, (mass,) * 3
        self._fault = self._fault or disagreement(
            {"mass of the cart": (mass, cart.mass)}, Precision.SINGLE.value
        )

    def push(self, step: Step, force: float) -> None:
        """See `engines.cart.Cart`."""
        self._base.add_force_torque((force * self._unit, 0.0, 0.0), (0.0, 0.0, 0.0), "force")
        self.step(step)

    def seen(self) -> Seen:
        """See `engines.cart.Cart`."""
        (pose,), cart, unit = self.state().tolist(), self._base, self._unit
        speed, own = (float(body.linear_velocity[0]) for body in (self._bodies[0], cart))
        return Seen(pose, speed / unit, float(cart.entity_pose.p[0]) / unit, own / unit)


build = PhysxCart
