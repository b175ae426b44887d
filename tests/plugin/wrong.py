"""The engine of one file with a fault of its own in each class, and two that are none."""

from dataclasses import replace
from types import SimpleNamespace

from my_engine import World


class Inertia(World):
    def __init__(self, scene, settings, dt_s):
        super().__init__(scene, settings, dt_s)
        self.body.moment *= 1.03


class Mass(World):
    def __init__(self, scene, settings, dt_s):
        super().__init__(scene, settings, dt_s)
        self.body.mass *= 1.03


class Heavy(World):
    """Three times as heavy altogether: that is the same motion."""

    def __init__(self, scene, settings, dt_s):
        super().__init__(scene, settings, dt_s)
        self.body.mass, self.body.moment = 3.0 * self.body.mass, 3.0 * self.body.moment


class Width(World):
    def __init__(self, scene, settings, dt_s):
        (block,) = scene.bodies
        wide = replace(block, width=1.02 * block.width, density=block.density / 1.02)
        super().__init__(SimpleNamespace(bodies=(wide,)), settings, dt_s)


class Gravity(World):
    def step(self, step):
        super().step(step._replace(pull_z=1.01 * step.pull_z))


class Standard(World):
    """Gravity of 9.80665 m/s2, as some libraries have it."""

    def step(self, step):
        super().step(step._replace(pull_z=9.80665 / 9.81 * step.pull_z))


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


def lacking(name):
    return type("Lacking", (World,), {name: None})


NoStep, NoState, NoFault, NoClose, NoMoment = map(
    lacking, ("step", "state", "fault", "close", "moment")
)
