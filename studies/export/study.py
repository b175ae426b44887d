"""A scene written out for an engine alone: files, and the peak to expect of them."""

import inspect
import math
import sys
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from analytic import RigidBlock, RockingFrame, SlidingBlock
from analytic.motion import Motion
from analytic.response import Response
from engines import ENGINES, Scene
from engines.declaration import Engine, Preset, Stepping
from engines.parts.script import Script
from engines.run import ground
from engines.scene import perhaps
from engines.watching.sliding import LEAST_SLIP, SLIP_RATE
from studies.cases.paper import free_rocking_window
from studies.old.arguments import BadInputError, Place, Step, TimeLimit, refuse_both
from studies.old.drafts import draft_place
from studies.old.executors import Local
from studies.old.jobs import Job, summary
from studies.old.journal import Row
from studies.old.options import NOT_YOURS, Yours
from studies.old.posing import DEFAULT_EXCITATION, Excitation, refuse_endless
from studies.old.provenance import project_version, version_of
from studies.old.runner import exit_code, run_jobs
from studies.old.standing import ONE_BLOCK, Height, Standing, Width
from studies.measures.words import listed


def command(
    *,
    engine: str,
    out: Place,
    width: Width,
    height: Height,
    preset: str | None = None,
    excitation: Excitation = DEFAULT_EXCITATION,
    standing: Standing = ONE_BLOCK,
    step: Step | None = None,
    yours: Yours = NOT_YOURS,
    time_limit: TimeLimit = 60.0,
) -> int:
    """Write a scene as a script that needs an engine's library alone, with what to expect of it.

    Parameters
    ----------
    engine
        Name of an engine; a preset may follow after a colon.
    out
        Folder for the files, a new or an empty one: block.py, ground.py and the model, where the
        library reads one.
    preset
        One of the engine's with equal steps: naive or fixed; fixed by default.
    step
        p dt [-], the step in units of 1/p; by default the preset's.
    time_limit
        Wall-clock time [s] after which the engine is given up.
    """
    refuse_both(dt=yours.dt, step=step)
    asked, used = _asked(engine, preset)
    block = standing.system(width, height, yours.friction)
    if type(block) not in CALLED:
        words = "it must be one that a script can look at: block, frame or slide"
        raise BadInputError(f"--scene is {standing.scene!r}; {words}")
    posed = standing.pose(block, excitation)
    motion = posed.motion
    _check_folder(out)
    window = free_rocking_window(block, motion)
    refuse_endless(block, window, step=step, dt=yours.dt)
    source = f"{asked.name}:{used.name}"
    begin: dict[str, Any] = {} if posed.start == (0.0, 0.0) else {"start": posed.start}
    stepped = {} if step is None else {"step": step}
    options = {**begin, **stepped, **yours.options([source], block)[source]}
    scene = Scene(system=block, motion=motion, preset=used.name, duration=window, **options)
    if lacking := unwritten(asked, used, scene):
        print(f"failed: {source}: not available: {lacking}, as a script", file=sys.stderr)
        return 1
    rows = run_jobs(
        [
            Job(labels={}, block=block, motion=motion, source=name, duration=window, options=how)
            for name, how in (("exact", begin), (source, options))
        ],
        executor=Local(workers=1, time_limit_s=time_limit, at_once=True),
        reduce=_reduce,
    )
    if code := exit_code(rows):
        return code
    exact, found = (row["told"] for row in rows)
    if not found:
        words = "what stands on its base stays at rest, with nothing to tell"
        raise BadInputError(f"--engine is {engine!r}; {words}")
    what = Exported(
        engine=asked, preset=used, scene=scene, watched_s=window, expected=found, exact=exact
    )
    out.mkdir(parents=True, exist_ok=True)
    texts = files(what)
    with ExitStack() as places:  # the script takes its place when all others have theirs
        for name, text in texts.items():
            places.enter_context(draft_place(out / name)).write_bytes(text.encode())
    for name in texts:
        print(out / name)
    if standing.rocks:
        print(f"largest rotation to expect: {found:.12g} of the critical one; exact {exact:.12g}")
    else:
        shown = (" ".join(f"{slip:.12g}" for slip in slips) for slips in (found, exact))
        print("slips to expect: {} m; exact {} m".format(*shown))
    if preset is None and engine == asked.name:
        best = asked.used_for(replace(scene, preset=None)).name
        others = "" if best == used.name else f"; in other commands {engine} is {engine}:{best}"
        print(f"preset: {used.name}, in equal steps{others}")
    return 0


def unwritten(engine: Engine, preset: Preset, scene: Scene) -> str:
    """Say what of a scene is not written out with a preset, or return an empty string."""
    asks = scene.layout.asks
    builder = inspect.unwrap(engine.builder(asks, preset))
    if (lacking := engine.lacks(scene, preset)) or builder is engine.build:
        return lacking
    return f"{engine.title} is not built here for {asks[0].value}"


def _reduce(job: Job, response: Response) -> Row:
    """Return the summary, and what a script is to find: the peak, or slips where nothing rocks."""
    slides = isinstance(job.block, SlidingBlock)
    return {**summary(job, response), "told": response.slips if slides else response.peak_ratio}


def _asked(engine: str, preset: str | None) -> tuple[Engine, Preset]:
    """Return an engine and its preset, which must be ones that can be written out."""
    name, colon, after = engine.partition(":")
    able = [name for name, engine in ENGINES.items() if engine.script is not None]
    if name not in able:
        words = f"it must be one that can be written out: {', '.join(able)}"
        raise BadInputError(f"--engine is {engine!r}{perhaps(name, able)}; {words}")
    if colon and preset is not None:
        words = "it may be given only where --engine has none after a colon"
        raise BadInputError(f"--preset is {preset!r}; {words}")
    asked, wanted = ENGINES[name], after if colon else preset or "fixed"
    equal = [use.name for use in asked.presets if use.stepping is Stepping.FIXED]
    if wanted not in equal:
        begin = f"--engine is {engine!r}; its preset" if colon else f"--preset is {preset!r}; it"
        raise BadInputError(f"{begin} must have equal steps: {', '.join(equal)}")
    return asked, asked.preset(wanted)


def _check_folder(out: Path) -> None:
    try:
        why = " (it is not empty)" if out.exists() and any(out.iterdir()) else ""
    except OSError as error:
        why = f" ({error.strerror})"
    if why:
        raise BadInputError(f"--out is {str(out)!r}; it must be a new or an empty folder{why}")


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
