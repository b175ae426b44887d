"""PyBullet: a block on a cart, which is the link of a multibody on a prismatic joint.

Its joint is one coordinate, and exact. Its shape is that of the preset's moving base: under corner
spheres a plane, since on a box the library finds their contacts too coarsely for a base that yields
(errors of the peak of 2 to 9 %, for 1e-6). A box on ground without friction, the other way to make
a cart, would rest on contacts of its own, and errs as much.
"""

from dataclasses import replace

from engines.cart import Seen, cart_mass
from engines.parts.readback import disagreement
from engines.pybullet.build import BulletWorld
from engines.pybullet.calls import base_place, base_shape
from engines.pybullet.settings import BulletSettings
from engines.scene import Scene
from engines.world import Step

RAIL = 0
"""Number of the link that is the cart."""

NOWHERE, UPRIGHT = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)


class BulletCart(BulletWorld):
    """A block on a cart; see `engines.cart.Cart`."""

    def __init__(self, scene: Scene, settings: BulletSettings, dt_s: float) -> None:
        super().__init__(replace(scene, frame="base", compiled=False), settings, dt_s)
        p, here = self._p, {"physicsClientId": self._client}
        p.removeBody(self._base, **here)
        links = {
            "linkMasses": [cart_mass(scene)],
            "linkCollisionShapeIndices": [self._do(base_shape(scene, settings))],
            "linkVisualShapeIndices": [-1],
            "linkPositions": [base_place(scene, settings)],
            "linkOrientations": [UPRIGHT],
            "linkInertialFramePositions": [NOWHERE],
            "linkInertialFrameOrientations": [UPRIGHT],
            "linkParentIndices": [0],
            "linkJointTypes": [p.JOINT_PRISMATIC],
            "linkJointAxis": [(1.0, 0.0, 0.0)],
        }
        self._cart = p.createMultiBody(baseMass=0.0, **links, **here)
        still = {"linearDamping": 0.0, "angularDamping": 0.0, "jointDamping": 0.0}
        rough = {"lateralFriction": 1.0, "restitution": settings.base_restitution}
        p.changeDynamics(self._cart, RAIL, **still, **rough, **here)
        p.setJointMotorControl2(self._cart, RAIL, p.VELOCITY_CONTROL, force=0.0, **here)
        found = p.getDynamicsInfo(self._cart, RAIL, **here)
        pairs = {"mass of the cart": (cart_mass(scene), found[0]), "its friction": (1.0, found[1])}
        self._fault = self._fault or disagreement(pairs)

    def push(self, step: Step, force: float) -> None:
        """See `engines.cart.Cart`."""
        p, here = self._p, {"physicsClientId": self._client}
        p.setJointMotorControl2(self._cart, RAIL, p.TORQUE_CONTROL, force=force, **here)
        self.step(step)

    def seen(self) -> Seen:
        """See `engines.cart.Cart`."""
        p, here = self._p, {"physicsClientId": self._client}
        (pose,) = self.state().tolist()
        speed = p.getBaseVelocity(self._bodies[0], **here)[0][0]
        cart, cart_speed, *_ = p.getJointState(self._cart, RAIL, **here)
        return Seen(pose, speed, cart, cart_speed)
