"""The files of an exported scene, as text."""

import inspect
import math
from dataclasses import dataclass

from jinja2 import Environment, PackageLoader, StrictUndefined

from analytic import RigidBlock, RockingFrame, SlidingBlock
from analytic.motion import Motion
from engines import Scene
from engines.declaration import Engine, Preset
from engines.parts.script import Script
from engines.run import ground
from engines.watching.sliding import LEAST_SLIP, SLIP_RATE
from studies.kit.provenance import project_version, version_of
from studies.measures.words import listed

CALLED = {
    RigidBlock: "A rocking block",
    RockingFrame: "A rocking frame",
    SlidingBlock: "A sliding block",
}
"""Class of a system -> what it is, in words."""

BLOCK, GROUND = "block.py", "ground.py"
"""Files of every exported scene."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Exported:
    """What an exported script is to be told of its run.

    Attributes
    ----------
    engine, preset : Engine, Preset
    scene : Scene
    watched_s : float
        How long it is watched [s].
    expected, exact : float or tuple of float
        Largest rotation over the critical one, or the slips [m] where nothing rocks: the engine's
        and the exact one.
    """

    engine: Engine
    preset: Preset
    scene: Scene
    watched_s: float
    expected: float | tuple[float, ...]
    exact: float | tuple[float, ...]

    @property
    def called(self) -> str:
        """What it is, in words."""
        return CALLED[type(self.scene.system)]


def files(what: Exported) -> dict[str, str]:
    """Return the name and text of every file.

    Raises
    ------
    ValueError
        If the engine writes no scripts.
    """
    script = script_of(what.engine, what.preset, what.scene)
    return {
        BLOCK: block_text(what, script),
        GROUND: ground_text(what.scene.motion),
        **script.files,
    }


def script_of(engine: Engine, preset: Preset, scene: Scene) -> Script:
    """Return a scene in the library's own words.

    Raises
    ------
    ValueError
        If the engine has none.
    """
    if engine.script is None:
        raise ValueError(f"{engine.title} writes no scripts")
    settings = preset.chosen(scene)
    return engine.script(preset.posed(scene), settings, preset.ordinary_step_s(scene))


def block_text(what: Exported, script: Script) -> str:
    """Return the script."""
    environment = Environment(
        loader=PackageLoader("studies.export", "."),
        undefined=StrictUndefined,
        trim_blocks=True,
        keep_trailing_newline=True,
    )
    return environment.get_template(f"{BLOCK}.jinja").render(
        what=what,
        posed=what.preset.posed(what.scene),
        dt_s=what.preset.ordinary_step_s(what.scene),
        script=script,
        version=project_version(),
        packages={name: version_of(name) for name in what.engine.packages},
        listed=listed,
        slow=SLIP_RATE * math.sqrt(what.scene.system.gravity * what.scene.system.width),
        short=LEAST_SLIP * what.scene.system.width,
    )


def ground_text(motion: Motion) -> str:
    """Return the ground motion as a module: the numbers, and the one function of them."""
    rows = "".join(f"    {tuple(map(float, row))},\n" for row in motion.segments())
    return (
        f"{inspect.getsource(ground)}\n\n"
        f"SEGMENTS = (\n{rows})\n\nmean_velocity = mean_velocity_of(SEGMENTS)\n"
    )
