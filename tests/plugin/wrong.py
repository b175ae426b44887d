"""Engines with a fault of their own in each class, most of them the engine of one file."""

from dataclasses import replace

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


class Silent(World):
    def step(self, step):
        raise RuntimeError("there is no answer")


SPACED = replace(ENGINE, name="my engine")
