"""One engine, put to what the sweep, the study of precision and that of stability ask."""

import functools
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from json import dumps
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from analytic.response import Response
from engines import ENGINES, Scene
from engines.registry import OWN, UnloadableError, named
from engines.scene import perhaps
from studies.old.arguments import (
    BadInputError,
    Out,
    Place,
    as_bad_input,
    check_writable,
    refuse_repeats,
    several_or_none,
)
from studies.old.foreign import apart
from studies.old.jobs import Job, summary
from studies.old.jobs import ask as plain
from studies.old.journal import Row
from studies.old.options import DEFAULT_RUNNING, Running
from studies.old.plan import Plan, by_label, carry_out
from studies.old.provenance import write_text
from studies.measures.verdicts import BANDS
from studies.precision import study as precision
from studies.scenes import cases as scenes
from studies.scenes import frames
from studies.scenes.study import reduce as reduce_scene
from studies.score import STUDY
from studies.score.moments import accusation, ask_for_moment, reduced
from studies.score.release import BLOCK, UNFELT, problem_of, suspicion
from studies.score.report import finding, published, report, scored, table_of
from studies.score.result import read, required, result_of, since
from studies.sources.registry import DEFAULT_EFFORT, SOURCES, Source, announce, presets_of
from studies.stability import study as stability
from studies.stability.remedies import answer
from studies.sweep.study import sweep_jobs

__all__ = ["command", "finding", "report"]

FIGURES, QUICK_FIGURES = (6, 7, 8, 9), (6, 8)
QUICK_EVERY = 11
"""Of the cases of a figure a quick score asks every so-manieth; no divisor of a panel's 40."""
SWEEP, STEPS, EXTREMES = "score-sweep", "score-steps", "score-extremes"
MOMENTS = "score-moments"
"""The tables of one block."""

BEYOND: dict[str, Callable[[Sequence[str], bool], Iterator[Job]]] = {
    "score-frame": frames.usual,
    "score-slide": scenes.slides,
}
"""Tables of further scenes, each with what yields its jobs."""


def command(
    engine: Annotated[str, Parameter(name="ENGINE")],
    /,
    *,
    out: Out = Path("score"),
    quick: bool = False,
    require: Annotated[tuple[str, ...] | None, several_or_none] = None,
    json: Place | None = None,
    against: Place | None = None,
    running: Running = DEFAULT_RUNNING,
) -> int:
    """Score one engine.

    Parameters
    ----------
    engine
        Its name, perhaps with one of its presets after a colon; or MODULE:ENGINE where its
        declaration stands, or MODULE:build of what builds its world, in this folder or among the
        installed packages.
    quick
        Every 11th case of two figures, every other step, fewer extremes: a minute or two.
    require
        outcomes=N: at least so many right; median=E, p90=E, max=E: largest relative error of the
        peak; failed=N: at most so many without an answer; extreme=N: at least so many extreme cases
        right. Of the best preset, or as in fixed:p90=1e-3.
    json
        File for the result.
    against
        Such a file of an earlier release: what moved since is said.
    """
    name = known(engine)
    declared = scored(name)
    # what cannot be held against it is refused now, and not after the last run
    requirements = [required(text, declared) for text in require or ()]
    if require is not None:
        refuse_repeats("--require", [f"{each.preset}:{each.measure}" for each in requirements])
    earlier = against and read(against, declared)
    published()
    if json:
        check_writable("--json", json)
    if declared.name not in OWN:
        refuse_what_is_no_world(engine, f"{declared.name}:{declared.best.name}")
    code = carry_out(STUDY, plan(name, quick, running.time_limit), out, running, report)
    result = result_of(out, declared)
    if json:
        write_text(json, dumps(result, indent=1, ensure_ascii=False) + "\n")
    if earlier:
        print("\n" + since(earlier, result))
    judged = [requirement.judged(result) for requirement in requirements]
    for _, line in judged:
        print(line)
    if earlier or judged:
        code = int(not all(holds for holds, _ in judged))
    moments = table_of(out, "moments")
    return code or int(bool(accusation(moments) or suspicion(moments)))


