"""One engine: what it predicts, at what price, where it fails, and what moved since a release."""

from __future__ import annotations

import functools
import math
import sys
from collections.abc import Sequence
from contextlib import closing, suppress
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import numpy as np
import pandas as pd
from cyclopts import Parameter

from analytic import RigidBlock, Still
from analytic.motion import FloatArray
from analytic.start import REST
from engines import ENGINES
from engines.declaration import AT_REST, Stepping
from engines.registry import OWN, UnloadableError, named
from engines.run.run import build
from engines.settings import perhaps
from engines.world import ContactPhase, Moment, Step
from studies import precision, scenes, stability, sweep
from studies.cases.refusal import BadInputError
from studies.kit import arguments
from studies.kit.arguments import Out, Place
from studies.kit.foreign import apart
from studies.kit.jobs import Job, Row, answer
from studies.kit.options import Running
from studies.kit.say import in_columns, out_of, part
from studies.kit.store import FolderError, check, engines_of, provenance_of
from studies.kit.study import Figures, Study, Tables
from studies.measures.costs import joint
from studies.measures.differences import summarize, with_reference
from studies.measures.presets import engine_of, preset_of
from studies.sources.registry import Source, announce, presets_of, resolve, scene_of

SWEEP, STEPS, EXTREMES, SCENES = (
    f"score-{name}" for name in ("sweep", "steps", "extremes", "scenes")
)
FURTHER = {"score-frame": "frame", "score-slide": "slide"}
"""Table -> its scene."""
NOISE = 1e-6
"""Relative change of a peak up to which two results are the same."""
CASE = ["figure", "pulse", "excess_g", "aspect", "width_m", "omega_over_p"]
"""Columns that make the name of one of the paper's cases."""
KNOWN = {
    SWEEP: ("peak_ratio",),
    STEPS: ("peak_ratio", "error"),
    EXTREMES: ("peak_ratio", "error", "energy_growth", "slip_widths"),
}
"""Columns that a table has though none of its numbers may be known."""
BLOCK = RigidBlock(width=0.5, height=1.5)
DT_S, LEAN, RATE = 5e-3, 0.25 * BLOCK.alpha, 0.1 * BLOCK.alpha * BLOCK.p
"""What is checked of a world: steps [s], and rotation and rate to which a block is put."""
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
    """Draw the errors of its presets over their run times, and their scores in extreme cases."""
    from studies.drawing.precision import draw_precision
    from studies.drawing.stability import draw_scores

    along = precision.work_precision(tables[STEPS])
    answered = (along["wall_s"] > 0.0).any()
    asked = (stability.scores(tables[EXTREMES], each) for each in ("engine", "case"))
    return {
        **({"score": draw_precision(along)} if answered else {}),
        "extremes": draw_scores("Extreme cases", *asked),
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
    against: Place | None = None,
    running: Running = Running(),  # noqa: B008
) -> int:
    """Score one engine: the paper's cases, errors along the step, extreme cases, slides and frames.

    A world that turns the wrong way round, or declares another `Moment` than the one at which its
    velocities hold, is refused. With --against, the exit code is 0 whatever failed.

    Parameters
    ----------
    engine
        Its name, perhaps with one of its presets after a colon; or MODULE:ENGINE where its
        declaration stands, or MODULE:build of what builds its world, in this folder or among the
        installed packages.
    quick
        Every 11th case of two figures, every other step, fewer extremes: a minute or two.
    against
        Results of the same engine, of an earlier release or another environment: what moved since
        is said.
    """
    name = known(engine)
    # what cannot be compared with it is refused now, and not after the last run
    earlier = None if against is None else read(against, engine_of(name))
    if engine_of(name) not in OWN:
        with suppress(UnloadableError):  # its cases will say so
            if problem := apart(problem_of, name):
                raise BadInputError(f"ENGINE is {engine!r}: {problem}")
    code = STUDY.carry_out(out, jobs([name], quick), running, engine=name, quick=quick)
    if earlier is None:
        return code
    versions, then = earlier
    print(f"\nSince {versions}, {since(then, STUDY.read(out))}")
    return 0


def known(engine: str) -> str:
    """Return an engine by its name, with its preset where that is named; make a place's known."""
    name, colon, preset = engine.partition(":")
    if name in ENGINES:
        with arguments.as_bad_input("ENGINE: "):
            ENGINES[name].preset(preset if colon else None)
        return engine
    if not colon:
        words = f"{', '.join(ENGINES)}, ENGINE:PRESET, MODULE:ENGINE or MODULE:build"
        near = perhaps(engine, list(ENGINES))
        raise BadInputError(f"ENGINE is {engine!r}{near}; it must be one of {words}")
    sys.path.append(str(Path.cwd()))  # not first: what this process imports is found before it
    try:
        return announce(engine, functools.partial(apart, named))
    except ValueError as error:
        raise BadInputError(f"ENGINE: {error}") from error


