"""PhysX: a block on a cart, which is the link of an articulation on a prismatic joint.

A body whose motions are locked would be no cart: the solver of contacts lets it yield as if it were
free (`engines/troubles/physx_locks.py`).
"""

import math
from dataclasses import replace
from typing import Any

from engines.cart import Seen, cart_mass
from engines.declaration import Precision
from engines.parts.readback import disagreement
from engines.physx.build import PhysxWorld, numbers, values
from engines.physx.settings import PhysxSettings
from engines.scene import Scene
from engines.world import Step


class PhysxCart(PhysxWorld):
    """A block on a cart; see `engines.cart.Cart`."""

    def __init__(self, scene: Scene, settings: PhysxSettings, dt_s: float) -> None:
        super().__init__(replace(scene, frame="base"), settings, dt_s)
        sapien, mass = self._sapien, cart_mass(scene)
        n, s = numbers(scene, settings), values(scene, settings, dt_s)
        self._stage.remove_entity(self._base.entity)
        rail = sapien.physx.PhysxArticulationLinkComponent()
        cart = sapien.physx.PhysxArticulationLinkComponent(rail)
        rail.joint.type, cart.joint.type = "fixed", "prismatic"
        cart.joint.limits, cart.joint.friction = [[-math.inf, math.inf]], 0.0
        material = sapien.physx.PhysxMaterial(s.friction, s.friction, s.restitution)
        floor = sapien.physx.PhysxCollisionShapeBox(n.base_half, material)
        floor.local_pose = sapien.Pose(n.below)
        cart.attach(floor)
        for link, heavy in ((rail, 1.0), (cart, mass)):
            link.mass, link.inertia, link.cmass_local_pose = heavy, (heavy,) * 3, sapien.Pose()
            link.linear_damping = link.angular_damping = 0.0
            self._add(link, n.lowered)
        self._cart: Any = cart
        for name, value in s.solver.items():
            setattr(cart.articulation, name, value)
        pairs = {"mass of the cart": (mass, cart.mass)}
        self._fault = self._fault or disagreement(pairs, Precision.SINGLE.value)

    def push(self, step: Step, force: float) -> None:
        """See `engines.cart.Cart`."""
        self._cart.articulation.set_qf([force * self._unit])
        self.step(step)

    def seen(self) -> Seen:
        """See `engines.cart.Cart`."""
        (pose,), unit, cart = self.state().tolist(), self._unit, self._cart.articulation
        place, own, speed = cart.qpos[0], cart.qvel[0], self._bodies[0].linear_velocity[0]
        return Seen(pose, *(float(value) / unit for value in (speed, place, own)))

    def _add(self, link: Any, place: tuple[float, float, float]) -> None:
        entity = self._sapien.Entity()
        entity.add_component(link)
        entity.pose = self._sapien.Pose(place)
        self._stage.add_entity(entity)
