"""The files of an exported scene, as text."""

import inspect
from dataclasses import dataclass

from jinja2 import Environment, PackageLoader, StrictUndefined

from analytic.motion import Motion
from engines import Scene
from engines.declaration import Engine, Preset
from engines.parts.script import Script
from engines.run import ground
from engines.world import Moment
from studies.kit.provenance import project_version, version_of
from studies.measures.words import listed

BLOCK, GROUND = "block.py", "ground.py"
"""Files of every exported scene."""

VELOCITIES = {
    Moment.MIDDLE: "mean_velocity(begin, time)",
    Moment.END: "mean_velocity(time, time)",
    Moment.NEXT: "mean_velocity(time, time + DT)",
}
"""The base's velocity that belongs to the block's after a step."""

TURNINGS = {
    Moment.MIDDLE: "0.5 * (last_rate + rate)",
    Moment.END: "last_rate",
    Moment.NEXT: "1.5 * last_rate - 0.5 * rate",
}
"""The angular velocity at the end of the last step."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Exported:
    """What an exported script is to be told of its run.

    Attributes
    ----------
    engine, preset : Engine, Preset
    scene : Scene
    watched_s : float
        How long the block is watched [s].
    expected, exact : float
        Largest rotation over the critical one: the engine's and the exact one.
    """

    engine: Engine
    preset: Preset
    scene: Scene
    watched_s: float
    expected: float
    exact: float


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
    packages = {name: version_of(name) for name in what.engine.packages}
    return environment.get_template(f"{BLOCK}.jinja").render(
        title=what.engine.title,
        preset=what.preset.title,
        version=project_version(),
        versions=listed([" ".join(pair) for pair in packages.items()]),
        packages=packages,
        beside="".join(f", {name}" for name in script.files),
        script=script,
        moves=what.preset.posed(what.scene).frame == "world",
        block=what.scene.system,
        start=what.scene.start,
        dt_s=what.preset.ordinary_step_s(what.scene),
        shaken=what.scene.motion.duration,
        watched=what.watched_s,
        expected=repr(what.expected).replace("inf", "math.inf"),
        exact=repr(what.exact).replace("inf", "math.inf"),
        part=script.moment.value,
        velocity=VELOCITIES[script.moment],
        turning=TURNINGS[script.moment],
    )


def ground_text(motion: Motion) -> str:
    """Return the ground motion as a module: the numbers, and the one function of them."""
    rows = "".join(f"    {tuple(map(float, row))},\n" for row in motion.segments())
    return (
        f"{inspect.getsource(ground)}\n\n"
        f"SEGMENTS = (\n{rows})\n\nmean_velocity = mean_velocity_of(SEGMENTS)\n"
    )
