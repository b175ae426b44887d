"""MuJoCo Warp: MuJoCo's own models and loads, stepped in single precision by Warp.

A step of all worlds is dozens of kernels: they are recorded once and replayed. The library compiles
them when they are first used on a machine, for a minute, and keeps them there. The device is Warp's
own choice: a GPU where there is one, or else the CPU, whose memory is shared.
"""

import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np

from engines.declaration import Precision
from engines.mujoco.port import READ, Port
from engines.parts.compiled import FloatArray
from engines.parts.quiet import imported, silence
from engines.scene import Scene
from engines.warp.settings import WarpSettings
from engines.world import Step


class WarpWorlds(Port):
    """Worlds of MuJoCo Warp; see `engines.world.Worlds`."""

    def __init__(self, scenes: Sequence[Scene], settings: WarpSettings, dt_s: FloatArray) -> None:
        self._warp, self._mjw = imported("warp"), imported("mujoco_warp")
        self._warp.config.log_level = self._warp.LOG_ERROR
        super().__init__(scenes, settings, dt_s)
        self._overflow = np.zeros(len(scenes), dtype=int)
        with silence(), warnings.catch_warnings():
            warnings.simplefilter("ignore")  # it raises too small a friction, as MuJoCo does
            self._put(dt_s)
        self.driver = f"a recorded step of Warp's, on {self._warp.get_device()}"

    def _put(self, dt_s: FloatArray) -> None:
        """Put models and states where Warp computes, and record a step of them."""
        mjw, count = self._mjw, len(self.models)
        own = {**dict(self.different()), "geom_surfacevel": self._stack("geom_surfacevel")}
        model = mjw.put_model(self.models[0], batch_sizes=dict.fromkeys(own, count))
        for name, rows in own.items():
            there = getattr(model, name)
            seen = there.numpy()
            rows = rows.reshape(seen.shape)
            # what the library makes of a model it keeps, but for what differs
            there.assign(np.where(rows == rows[0], seen, rows).astype(np.float32))
        model.opt.warn_overflow = 0  # it would print to the output; `fault` reads it
        weight = np.tile(self.models[0].opt.gravity.astype(np.float32), (count, 1))
        model.opt.timestep = self._warp.array(dt_s.astype(np.float32))
        model.opt.gravity = self._warp.array(weight, dtype=self._warp.vec3)
        mjw.step(model, mjw.put_data(self.models[0], self.data(0), nworld=count))  # compiles
        data = mjw.put_data(self.models[0], self.data(0), nworld=count)
        for there, rows in zip(  # type: ignore[assignment]
            (data.qpos, data.qvel), zip(*self.starts, strict=True), strict=True
        ):
            there.assign(np.array(rows, dtype=np.float32))
        with self._warp.ScopedCapture() as recorded:
            mjw.step(model, data)
        self._graph = recorded.graph
        given = model.opt.gravity, data.mocap_pos, model.geom_surfacevel
        self._shared = [_Shared(array) for array in (*given, data.qpos, data.qvel, data.overflow)]
        read = {name: getattr(model, name).numpy() for name in READ}
        read["tolerance"] = model.opt.tolerance.numpy()
        self.read_back(Precision.SINGLE.value, read)

    def _stack(self, name: str) -> FloatArray:
        return np.array([getattr(model, name) for model in self.models])

    def advance(self, steps: Step, going: Any) -> FloatArray:
        """Take some steps; see `engines.world.Worlds`."""
        loads = self.loads(steps)
        gravity, place, surface, q, v, overflow = self._shared
        count, length = loads.surface.shape
        places = np.empty((count, length, q.seen.shape[-1]))
        velocities = np.empty((count, length, v.seen.shape[-1]))
        moves, slides = bool(place.seen.size), self._moving and self.settings.floor == "surfacevel"
        for i in range(length):
            gravity.give(loads.gravity[:, i])
            if moves:
                place.give(loads.place[:, i])
            if slides:
                surface.seen[:, 0, 0] = loads.surface[:, i]
                surface.give(surface.seen)
            self._warp.capture_launch(self._graph)
            places[:, i], velocities[:, i] = q.taken(), v.taken()
        self._overflow = overflow.taken()
        return self.poses(steps, places, velocities)

    def fault(self, world: int) -> str:
        """Say which setting a world has not taken, or what it had no room for."""
        kinds = self._mjw.OverflowType
        # a solver that ends at its last iteration is no fault of MuJoCo's, either
        lost = kinds(int(self._overflow[world])) & ~(kinds.ITERATIONS | kinds.LS_ITERATIONS)
        said = f"MuJoCo Warp had no room: {lost.name}" if lost else ""
        return Port.fault(self, world) or said


class _Shared:
    """An array of Warp's, which on the CPU is the one that is seen, and else is copied."""

    def __init__(self, there: Any) -> None:
        self._there, self._near, self.seen = there, there.device.is_cpu, there.numpy()

    def give(self, values: FloatArray) -> None:
        """Copy values there."""
        self.seen[:] = values
        if not self._near:
            self._there.assign(self.seen)

    def taken(self) -> Any:
        """Return what is there."""
        if not self._near:
            self.seen = self._there.numpy()
        return self.seen
