"""MJX: MuJoCo's own models and loads, stepped by JAX in single or double precision.

Some steps of some worlds are compiled together, for each kind of model and each number of them, and
kept for the next process. The device is JAX's own choice: a GPU where there is one, or the CPU.
"""

import os
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from engines.declaration import Precision
from engines.mjx.settings import MjxSettings
from engines.mujoco.port import READ, Port
from engines.parts.compiled import FloatArray
from engines.parts.quiet import imported
from engines.run.drive import LOOK_AROUND
from engines.scene import Scene
from engines.world import Step


class MjxWorlds(Port):
    """Worlds of MJX; see `engines.world.Worlds`."""

    def __init__(self, scenes: Sequence[Scene], settings: MjxSettings, dt_s: FloatArray) -> None:
        self._jax, self._mjx = imported("jax"), imported("mujoco.mjx")
        self._double = settings.precision == "double"
        super().__init__(scenes, settings, dt_s)
        self._advance = _advance(self._jax, self._mjx)
        with self._jax.enable_x64(self._double):
            self._put()
        words = f"{settings.precision} precision, on {self._jax.default_backend()}"
        self.driver = f"steps compiled by JAX, {words}"

    def _put(self) -> None:
        """Put models and states where JAX computes."""
        jax, mjx, leaves = self._jax, self._mjx, []
        for number, model in enumerate(self.models):
            there = mjx.put_model(model, impl="jax")
            # sizes that only height fields ask for, but for each of which it would be compiled anew
            unasked = np.zeros_like(there._impl.geom_rbound_hfield)
            there = there.tree_replace({"_impl.geom_rbound_hfield": unasked})
            each = there, mjx.put_data(model, self.data(number), impl="jax")
            found, self._tree = jax.tree_util.tree_flatten(each)
            leaves.append(found)
        same = zip(*leaves, strict=True)
        self._leaves = [jax.numpy.asarray(np.stack([*map(np.asarray, part)])) for part in same]
        there, data = jax.tree_util.tree_unflatten(self._tree, self._leaves)
        self._now = data.qpos, data.qvel, data.qacc_warmstart
        read = {name: getattr(there, name) for name in READ}
        read |= {name: getattr(there.opt, name) for name in ("tolerance", "impratio")}
        self.read_back((Precision.DOUBLE if self._double else Precision.SINGLE).value, read)

    def advance(self, steps: Step, going: Any) -> FloatArray:
        """Take some steps; see `engines.world.Worlds`."""
        loads, length = self.loads(steps), np.asarray(steps.dt_s).shape[1]
        # one step, or as many as are compiled: those too many are taken, and forgotten
        taken = np.minimum(np.arange(1 if length == 1 else LOOK_AROUND), length - 1)
        given = loads.gravity[:, taken], loads.place[:, taken]
        with self._jax.enable_x64(self._double):
            seen, self._now = self._advance(self._tree, self._leaves, self._now, given, length - 1)
        q, v = (np.asarray(part, dtype=np.float64)[:, :length] for part in seen)
        return self.poses(steps, q, v)


@cache
def _advance(jax: Any, mjx: Any) -> Any:
    """Return steps of worlds, compiled once for each kind and number and kept on this machine."""
    if jax.config.jax_compilation_cache_dir is None:
        kept_in = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
        jax.config.update("jax_compilation_cache_dir", str(Path(kept_in) / "jax"))

    def advance(tree: Any, leaves: Any, now: Any, loads: Any, last: Any) -> Any:
        def one_world(leaves: Any, now: Any, loads: Any) -> Any:
            model, data = jax.tree_util.tree_unflatten(tree, leaves)

            def one_step(now: Any, load: Any) -> Any:
                (place, velocity, answer), (gravity, base) = now, load
                there = model.tree_replace({"opt.gravity": gravity})
                at = data.replace(qpos=place, qvel=velocity, qacc_warmstart=answer, mocap_pos=base)
                at = mjx.step(there, at)
                now = at.qpos, at.qvel, at.qacc_warmstart
                return now, now

            return jax.lax.scan(one_step, now, loads)[1]

        seen = jax.vmap(one_world)(leaves, now, loads)
        return seen[:2], tuple(part[:, last] for part in seen)

    return jax.jit(advance, static_argnums=0)
