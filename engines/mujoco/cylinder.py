"""MuJoCo: a cylinder in space, whose rim is the true one."""

from dataclasses import replace
from importlib import import_module
from typing import Any, cast
from xml.etree import ElementTree

from engines.mujoco.model import stepped_xml
from engines.mujoco.settings import MujocoSettings, kept
from engines.scene import Scene
from engines.space import SpaceScene, rotated


class MujocoCylinder:
    """A free body with one geom, on a plane."""

    def __init__(self, scene: SpaceScene, settings: MujocoSettings, dt_s: float) -> None:
        self._mj, it = import_module("mujoco"), scene.cylinder
        posed = cast(Scene, scene)
        s = replace(kept(posed, settings), geometry="box", planar=False)
        root = ElementTree.fromstring(stepped_xml(posed, s, dt_s))
        for geom in root.iter("geom"):
            if geom.get("name") == "box":
                geom.set("type", "cylinder")
                geom.set("size", f"{it.radius!r} {0.5 * it.height!r}")
        model = self._mj.MjModel.from_xml_string(ElementTree.tostring(root, encoding="unicode"))
        model.opt.gravity[:] = 0.0, 0.0, -scene.gravity
        self._model, self._data = model, self._mj.MjData(model)
        self._data.qpos[:] = *it.place, *it.turn
        # of a free joint the spin is in the axes of the body
        self._data.qvel[:] = *it.velocity, *rotated(it.turn, it.spin, back=True)

    def step(self) -> None:
        """Advance by a step."""
        self._mj.mj_step(self._model, self._data)

    def state(self) -> Any:
        """Read the state back."""
        q, v = self._data.qpos, self._data.qvel
        return q[:3], q[3:], v[:3], rotated(q[3:], v[3:])

    def fault(self) -> str:
        """Say what the engine warned of."""
        warned = self._data.warning.number.nonzero()[0]
        kinds = list(self._mj.mjtWarning.__members__)
        return f"MuJoCo warned: {kinds[warned[0]]}" if warned.size else ""

    def close(self) -> None:
        """Release the engine's memory."""
        del self._data
