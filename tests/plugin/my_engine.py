"""An engine for `rocking score my_engine:World`: here a box on the ground in pymunk.

The forces at the two corners on which a block stands converge the more slowly, the more slender it
is; after 10 iterations, pymunk's own, and steps that differ, they throw it about.
"""

import pymunk

from engines.world import Moment


class World:
    moment = Moment.NEXT  # pymunk moves a body first, and then changes its velocity

    def __init__(self, scene, settings, dt_s):
        (block,), self.space = scene.bodies, pymunk.Space()
        self.space.iterations = min(1000, round(40 * (1 + (block.height / block.width) ** 2)))
        at, self.body = block.at, pymunk.Body(block.mass, block.inertia[1])
        self.body.position, self.body.angle = (at.x, at.z), -at.theta
        self.body.velocity, self.body.angular_velocity = (at.velocity_x, at.velocity_z), -at.rate
        box = pymunk.Poly.create_box(self.body, (block.width, block.height))
        ground = pymunk.Segment(self.space.static_body, (-1e3, 0.0), (1e3, 0.0), 0.0)
        box.friction, ground.friction = settings.friction, 1.0
        self.space.add(self.body, box, ground)

    def step(self, step):
        self.space.gravity = step.pull_x, step.pull_z
        self.space.step(step.dt_s)

    def state(self):
        return [(*self.body.position, -self.body.angle, -self.body.angular_velocity)]

    def fault(self):
        return ""

    close = fault  # there is nothing to release
