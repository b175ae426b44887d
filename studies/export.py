"""A scene written out for an engine alone: files, and the peak to expect of them."""

import inspect
import math
from contextlib import ExitStack
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from analytic import Outcome, RigidBlock, RockingFrame, SlidingBlock
from engines import ENGINES
from engines.declaration import Stepping, Use
from engines.run import ground, slide, steps
from engines.settings import perhaps
from studies.cases.refusal import BadInputError
from studies.kit import identity, say, store, tables
from studies.kit.arguments import Computing, Place, Step, TimeLimit, Yours, refuse_both
from studies.kit.jobs import Job, Question
from studies.kit.run import exit_code, place_of, run, with_response
from studies.kit.scene_options import Excitation, Height, Standing, Width, window_of
from studies.sources.registry import scene_of

TITLES = {RigidBlock: "rocking block", RockingFrame: "rocking frame", SlidingBlock: "sliding block"}


def command(
    *,
    engine: str,
    out: Place,
    width: Width,
    height: Height,
    excitation: Excitation = Excitation(),  # noqa: B008
    standing: Standing = Standing(),  # noqa: B008
    p_dt: Step | None = None,
    yours: Yours = Yours(),  # noqa: B008
    time_limit: TimeLimit = 60.0,
) -> int:
    """Write a scene as a script that needs only an engine's library, with its expected result.

    The folder holds a Python script, the ground motion and, if the library has a format for it, the
    model. The script checks that its peak is the one that this project computes.

    Parameters
    ----------
    engine
        Name of an engine, and after a colon a preset with equal steps; by default tuned.
    out
        New or empty folder for block.py, ground.py and, if the library reads one, the model.
    p_dt
        Step in units of 1/p; by default the preset's.
    time_limit
        Wall-clock time [s] after which the engine is given up.
    """
    refuse_both(dt=yours.dt, p_dt=p_dt)
    source = source_of(engine)
    system = standing.system(width, height, yours.friction)
    motion, start = excitation.pose(system)
    if out.exists() and any(out.iterdir()):
        raise BadInputError(f"--out is {str(out)!r}; it must be a new or an empty folder")
    window = window_of(system, motion, p_dt=p_dt, dt=yours.dt)
    case = Question(system=system, motion=motion, start=start, duration=window)
    options = yours.options([source], system)[source] | ({} if p_dt is None else {"step": p_dt})
    name, _, preset = source.partition(":")
    scene = scene_of(system, motion, preset, start=start, duration=window, **options)
    questions = {"exact": {}, source: options}
    jobs = [Job(labels={}, case=case, source=each, options=of) for each, of in questions.items()]
    place = place_of(Computing(jobs=1, time_limit=time_limit), at_once=True)
    rows = run(jobs, with_response, place)
    if code := exit_code(rows):
        return code
    answers = [row["response"] for row in rows]
    slides = isinstance(system, SlidingBlock)
    exact, found = (each.slips if slides else each.peak_ratio for each in answers)
    if answers[-1].outcome is Outcome.AT_REST:
        words = "an exported scene must move there, and stays at rest"
        raise BadInputError(f"--engine is {engine!r}; {words}")
    use = ENGINES[name].use(scene)
    texts = files(use, found, exact)
    out.mkdir(parents=True, exist_ok=True)
    with ExitStack() as places:  # the script takes its place when all others have theirs
        for file, text in texts.items():
            places.enter_context(tables.draft(out / file)).write_bytes(text.encode())
    print(*(out / file for file in texts), sep="\n")
    if isinstance(found, tuple):
        slips = (" ".join(f"{slip:.12g}" for slip in each) for each in (found, exact))
        print("slips to expect: {} m; exact {} m".format(*slips))
    else:
        print(f"largest rotation to expect: {found:.12g} of the critical one; exact {exact:.12g}")
    return 0


def source_of(engine: str) -> str:
    """Return an engine with its preset, which must be ones that can be written out."""
    name, colon, preset = engine.partition(":")
    able = [name for name, engine in ENGINES.items() if engine.script is not None]
    if name not in able:
        words = f"it must be one that can be written out: {', '.join(able)}"
        raise BadInputError(f"--engine is {engine!r}{perhaps(name, able)}; {words}")
    equal = [use.name for use in ENGINES[name].presets if use.stepping is Stepping.FIXED]
    if colon and preset not in equal:
        words = f"its preset must have equal steps: {', '.join(equal)}"
        raise BadInputError(f"--engine is {engine!r}; {words}")
    return engine if colon else f"{name}:tuned"


def files(use: Use, expected: Any, exact: Any) -> dict[str, str]:
    """Return the name and text of every file of a scene that has a duration."""
    assert use.engine.script is not None  # `source_of` refuses what cannot be written out
    scene, script = use.scene, use.engine.script(use.scene, use.settings, use.dt_s)
    environment = Environment(
        loader=PackageLoader("studies", "."), undefined=StrictUndefined, trim_blocks=True,
        keep_trailing_newline=True,
    )  # fmt: skip
    block = environment.get_template("export.py.jinja").render(
        use=use,
        scene=scene,
        system=scene.system,
        title=TITLES[type(scene.system)],
        script=script,
        expected=expected,
        exact=exact,
        version=store.project_version(),
        packages={name: identity.version_of(name) for name in use.engine.packages},
        listed=say.listed,
        begin=steps.begin_of(scene, use.dt_s),
        slow=slide.SLIP_RATE * math.sqrt(scene.system.gravity * scene.system.width),
        short=slide.LEAST_SLIP * scene.system.width,
    )
    shaking = inspect.getsource(ground) + segments("SEGMENTS", scene.shaking, "mean_velocity")
    if scene.heaves:
        shaking += segments("UPWARDS", scene.heaving, "mean_rise")
    return {"block.py": block, "ground.py": shaking, **script.files}


def segments(name: str, each: list[list[float]], mean: str) -> str:
    """Return lines that name the segments of a motion, and its mean velocity."""
    rows = "".join(f"    {tuple(map(float, row))},\n" for row in each)
    return f"\n\n{name} = (\n{rows})\n\n{mean} = mean_velocity_of({name})\n"