def known(engine: str) -> str:
    """Return an engine by its name, with its preset where that is named; make a place's known.

    Raises
    ------
    BadInputError
        If there is none.
    """
    if engine.partition(":")[0] in ENGINES:
        with as_bad_input("ENGINE: "):
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


def refuse_what_is_no_world(place: str, source: str) -> None:
    """Refuse an engine whose world lacks a method, or is read the wrong way round."""
    with suppress(UnloadableError):  # its cases will say so
        if problem := apart(problem_of, source):
            raise BadInputError(f"ENGINE is {place!r}: {problem}")


def plan(name: str, quick: bool, time_limit_s: float) -> Plan:
    """Return the plan of the tables."""
    return Plan(
        jobs=score_jobs(name, quick),
        settings={"engine": name, "quick": quick, "bands": BANDS},
        ask=functools.partial(ask_of_table, quick=quick, time_limit_s=time_limit_s),
        reduce=reduce,
        tabulate=by_label("table"),
        needed=lambda rows: [row for row in rows if row["table"] == SWEEP],
    )


def score_jobs(name: str, quick: bool) -> list[Job]:
    """Return the jobs of the tables, preset by preset; those of further scenes where it can."""
    name, _, preset = name.partition(":")
    uses = [f"{name}:{each}" for each in ([preset] if preset else presets_of(SOURCES[name]))]
    swept = sweep_jobs(QUICK_FIGURES if quick else FIGURES, uses, DEFAULT_EFFORT)
    if quick:
        swept = [job for number, job in enumerate(swept) if number // len(uses) % QUICK_EVERY == 0]
    along = [job for job in precision.precision_jobs(quick, [name]) if job.source in uses]
    extreme = stability.matrix_jobs(uses, quick)
    beyond = [job for table, of in BEYOND.items() for job in _in(table, held(of(uses, quick)))]
    flights = [Job(labels={}, block=BLOCK, motion=UNFELT, source=use) for use in uses]
    return [
        *_in(SWEEP, swept),
        *_in(STEPS, along),
        *_in(EXTREMES, extreme),
        *_in(MOMENTS, flights),
        *beyond,
    ]


def held(jobs: Iterable[Job]) -> list[Job]:
    """Return the jobs of scenes that their engines hold."""
    return [
        job
        for job in jobs
        if not job.asked.declared.lacks(
            Scene(system=job.block, motion=job.motion, preset=job.asked.preset), job.asked.used
        )
    ]


def _in(table: str, jobs: Iterable[Job]) -> list[Job]:
    return [replace(job, labels={**job.labels, "table": table}) for job in jobs]


def ask_of_table(job: Job, source: Source, *, quick: bool, time_limit_s: float) -> Response:
    """Put a job of any of the tables to its source."""
    if job.labels["table"] == MOMENTS:
        return ask_for_moment(job, source)
    if job.labels["table"] == STEPS:
        budget_s = precision.QUICK_BUDGET_S if quick else precision.BUDGET_S
        return precision.measure(job, source, budget_s=budget_s)
    if job.labels["table"] == EXTREMES:
        return answer(stability.case_of(job), job, source, time_limit_s)
    return plain(job, source)


def reduce(job: Job, response: Response) -> Row:
    """Return the columns that follow the labels of a job's table."""
    if job.labels["table"] == MOMENTS:
        return reduced(response)
    if job.labels["table"] == STEPS:
        return precision.reduce(job, response)
    if job.labels["table"] in BEYOND:
        return reduce_scene(job, response)
    row = summary(job, response)
    if job.labels["table"] == EXTREMES:
        row |= stability.judged(stability.case_of(job), job.source, response)
    return row
