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


def scaled(part, name, factor):
    """Return a world in which something is larger than it should be by a factor."""

    def begin(world, *given):
        World.__init__(world, *given)
        setattr(getattr(world, part), name, factor * getattr(getattr(world, part), name))

    return type("Scaled", (World,), {"__init__": begin})


Spun = scaled("body", "moment", 1.03)
Heavy = scaled("body", "mass", 1.1)
Damped = scaled("space", "damping", 0.9)


class Pulled(World):
    """By more than its weight."""

    def step(self, step):
        super().step(step._replace(pull_z=1.02 * step.pull_z))


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
