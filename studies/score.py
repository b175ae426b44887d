"""One engine: what it predicts, at what price, where it fails, and what moved since a release."""

from __future__ import annotations

import functools
import math
import platform
import sys
from collections.abc import Mapping, Sequence
from contextlib import closing, suppress
from dataclasses import replace
from importlib.metadata import packages_distributions
from json import dumps, loads
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pandas as pd
from cyclopts import Parameter

from analytic import RigidBlock, SinePulse
from analytic.motion import FloatArray
from analytic.response import Outcome
from engines import ENGINES
from engines.declaration import AT_REST, Engine, Stepping
from engines.registry import OWN, UnloadableError, named
from engines.run.run import build
from engines.settings import perhaps
from engines.world import ContactPhase, Moment, Step, World
from studies import precision, scenes, stability, sweep
from studies.cases.refusal import BadInputError
from studies.kit import arguments
from studies.kit.arguments import Out, Place
from studies.kit.foreign import apart
from studies.kit.identity import version_of
from studies.kit.jobs import Job, Row, answer
from studies.kit.options import Running
from studies.kit.say import in_columns, one_line, out_of, part
from studies.kit.store import project_version
from studies.kit.study import Figures, Study, Tables
from studies.kit.tables import write_text
from studies.measures.costs import joint
from studies.measures.differences import summarize, with_reference
from studies.measures.presets import preset_of
from studies.measures.verdicts import Verdict
from studies.sources.registry import Source, announce, presets_of, resolve, scene_of

SWEEP, STEPS, EXTREMES, SCENES = (
    f"score-{name}" for name in ("sweep", "steps", "extremes", "scenes")
)
FURTHER = {"score-frame": "frame", "score-slide": "slide"}
"""Table -> its scene."""
SCHEMA = 1
"""Version of the form that `result_of` gives a result."""
NOISE = 1e-6
"""Relative change of a peak up to which two results are the same."""
CASE = ["figure", "pulse", "excess_g", "aspect", "width_m", "omega_over_p"]
"""Columns that make the name of one of the paper's cases."""
MEASURES = {
    "agree": "outcomes",
    "extreme": "extreme",
    "median_error": "median",
    "p90_error": "p90",
    "max_error": "max",
    "no_answer": "failed",
}
"""Column of a table -> what a result calls it."""
KNOWN = {
    SWEEP: ("peak_ratio",),
    STEPS: ("peak_ratio", "error"),
    EXTREMES: ("peak_ratio", "error", "energy_growth", "slip_widths"),
}
"""Columns that a table has though none of its numbers may be known."""
BLOCK = RigidBlock(width=0.5, height=1.5)
UNFELT = SinePulse(amplitude=1e-9, omega=6.2832)
"""What is checked of a world, on a base that stays where it is."""
DT_S, LEAN, RATE = 5e-3, 0.25 * BLOCK.alpha, 0.1 * BLOCK.alpha * BLOCK.p
"""Step [s], and rotation and rate to which a block is put."""
OFF = 0.47
"""Part of a step from which on a moment is another one: what takes 16 steps within a step has
less."""
TURNED = "the sign is wrong; theta is positive where it leans towards +x"


def uses_of(name: str) -> list[str]:
    """Return a source that names a preset, or all presets of an engine as sources."""
    return [name] if ":" in name else [f"{name}:{preset}" for preset in presets_of(resolve(name))]


