"""Engines with a fault of their own in each class, most of them the engine of one file."""

from dataclasses import replace
from types import SimpleNamespace

from my_engine import World
from rocking_moreau import ENGINE, MoreauSettings, MoreauWorld

from engines.registry import PlainSettings
from engines.world import Moment


class Turned(World):
    def state(self):
        ((x, z, theta, rate),) = super().state()
        return [(x, z, -theta, -rate)]


class Backwards(World):
    def state(self):
        ((x, z, theta, rate),) = super().state()
        return [(x, z, theta, -rate)]


class Mirrored(Turned):
    """Of the other sign where it is put, too."""

    def __init__(self, scene, settings, dt_s):
        super().__init__(scene, settings, dt_s)
        self.body.angle, self.body.angular_velocity = -self.body.angle, -self.body.angular_velocity


class Moreau(MoreauWorld):
    """Its own moment is END."""

    moment = Moment.MIDDLE

    def __init__(self, scene, settings: PlainSettings, dt_s):
        super().__init__(scene, MoreauSettings(friction=settings.friction, closing=True), dt_s)


Middle, End = (
    type("Staggered", (World,), {"moment": each}) for each in (Moment.MIDDLE, Moment.END)
)


class Spun(World):
    """Its moment of inertia is 3 % too large."""

    def __init__(self, scene, settings, dt_s):
        super().__init__(scene, settings, dt_s)
        self.body.moment *= 1.03


class Heavy(World):
    """Its mass is not that of the moment of inertia."""

    def __init__(self, scene, settings, dt_s):
        super().__init__(scene, settings, dt_s)
        self.body.mass *= 1.1


class Pulled(World):
    """By more than its weight."""

    def step(self, step):
        super().step(step._replace(pull_z=1.02 * step.pull_z))


class Damped(World):
    def __init__(self, scene, settings, dt_s):
        super().__init__(scene, settings, dt_s)
        self.space.damping = 0.9


class Wide(World):
    """Its box is 2 % too wide, and as heavy as it should be."""

    def __init__(self, scene, settings, dt_s):
        (block,) = scene.bodies
        larger = replace(block, width=1.02 * block.width, density=block.density / 1.02)
        super().__init__(SimpleNamespace(bodies=[larger]), settings, dt_s)


class Slippery(World):
    def __init__(self, scene, settings, dt_s):
        super().__init__(scene, replace(settings, friction=0.5 * settings.friction), dt_s)


class Bouncing(World):
    def __init__(self, scene, settings, dt_s):
        super().__init__(scene, settings, dt_s)
        for shape in self.space.shapes:
            shape.elasticity = 0.5


class Faultless(World):
    fault = None


class Silent(World):
    def step(self, step):
        raise RuntimeError("there is no answer")


SPACED = replace(ENGINE, name="my engine")
