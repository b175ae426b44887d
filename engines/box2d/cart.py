"""Box2D: a block on a cart, which a prismatic joint guides."""

from dataclasses import replace

from engines.box2d.build import Box2DWorld
from engines.box2d.settings import Box2DSettings
from engines.cart import Seen, cart_mass
from engines.declaration import Precision
from engines.parts.quiet import imported
from engines.parts.readback import disagreement
from engines.scene import Scene
from engines.world import Step


class Box2DCart(Box2DWorld):
    """A block on a cart; see `engines.cart.Cart`."""

    def __init__(self, scene: Scene, settings: Box2DSettings, dt_s: float) -> None:
        super().__init__(replace(scene, frame="base"), settings, dt_s)
        box2d, world = imported("Box2D"), self._world
        self._cart, *others = self._floors
        self._level, mass = self._cart.position.y, cart_mass(scene)
        for fixture in (*self._cart.fixtures, *self._body.fixtures):
            fixture.filterData = box2d.b2Filter()  # one floor for both corners
        for floor in others:
            world.DestroyBody(floor)
        self._floors = []  # the library moves it
        self._cart.type = box2d.b2_dynamicBody
        self._cart.fixedRotation, self._cart.sleepingAllowed = True, settings.sleeping
        self._cart.massData = box2d.b2MassData(mass=mass, center=(0.0, 0.0), I=0.0)
        rail = world.CreateStaticBody(position=self._cart.position)
        ends = {"bodyA": rail, "bodyB": self._cart, "anchor": self._cart.position}
        world.CreatePrismaticJoint(axis=(1.0, 0.0), **ends)
        pairs = {"mass of the cart": (mass, self._cart.mass)}
        self._fault = self._fault or disagreement(pairs, Precision.SINGLE.value)

    def push(self, step: Step, force: float) -> None:
        """See `engines.cart.Cart`."""
        self._cart.ApplyForceToCenter((force * self._unit, 0.0), True)
        self.step(step)

    def seen(self) -> Seen:
        """See `engines.cart.Cart`."""
        (pose,), cart, unit = self.state().tolist(), self._cart, self._unit
        pose[1] -= (cart.position.y - self._level) / unit
        speed, own = self._body.linearVelocity.x, cart.linearVelocity.x
        return Seen(pose, speed / unit, cart.position.x / unit, own / unit)

    def close(self) -> None:
        """Release the engine's memory."""
        self._world = None