def jobs(sources: Sequence[str], quick: bool) -> list[Job]:
    """Return the jobs of the tables; of an engine without a preset those of all that it has."""
    uses = [use for name in sources for use in uses_of(name)]
    swept = sweep.jobs(uses, quick, sweep.Options(figure=(6, 8) if quick else (6, 7, 8, 9)))
    if quick:  # every 11th case of a figure: that divides no panel's 40
        swept = [job for number, job in enumerate(swept) if number // len(uses) % 11 == 0]
    varied = [use for use in uses if preset_of(use) != AT_REST]
    along = [job for job in precision.jobs(varied, quick) if job.labels["table"] == precision.ALONG]
    known = FURTHER.values()
    tables = {
        SWEEP: swept,
        STEPS: along,
        EXTREMES: stability.matrix_jobs(uses, quick),
        SCENES: [job for job in scenes.jobs(uses, quick) if job.labels["scene"] in known],
    }
    return [
        replace(job, labels={"part": name, **job.labels})
        for name, of_table in tables.items()
        for job in of_table
    ]


def measure(job: Job) -> Row:
    """Return what a job's table has of it."""
    of = {SWEEP: answer, STEPS: precision.measure, EXTREMES: stability.measure}
    return {**of, SCENES: scenes.measure}[job.labels["part"]](job)


def tabulate(rows: pd.DataFrame) -> Tables:
    """Return the rows of each table, without the columns of others."""
    found: dict[str, pd.DataFrame] = {}
    for name, known in KNOWN.items():
        mine = rows[rows["part"] == name].drop(columns=["part", "table"], errors="ignore")
        found[name] = mine[[it for it in mine if it in known or mine[it].notna().any()]]
    tables = scenes.tabulate(rows[rows["part"] == SCENES].reindex(columns=[*{*rows, "scene"}]))
    for name, scene in FURTHER.items():
        if len(held := scenes.built(tables[scene])):
            found[name] = held
    whole = {"figure", "aspect", "runs", "impacts", "steps"}
    return {
        name: table.astype(dict.fromkeys(whole.intersection(table), int))
        for name, table in found.items()
    }


def swept(tables: Tables) -> pd.DataFrame:
    """Return the lines of all figures together, one for each preset."""
    return summarize(with_reference(tables[SWEEP]).assign(figure="all"))


def finding(tables: Tables) -> str:
    """Say what its best preset predicts."""
    lines = swept(tables).sort_values("max_error", ascending=False, kind="stable")
    best = lines.sort_values("agree", kind="stable").iloc[-1]
    return (
        f"{best['source']} predicts {out_of(best['agree'], best['cases'])} outcomes, and every "
        f"peak within {part(best['max_error'])}."
    )


def shown(tables: Tables) -> Tables:
    """Return its errors, its verdicts and failures."""
    extremes, along = tables[EXTREMES], precision.work_precision(tables[STEPS])
    return {
        "The paper's cases; errors of the peak are relative, over those that survive": (
            swept(tables).drop(columns=["figure", "max_difference"])
        ),
        "Along the step, on typical cases and near overturning together": joint(along),
        "Verdicts on extreme cases": stability.verdicts(extremes),
        "Failures in extreme cases": stability.failures(extremes)[stability.FAILURE],
        **{
            f"In the scene of a {scene}": scenes.tabulate(tables[name])[f"{scene}-summary"]
            for name, scene in FURTHER.items()
            if name in tables
        },
    }


def figures(tables: Tables) -> Figures:
    """Draw the errors of its presets over their run times, and the matrix of extreme cases."""
    from studies.drawing.precision import draw_precision
    from studies.drawing.stability import draw_matrix

    along = precision.work_precision(tables[STEPS])
    return {
        "score": draw_precision(along),
        "extremes": draw_matrix(tables[EXTREMES], "Extreme cases"),
    }


STUDY = Study(
    name="score",
    question="What does one engine predict, and did it get worse?",
    help="The paper's cases, errors along the step, extreme cases, slides and frames.",
    jobs=jobs,
    measure=measure,
    tabulate=tabulate,
    finding=finding,
    shown=shown,
    figures=figures,
    needed=lambda rows: [row for row in rows if row["part"] == SWEEP],
)


def command(
    engine: Annotated[str, Parameter(name="ENGINE")],
    /,
    *,
    out: Out = Path("score"),
    quick: bool = False,
    json: Place | None = None,
    against: Place | None = None,
    running: Running = Running(),  # noqa: B008
) -> int:
    """Score one engine: the paper's cases, errors along the step, extreme cases, slides and frames.

    A world that lacks a method, turns the wrong way round, or declares another `Moment` than the
    one at which its velocities hold is refused. With --against, the exit code is 0 whatever failed.

    Parameters
    ----------
    engine
        Its name, perhaps with one of its presets after a colon; or MODULE:ENGINE where its
        declaration stands, or MODULE:build of what builds its world, in this folder or among the
        installed packages.
    quick
        Every 11th case of two figures, every other step, fewer extremes: a minute or two.
    json
        File for the result.
    against
        Such a file of an earlier release, or of another environment: what moved since is said.
    """
    name = known(engine)
    declared = scored(name)
    # what cannot be compared with it is refused now, and not after the last run
    earlier = against and read(against, declared)
    if json:
        arguments.check_writable("--json", json)
    if declared.name not in OWN:
        with suppress(UnloadableError):  # its cases will say so
            if problem := apart(problem_of, name):
                raise BadInputError(f"ENGINE is {engine!r}: {problem}")
    code = STUDY.carry_out(out, jobs([name], quick), running, engine=name, quick=quick)
    result = result_of(STUDY.read(out), declared)
    if json:
        write_text(json, dumps(result, indent=1, ensure_ascii=False) + "\n")
    if earlier:
        print("\n" + since(earlier, result))
    return 0 if earlier else code


def known(engine: str) -> str:
    """Return an engine by its name, with its preset where that is named; make a place's known."""
    if engine.partition(":")[0] in ENGINES:
        with arguments.as_bad_input("ENGINE: "):
            scored(engine)
        return engine
    if ":" not in engine:
        words = f"{', '.join(ENGINES)}, ENGINE:PRESET, MODULE:ENGINE or MODULE:build"
        near = perhaps(engine, list(ENGINES))
        raise BadInputError(f"ENGINE is {engine!r}{near}; it must be one of {words}")
    sys.path.append(str(Path.cwd()))  # not first: what this process imports is found before it
    try:
        return announce(engine, functools.partial(apart, named))
    except ValueError as error:
        raise BadInputError(f"ENGINE: {error}") from error


def scored(source: str) -> Engine:
    """Return an engine, with one of its presets alone where that is named."""
    name, colon, preset = source.partition(":")
    engine = ENGINES[name]
    return replace(engine, presets=(engine.preset(preset),)) if colon else engine


def problem_of(engine: str) -> str:
    """Say in a line what the world of one of an engine's presets does wrong, if any does.

    What it raises is no matter of this: its cases will say so.
    """
    for use in uses_of(engine):
        with suppress(BaseException):
            if problem := _lacking(resolve(use)) or _wrong_motion(resolve(use)):
                return f"{problem} ({use})"
    return ""


def world_of(source: Source, start: tuple[float, float] = (0.0, 0.0)) -> World:
    """Build a block on a base that is not moved."""
    frame = "base" if "base" in source.declared.frames else None  # a base that moves is pulled, too
    step = DT_S * BLOCK.p
    scene = scene_of(BLOCK, UNFELT, source.preset, step=step, frame=frame, start=start)
    world: Any = build(source.declared.use(scene))
    return world  # type: ignore[no-any-return]


def _lacking(source: Source) -> str:
    """Say which method or moment a world lacks, or how its state has the wrong sign."""
    world = world_of(source, (LEAN, RATE))
    steps = source.used.stepping is not Stepping.OWN
    whole = ("state", "fault", "close", "step" if steps else "advance")
    for method in whole:
        if not callable(getattr(world, method, None)):
            return f"its world has no method {method}; it must have {', '.join(whole)}"
    if not isinstance(getattr(world, "moment", None), Moment):
        return "its world has no moment; it must be one of Moment.MIDDLE, END and NEXT"
    with closing(world):
        pose = np.asarray(world.state(), float)
    if pose.shape != (1, 4):
        return f"its state has the shape {pose.shape}; it must be (1, 4): x, z, theta, rate"
    for what, found, put in (("theta", pose[0, 2], LEAN), ("rate", pose[0, 3], RATE)):
        if abs(found + put) < 0.01 * put:
            return f"its state says {what} {found:.3g} of a block put to {put:.3g}: {TURNED}"
    return ""


def _wrong_motion(source: Source) -> str:
    """Say how a pulled block turns the wrong way round, or at which moment its velocities hold."""
    if source.used.stepping is Stepping.OWN:
        return ""
    if "base" in source.declared.frames:
        g, onset = BLOCK.gravity, BLOCK.gravity * math.tan(BLOCK.alpha)
        theta = pulled(source, [2.0 * onset] * 28, [-g] * 28, 1.0)[-1, 2]
        if theta < -1e-3:
            return f"pulled towards +x, its block turns to theta {theta:.3g}: {TURNED}"
    declared, measured = world_of(source).moment, measured_moment(source)
    if not abs(measured - declared.value) >= OFF:
        return ""
    nearest = min(Moment, key=lambda moment: abs(moment.value - measured))
    return (
        f"its velocities hold {measured - declared.value:+.2g} of a step from the "
        f"Moment.{declared.name} that its world declares; it must declare Moment.{nearest.name}"
    )


def measured_moment(source: Source) -> float:
    """Return the part of a step after which its velocity holds; nan if no pull moves a block so.

    A block in the air is pulled during one step: all of the velocity gained moves it within that
    step where the velocity is changed first, half where both go together, else none.
    """
    pull = 10.0 * BLOCK.gravity
    ups = [pull] * 4 + [0.0] * 24 + [-pull] + [0.0] * 4
    heights = pulled(source, [0.0] * len(ups), ups, 0.0)[:, 1]
    before, within, after = np.diff(heights)[[-6, -5, -1]]
    if not 0.5 < (before - after) / (pull * DT_S**2) < 2.0:
        return math.nan  # its cases will say so
    return float(Moment.NEXT.value - (within - before) / (after - before))


def pulled(source: Source, along: list[float], up: list[float], side: float) -> FloatArray:
    """Return the poses of a block that is pulled along and up its base [m/s2], step by step."""
    with closing(world_of(source)) as world:
        poses = [np.array(world.state(), float)[0]]
        for number, (x, z) in enumerate(zip(along, up, strict=True), start=1):
            phase = ContactPhase.SWING, side
            world.step(Step(DT_S, number * DT_S, DT_S, x, z, 0.0, 0.0, 0.0, *phase))
            poses.append(np.array(world.state(), float)[0])
    return np.array(poses)


def result_of(tables: Tables, engine: Engine) -> dict[str, Any]:
    """Return the result of tables, as JSON knows it; an error is None where no peak survives."""
    cases, extremes = tables[SWEEP], tables[EXTREMES]
    names = ["/".join(map(str, case)) for case in cases[CASE].itertuples(index=False)]
    rows = pd.concat(
        [cases.assign(case=names), extremes.assign(case="extreme/" + extremes["case"])]
    )
    rocked = (rows["outcome"] == Outcome.ROCKED.value) & np.isfinite(rows["peak_ratio"])
    rows["peak"] = rows["peak_ratio"].astype(object).where(rocked, rows["outcome"])
    valid = extremes[extremes["verdict"] != Verdict.INVALID.value]
    good = (valid["verdict"] == Verdict.GOOD.value).groupby(valid["source"])
    lines = swept(tables).set_index("source").join(good.agg(extreme="sum", extremes="count"))
    lines = lines[["cases", "extremes", *MEASURES]].rename(columns=MEASURES, index=preset_of)
    lines = lines.astype(object).where(lines.notna(), None)
    packages = engine.packages or packages_distributions().get(engine.library, ())
    versions = {"rocking": project_version(), "python": platform.python_version()}
    return {
        "schema": SCHEMA,
        "engine": engine.name,
        "versions": versions | {name: version_of(name) for name in packages},
        "presets": lines.to_dict("index"),
        "peaks": {
            preset_of(str(source)): dict(zip(group["case"], group["peak"], strict=True))
            for source, group in rows.groupby("source", sort=False)
        },
    }


def read(path: Path, engine: Engine) -> dict[str, Any]:
    """Read an engine's result back as --json wrote it; BadInputError if it is none."""
    try:
        if not path.is_file():  # a pipe would be waited for
            raise OSError("it is no file")
        found = loads(path.read_text(encoding="utf-8"))
        if found["schema"] != SCHEMA or found["engine"] != engine.name:
            raise ValueError(f"its schema is {found['schema']}, its engine {found['engine']}")
        parts = (*found["peaks"].values(), found["versions"])
        values = [value for part in parts for value in part.values()]
        if not all(isinstance(value, float | str) for value in values):
            raise ValueError("it holds something else")
    except (OSError, ValueError, LookupError, TypeError, AttributeError, RecursionError) as error:
        raise BadInputError(
            f"--against is {str(path)!r}; it must be what --json wrote of {engine.name} by schema "
            f"{SCHEMA} ({one_line(error)})"
        ) from error
    return dict(found)


def since(then: Mapping[str, Any], now: Mapping[str, Any]) -> str:
    """Say what moved between two results, of the answers in both; below, which did."""
    answers = [pd.DataFrame(result["peaks"]).unstack().dropna() for result in (then, now)]
    both = pd.concat(answers, axis=1, join="inner", keys=["then", "now"])
    table = both.rename_axis(["preset", "case"]).reset_index()
    before, after = (pd.to_numeric(table[name], errors="coerce") for name in ("then", "now"))
    table["change"] = after / before - 1.0
    other = table[table["change"].isna() & (table["then"] != table["now"])]
    moved = table[table["change"].abs() > NOISE].sort_values("change", key=abs, ascending=False)
    versions = ", ".join(f"{name} {version}" for name, version in then["versions"].items())
    said = (
        f"Since {versions}, {len(other)} of {len(table)} answers have another outcome, and "
        f"{len(moved)} peaks moved by more than {NOISE:g} of themselves."
    )
    parts = [other.drop(columns="change"), moved]
    return "\n\n".join([said, *(in_columns(part) for part in parts if len(part))])
