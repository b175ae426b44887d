"""Boxes on boxes in pymunk: an engine from outside that declares more than one body."""

import pymunk

from engines.declaration import Engine, Preset
from engines.registry import PlainSettings
from engines.world import Moment


class World:
    moment = Moment.NEXT

    def __init__(self, scene, settings, dt_s):
        self.space, self.bodies = pymunk.Space(), []
        self.space.iterations = 50
        ground = pymunk.Segment(self.space.static_body, (-1e3, 0.0), (1e3, 0.0), 0.0)
        ground.friction = settings.friction
        self.space.add(ground)
        for wanted in scene.bodies:
            at, body = wanted.at, pymunk.Body(wanted.mass, wanted.inertia[1])
            body.position, body.angle = (at.x, at.z), -at.theta
            body.velocity, body.angular_velocity = (at.velocity_x, at.velocity_z), -at.rate
            box = pymunk.Poly.create_box(body, (wanted.width, wanted.height))
            box.friction = 1.0
            self.space.add(body, box)
            self.bodies.append(body)

    def step(self, step):
        self.space.gravity = step.pull_x, step.pull_z
        self.space.step(step.dt_s)

    def state(self):
        return [(*body.position, -body.angle, -body.angular_velocity) for body in self.bodies]

    def fault(self):
        return ""

    def close(self):
        pass


ENGINE = Engine(
    name="stacks",
    title="Stacks",
    library="pymunk",
    packages=("pymunk",),
    install="pymunk",
    build=World,
    presets=(
        Preset(name="fixed", title="equal steps", settings=PlainSettings(), step=1e-3, stacked={}),
    ),
    frames=("base",),
    stacks=True,
)