def problem_of(engine: str) -> str:
    """Say in a line what the world of one of an engine's presets does wrong, if any does.

    What it lacks or raises is no matter of this: its cases will say so.
    """
    for use in uses_of(engine):
        with suppress(BaseException):
            if problem := _problem(resolve(use)):
                return f"{problem} ({use})"
    return ""


def _problem(source: Source) -> str:
    _, (put,) = moved(source, start=(LEAN, RATE))
    if min(put[2:]) < 0.0:
        told = f"put to theta {LEAN:.3g} and rate {RATE:.3g}, its state says {{:.3g}} and {{:.3g}}"
        return f"{told.format(*put[2:])}: {TURNED}"
    if source.used.stepping is Stepping.OWN:
        return ""
    if "base" in source.declared.frames:
        onset = BLOCK.gravity * math.tan(BLOCK.alpha)
        theta = moved(source, [(2.0 * onset, -BLOCK.gravity)] * 28)[1][-1, 2]
        if theta < -1e-3:
            return f"pulled towards +x, its block turns to theta {theta:.3g}: {TURNED}"
    if abs(late := lateness(source)) >= OFF:
        return f"its velocities hold {late:+.2g} of a step after the Moment that its world declares"
    return ""


def lateness(source: Source) -> float:
    """Return by which part of a step velocities hold later than a world declares.

    A block in the air is pulled during one step: all of the velocity gained moves it within that
    step where the velocity is changed first, half where both go together, else none. It is nan if
    no pull moves a block so.
    """
    pull = 10.0 * BLOCK.gravity
    ups = [pull] * 4 + [0.0] * 24 + [-pull] + [0.0] * 4
    moment, poses = moved(source, [(0.0, up) for up in ups])
    before, within, after = np.diff(poses[:, 1])[[-6, -5, -1]]
    if not 0.5 < (before - after) / (pull * DT_S**2) < 2.0:
        return math.nan
    return float(Moment.NEXT.value - (within - before) / (after - before) - moment.value)


def moved(
    source: Source, pulls: Sequence[tuple[float, float]] = (), start: tuple[float, float] = REST
) -> tuple[Moment, FloatArray]:
    """Return a world's moment, and the poses of a block that is pulled along and up [m/s2]."""
    frame = "base" if "base" in source.declared.frames else None  # a base that moves is pulled, too
    step_of = {"step": DT_S * BLOCK.p, "frame": frame, "start": start}
    scene = scene_of(BLOCK, Still(), source.preset, **step_of)
    with closing(build(source.declared.use(scene))) as world:
        poses = [np.array(world.state(), float)[0]]
        for number, (x, z) in enumerate(pulls, start=1):
            pull = (x, z, 0.0, 0.0, 0.0)
            world.step(Step(DT_S, number * DT_S, DT_S, *pull, ContactPhase.SWING, 0.0))
            poses.append(np.array(world.state(), float)[0])
        return world.moment, np.array(poses)


def read(folder: Path, engine: str) -> tuple[str, Tables]:
    """Read an engine's earlier results, and with which versions they were made."""
    check(folder, [f"{SWEEP}.csv", f"{EXTREMES}.csv"], "--against")
    tables, record = STUDY.read(folder), provenance_of(folder)
    held = [engine_of(name) for name in tables.get(SWEEP, pd.DataFrame({"source": []}))["source"]]
    if set(held) != {engine} or EXTREMES not in tables:
        raise FolderError(folder, f"it must hold what scoring {engine} wrote", "--against")
    known = {"rocking": record["version"], **engines_of(record)}
    packages = ("rocking", *ENGINES[engine].packages)
    return ", ".join(f"{name} {known[name]}" for name in packages if name in known), tables


def answers(tables: Tables) -> pd.DataFrame:
    """Return the outcome and the peak of each source and case."""
    cases = tables[SWEEP]
    cases = cases.assign(case=cases[CASE].astype(str).agg("/".join, axis=1))
    both = pd.concat([cases, tables[EXTREMES]])
    return both[["source", "case", "outcome", "peak_ratio"]]


def since(then: Tables, now: Tables) -> str:
    """Say what moved between two results, of the answers in both; below, which did."""
    ends = ("_then", "_now")
    table = answers(then).merge(answers(now), on=["source", "case"], suffixes=ends)
    table["change"] = table["peak_ratio_now"] / table["peak_ratio_then"] - 1.0
    same = table["outcome_then"] == table["outcome_now"]
    moved = table[same & (table["change"].abs() > NOISE)]
    moved = moved.sort_values("change", key=abs, ascending=False)
    said = (
        f"{(~same).sum()} of {len(table)} answers have another outcome, and {len(moved)} peaks "
        f"moved by more than {NOISE:g} of themselves."
    )
    parts = [
        table.loc[~same, ["source", "case", "outcome_then", "outcome_now"]],
        moved[["source", "case", "peak_ratio_then", "peak_ratio_now", "change"]],
    ]
    return "\n\n".join([said, *(in_columns(part) for part in parts if len(part))])
