"""An engine for `rocking score my_engine:World`: here a box on the ground in pymunk."""

import pymunk

from engines.world import Moment


class World:
    moment = Moment.NEXT  # pymunk moves a body first, and then changes its velocity

    def __init__(self, scene, settings, dt_s):
        (block,), self.space = scene.bodies, pymunk.Space()
        at, self.body = block.at, pymunk.Body(block.mass, block.inertia[1])
        self.body.position, self.body.angle = (at.x, at.z), -at.theta
        self.body.velocity, self.body.angular_velocity = (at.velocity_x, at.velocity_z), -at.rate
        box = pymunk.Poly.create_box(self.body, (block.width, block.height))
        ground = pymunk.Segment(self.space.static_body, (-1e3, 0.0), (1e3, 0.0), 0.0)
        self.space.iterations, box.friction, ground.friction = 30, settings.friction, 1.0
        self.space.add(self.body, box, ground)

    def step(self, step):  # pymunk scales the impulses it kept where its own steps differ
        self.body.position_func = lambda body, _: pymunk.Body.update_position(body, step.dt_s)
        self.space.gravity = step.pull_x * step.dt_s, step.pull_z * step.dt_s
        self.space.step(1.0)

    def state(self):
        return [(*self.body.position, -self.body.angle, -self.body.angular_velocity)]

    def fault(self):
        return ""

    close = fault  # there is nothing to release
