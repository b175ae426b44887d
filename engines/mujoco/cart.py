"""MuJoCo: a block on a cart, which is a box on a slide joint."""

import math
from dataclasses import replace
from importlib import import_module
from typing import Any
from xml.etree import ElementTree

from engines.cart import Seen, cart_mass
from engines.mujoco.model import coordinates, stepped_xml
from engines.mujoco.settings import MujocoSettings, kept
from engines.parts.readback import disagreement
from engines.scene import Scene
from engines.world import Moment, Step


def model_of(scene: Scene, s: MujocoSettings, dt_s: float) -> str:
    """Return the model of a scene, its base free along x; its joint is the first one."""
    root = ElementTree.fromstring(stepped_xml(scene, replace(s, floor="position"), dt_s))
    (cart,) = (body for body in root.iter("body") if body.attrib.pop("mocap", ""))
    for geom in cart.iter("geom"):
        geom.attrib.pop("surfacevel")
    ElementTree.SubElement(cart, "joint", type="slide", axis="1 0 0")
    mass, unused = repr(cart_mass(scene)), "1 1 1"  # it never turns
    ElementTree.SubElement(cart, "inertial", pos="0 0 0", mass=mass, diaginertia=unused)
    return ElementTree.tostring(root, encoding="unicode")


class MujocoCart:
    """A block on a cart; see `engines.cart.Cart`."""

    def __init__(self, scene: Scene, settings: MujocoSettings, dt_s: float) -> None:
        s, self._mj = kept(scene, settings), import_module("mujoco")
        self._planar, self._home = s.planar, scene.bodies[0].home
        self.moment = Moment.END if s.integrator == "RK4" else Moment.MIDDLE
        self._model: Any = self._mj.MjModel.from_xml_string(model_of(scene, s, dt_s))
        self._data: Any = self._mj.MjData(self._model)
        places, velocities = coordinates(scene, replace(s, floor="position"))
        self._data.qpos[:], self._data.qvel[:] = (0.0, *places), (0.0, *velocities)
        model = self._model
        self._fault = disagreement(
            {
                "mass of the cart": (cart_mass(scene), model.body_mass[1]),
                "mass": (scene.bodies[0].mass, model.body_mass[2]),
                "timestep": (dt_s, model.opt.timestep),
                "friction": (s.friction, model.geom_friction[-1, 0]),
            }
        )
        self._mj.set_mju_user_warning(lambda message: None)  # `fault` reads what it counts

    def push(self, step: Step, force: float) -> None:
        """See `engines.cart.Cart`."""
        self._model.opt.gravity[:] = step.pull_x, 0.0, step.pull_z
        self._data.qfrc_applied[0] = force
        self._mj.mj_step(self._model, self._data)

    def seen(self) -> Seen:
        """See `engines.cart.Cart`."""
        (cart, *q), (speed, *v) = self._data.qpos.tolist(), self._data.qvel.tolist()
        if self._planar:
            x, z = self._home
            return Seen((q[0] + x, q[1] + z, q[2], v[2]), v[0], cart, speed)
        return Seen((q[0], q[2], 2.0 * math.atan2(q[5], q[3]), v[4]), v[0], cart, speed)

    def fault(self) -> str:
        """See `engines.cart.Cart`."""
        warned = self._data.warning.number.nonzero()[0]
        return self._fault or ("MuJoCo warned" if warned.size else "")

    def close(self) -> None:
        """Give warnings back to the library."""
        self._mj.set_mju_user_warning(None)
