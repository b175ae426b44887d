"""The engine of one file with a fault of its own in each class."""

from my_engine import World


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
