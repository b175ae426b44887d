"""Newton (Warp): a cylinder in space, on a plane at rest; built as a block is but for its shape."""

from types import SimpleNamespace
from typing import Any

from engines.newton.models import build as build_recorded
from engines.newton.models import numbers, values
from engines.newton.settings import NewtonSettings
from engines.parts.quiet import imported, silence

MOST_CONTACTS = 16
"""Room for so many contacts: those of a face that lies down."""


class NewtonCylinder:
    """A body with one shape, on a plane."""

    def __init__(self, scene: Any, settings: NewtonSettings, dt_s: float) -> None:
        newton, self._warp, it = imported("newton"), imported("warp"), scene.cylinder
        self._warp.config.log_level = self._warp.LOG_ERROR
        n, s = numbers(scene, settings), values(scene, settings, dt_s)
        n.most, s.geometry = MOST_CONTACTS, "box"
        with silence():
            self._built = build_recorded(_rounded(newton), self._warp, n, s)
        _, solver, now, self._graph, _, self._place, self._velocity, *_ = self._built
        solver.reset(now)
        w, *xyz = it.turn
        self._place[0], self._velocity[0] = (*it.place, *xyz, w), (*it.velocity, *it.spin)

    def step(self) -> None:
        """Advance by a step."""
        self._warp.capture_launch(self._graph)

    def state(self) -> Any:
        """Read the state back."""
        place, (x, y, z, w) = self._place[0, :3], self._place[0, 3:]
        return place, (w, x, y, z), self._velocity[0, :3], self._velocity[0, 3:]

    def fault(self) -> str:
        """Say nothing: the library reports no fault."""
        return ""

    def close(self) -> None:
        """Release the engine's memory."""
        self._built = ()


def _rounded(newton: Any) -> Any:
    """Return the library with a builder that makes a cylinder of what is asked for as a box."""

    class Rounded(newton.ModelBuilder):  # type: ignore[misc]
        def add_shape_box(self, body: int, hx: float, hy: float, hz: float, cfg: Any) -> int:
            return int(self.add_shape_cylinder(body, radius=hx, half_height=hz, cfg=cfg))

    return SimpleNamespace(**{**vars(newton), "ModelBuilder": Rounded})
