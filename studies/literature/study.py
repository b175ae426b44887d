"""Printed numbers against the models and the engines: who printed what, and does it come out?"""

from typing import Annotated

from studies.kit.arguments import Out, check_sources
from studies.kit.jobs import Job
from studies.kit.naming import several_engines
from studies.kit.options import DEFAULT_RUNNING, Running
from studies.kit.plan import Plan, carry_out
from studies.literature import STUDY
from studies.literature.prints import PROBLEMS
from studies.literature.problems import Drop, ModeEnd, OrbitLimit, Problem, Restitution
from studies.literature.readings import reduce, solve_problem, times_of
from studies.literature.report import headline, pictures, report
from studies.sources.groups import core_sources
from studies.sources.registry import resolve

__all__ = ["command", "headline", "pictures", "report"]

DEFAULT_SOURCES = core_sources()
AFTER_A_RELEASE = 3.0
"""Time, in units of 1/p, in which a released block strikes its base, and is seen to rise again."""


def command(
    *,
    out: Out,
    sources: Annotated[tuple[str, ...], several_engines] = DEFAULT_SOURCES,
    running: Running = DEFAULT_RUNNING,
) -> int:
    """Hold printed numbers against the models that they are about, and the engines beside.

    An engine joins where the printed block has ideally inelastic impacts, as the engine's has, and
    the print is a threshold.

    Parameters
    ----------
    sources
        Engines, beside the printed model and the exact one.
    """
    check_sources(sources)
    jobs = [
        literature_job(problem, source)
        for problem in PROBLEMS
        for source in dict.fromkeys((problem.model, "exact", *sources))
        if can_answer(problem, source)
    ]
    plan = Plan(jobs=jobs, growing={"source": _asked(jobs)}, ask=solve_problem, reduce=reduce)
    return carry_out(STUDY, plan, out, running, report)


def _asked(jobs: list[Job]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(job.source for job in jobs))


def can_answer(problem: Problem, source: str) -> bool:
    """Tell whether a source can be asked for a problem's quantity."""
    kind = resolve(source).kind
    if isinstance(problem, ModeEnd):
        return kind == "model"
    if isinstance(problem, OrbitLimit | Drop) and kind != "engine":
        return source == problem.model
    if isinstance(problem, OrbitLimit):
        return False
    return kind != "engine" or problem.ideal


def literature_job(problem: Problem, source: str) -> Job:
    """Return the job that puts a problem to a source."""
    options: dict[str, object] = {"start": problem.start} if problem.start != (0.0, 0.0) else {}
    if problem.friction is not None and resolve(source).kind == "engine":
        options["friction"] = problem.friction
    return Job(
        labels={"problem": problem.name, "model": problem.model},
        block=problem.block,
        motion=problem.pulse,
        source=source,
        duration=_observed(problem),
        times=times_of(problem),
        options=options,
    )


def _observed(problem: Problem) -> float | None:
    """Return until when [s] a source is watched; None where its peak and outcome are enough."""
    if isinstance(problem, Drop | Restitution):
        return AFTER_A_RELEASE / problem.block.p
    return problem.pulse.duration if times_of(problem) is not None else None
