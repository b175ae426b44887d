"""A scene written out for an engine alone: files, and the peak to expect of them."""

import inspect
import math
import sys
from contextlib import ExitStack
from dataclasses import replace
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from analytic import RigidBlock, RockingFrame, SlidingBlock
from engines import ENGINES, Scene
from engines.declaration import STACKED, Engine, Preset, Stepping
from engines.run import ground
from engines.run.slide import LEAST_SLIP, SLIP_RATE
from engines.settings import perhaps
from engines.world import Script
from studies.cases.paper import free_rocking_window
from studies.cases.refusal import BadInputError
from studies.kit.arguments import Place, Step, TimeLimit, refuse_both, refuse_given
from studies.kit.cluster import place_of
from studies.kit.identity import version_of
from studies.kit.jobs import Job, Question, Row, ask, summary
from studies.kit.options import Computing, Yours
from studies.kit.run import exit_code, run
from studies.kit.say import listed
from studies.kit.scene_options import Excitation, Height, Standing, Width, refuse_endless
from studies.kit.store import project_version
from studies.kit.tables import draft
from studies.sources.registry import scene_of

TITLES = {RigidBlock: "rocking block", RockingFrame: "rocking frame", SlidingBlock: "sliding block"}


def command(
    *,
    engine: str,
    out: Place,
    width: Width,
    height: Height,
    preset: str | None = None,
    excitation: Excitation = Excitation(),  # noqa: B008
    standing: Standing = Standing(),  # noqa: B008
    step: Step | None = None,
    yours: Yours = Yours(),  # noqa: B008
    time_limit: TimeLimit = 60.0,
) -> int:
    """Write a scene as a script that needs an engine's library alone, with what to expect of it.

    For presets with equal steps. The script is Python, with the model beside it where the library
    has a format for one, and the ground motion; it says whether it finds the peak that this project
    finds.

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
    asked, used = _resolve(engine, preset)
    system = standing.system(width, height, yours.friction)
    motion, start = excitation.pose(system)
    if out.exists() and any(out.iterdir()):
        raise BadInputError(f"--out is {str(out)!r}; it must be a new or an empty folder")
    window = free_rocking_window(system, motion)
    refuse_endless(system, window, step=step, dt=yours.dt)
    case = Question(system=system, motion=motion, start=start, duration=window)
    source = f"{asked.name}:{used.name}"
    options = yours.options([source], system)[source] | ({} if step is None else {"step": step})
    scene = scene_of(system, motion, used.name, start=start, duration=window, **options)
    if lacking := unwritten(asked, used, scene):
        print(f"failed: {source}: not available: {lacking}, as a script", file=sys.stderr)
        return 1
    questions = {"exact": {}, source: options}
    jobs = [Job(labels={}, case=case, source=each, options=of) for each, of in questions.items()]
    rows = run(jobs, measure, place_of(Computing(jobs=1, time_limit=time_limit), at_once=True))
    if code := exit_code(rows):
        return code
    exact, found = (row["found"] for row in rows)
    if not found:
        raise BadInputError(
            f"--engine is {engine!r}; what is exported must move there, and stays at rest"
        )
    out.mkdir(parents=True, exist_ok=True)
    texts = files(asked, scene, found, exact)
    with ExitStack() as places:  # the script takes its place when all others have theirs
        for name, text in texts.items():
            places.enter_context(draft(out / name)).write_bytes(text.encode())
    for name in texts:
        print(out / name)
    if isinstance(found, tuple):
        slips = (" ".join(f"{slip:.12g}" for slip in each) for each in (found, exact))
        print("slips to expect: {} m; exact {} m".format(*slips))
    else:
        print(f"largest rotation to expect: {found:.12g} of the critical one; exact {exact:.12g}")
    if preset is None and engine == asked.name:
        best = asked.use(replace(scene, preset=None)).preset.name
        others = "" if best == used.name else f"; in other commands {engine} is {engine}:{best}"
        print(f"preset: {used.name}, in equal steps{others}")
    return 0


def _resolve(engine: str, preset: str | None) -> tuple[Engine, Preset]:
    """Return an engine and its preset, which must be ones that can be written out."""
    name, colon, after = engine.partition(":")
    able = [name for name, engine in ENGINES.items() if engine.script is not None]
    if name not in able:
        words = f"it must be one that can be written out: {', '.join(able)}"
        raise BadInputError(f"--engine is {engine!r}{perhaps(name, able)}; {words}")
    if colon:
        refuse_given({"preset": preset}, "only where --engine has none after a colon")
    equal = [use.name for use in ENGINES[name].presets if use.stepping is Stepping.FIXED]
    if (wanted := after if colon else preset or "fixed") not in equal:
        begin = f"--engine is {engine!r}; its preset" if colon else f"--preset is {preset!r}; it"
        raise BadInputError(f"{begin} must have equal steps: {', '.join(equal)}")
    return ENGINES[name], ENGINES[name].preset(wanted)


def measure(job: Job) -> Row:
    """Return the summary, and what a script is to find: the peak, or slips where nothing rocks."""
    response = ask(job)
    slides = isinstance(job.case.system, SlidingBlock)
    return {**summary(response), "found": response.slips if slides else response.peak_ratio}


def unwritten(engine: Engine, preset: Preset, scene: Scene) -> str:
    """Say what of a scene is not written out with a preset, or return an empty string."""
    use = engine.use(replace(scene, preset=preset.name))
    if use.lacking or inspect.unwrap(use.build) is engine.build:
        return use.lacking
    return f"{engine.title} is not built here for {STACKED}"


def script_of(engine: Engine, scene: Scene) -> Script:
    """Return a scene, with the preset that it names, in the library's own words."""
    if engine.script is None:
        raise ValueError(f"{engine.title} writes no scripts")
    use = engine.use(scene)
    return engine.script(use.scene, use.settings, use.dt_s)


def files(engine: Engine, scene: Scene, expected: Any, exact: Any) -> dict[str, str]:
    """Return the name and text of every file of a scene that has a duration.

    What the script is to find, and what the exact solution does, is the largest rotation over the
    critical one, or the slips [m] where nothing rocks.
    """
    use, script = engine.use(scene), script_of(engine, scene)
    environment = Environment(
        loader=PackageLoader("studies", "."), undefined=StrictUndefined, trim_blocks=True,
        keep_trailing_newline=True,
    )  # fmt: skip
    block = environment.get_template("export.py.jinja").render(
        engine=engine,
        preset=use.preset,
        scene=scene,
        system=scene.system,
        title=TITLES[type(scene.system)],
        script=script,
        moves=use.scene.frame == "world",
        dt_s=use.dt_s,
        expected=expected,
        exact=exact,
        version=project_version(),
        packages={name: version_of(name) for name in engine.packages},
        listed=listed,
        slow=SLIP_RATE * math.sqrt(scene.system.gravity * scene.system.width),
        short=LEAST_SLIP * scene.system.width,
    )
    rows = "".join(f"    {tuple(map(float, row))},\n" for row in scene.motion.segments())
    segments = f"SEGMENTS = (\n{rows})\n\nmean_velocity = mean_velocity_of(SEGMENTS)\n"
    shaking = f"{inspect.getsource(ground)}\n\n{segments}"
    return {"block.py": block, "ground.py": shaking, **script.files}
