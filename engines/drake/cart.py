"""Drake: a block on a cart, which is the box on a rail of a base that moves, without its drive."""

from typing import Any

import numpy as np

from engines.cart import Seen, cart_mass
from engines.drake.build import DrakeWorld, library, numbers, values
from engines.drake.build import build as built
from engines.drake.settings import CENIC, DrakeSettings
from engines.parts.readback import disagreement
from engines.scene import Scene
from engines.world import Pose, Step

NO_DRIVE = {"p": 1e-30, "d": 0.0}
"""Gains of a drive that leaves its joint to the force: none may be zero [N/m, N s/m]."""


class DrakeCart(DrakeWorld):
    """A block on a cart; see `engines.cart.Cart`."""

    def __init__(self, scene: Scene, settings: DrakeSettings, dt_s: float) -> None:
        self._s, self._dt, self._continuous = settings, dt_s, settings.solver == CENIC
        self._count, self._problem, self._moving = 0, "", False
        n, v = numbers(scene, settings), values(scene, settings, dt_s)
        n.heavy, v.gains = cart_mass(scene), NO_DRIVE
        self._plant, graph, self._bodies, self._simulator, self._context = built(library(), n, v)
        self._blocks = self._bodies[0].model_instance()
        self._field = self._plant.mutable_gravity_field()
        self._state = np.zeros((1, len(Pose._fields)))
        self._rail: Any = self._plant.GetJointByName("rail")
        floor = self._rail.child_body()
        self._drive_by = self._plant.get_actuation_input_port(floor.model_instance())
        self._plant.get_desired_state_input_port(floor.model_instance()).FixValue(
            self._context, [0.0, 0.0]
        )
        pairs = {"mass of the cart": (cart_mass(scene), floor.get_mass(self._context))}
        self._fault = self._read_back(scene, graph) or disagreement(pairs)

    def push(self, step: Step, force: float) -> None:
        """See `engines.cart.Cart`."""
        self._drive_by.FixValue(self._context, [force])
        self.step(step)

    def seen(self) -> Seen:
        """See `engines.cart.Cart`."""
        (pose,) = self.state().tolist()
        # with CENIC the velocities that the library evaluates lag a step behind its state
        speed = self._plant.GetVelocities(self._context, self._blocks)[1 if self._s.planar else 3]
        place = self._rail.get_translation(self._context)
        return Seen(pose, float(speed), place, self._rail.get_translation_rate(self._context))
