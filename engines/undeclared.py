"""An engine of which nothing is known but what builds its world."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from engines.declaration import Engine, Preset, Stepping
from engines.disclosure import Help
from engines.parts.settings import check, setting
from engines.scene import Scene
from engines.world import World

FIXED_STEP = 1e-3
"""p dt of equal steps."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlainSettings:
    """The one setting that every engine must take: friction between block and base."""

    friction: float = setting(1.0, above=0.0)

    def __post_init__(self) -> None:
        check(self)


def undeclared(name: str, build: Callable[[Scene, Any, float], World], library: str) -> Engine:
    """Return an engine that is used as it is built, with equal steps and with ones that land.

    Parameters
    ----------
    name : str, by which a user asks for it
    build : callable, ``(scene, settings, dt_s) -> World``, settings being `PlainSettings` and dt_s
        the ordinary step [s]
    library : str, the module to import, and what pip is told to install

    Returns
    -------
    Engine
        It holds one body, in the frame "base" alone.
    """
    return Engine(
        name=name,
        title=name,
        library=library,
        packages=(),
        install=library,
        build=build,
        presets=(
            Preset(name="fixed", title="equal steps", settings=PlainSettings(), step=FIXED_STEP),
            Preset(
                name="landing",
                title="steps that land on impacts",
                settings=PlainSettings(),
                stepping=Stepping.LANDING,
                helped_by={Help.STEPS: None},
            ),
        ),
        frames=("base",),
    )
