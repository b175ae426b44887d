"""A job in a process of its own: how it is put to its source there, and what came of it."""

from collections.abc import Callable, Iterable
from concurrent.futures import CancelledError, Future
from contextlib import suppress
from dataclasses import replace
from typing import Any

from analytic.kernels.compiled import compile_all
from analytic.response import Reason, Response
from engines import ENGINES
from engines.run.look import compile_look
from studies.kit.jobs import Job, ask, short
from studies.kit.pool import MEMORY_BYTES, OvertimeError, Pool, StartError, TaskError
from studies.kit.refusing import one_line
from studies.sources.registry import Source

COMPILING_S = 1800.0
"""Nothing takes longer to compile [s]."""

_loaded: set[str] = set()
"""Sources whose kernels this process has loaded."""


def compile_ahead(
    pool: Pool, ask_: Callable[[Job, Source], Response], asked: Iterable[tuple[Job, Source]]
) -> None:
    """Compile what engines need on a machine, before any time limit holds.

    Parameters
    ----------
    pool : Pool
        One of its processes compiles; the others load what was compiled.
    ask_ : callable
        How a job is put to its source.
    asked : iterable of (Job, Source)
        A job of each source.
    """
    tasks: list[Future[Any]] = []
    for job, source in asked:
        if source.engine not in ENGINES or not source.declared.installed:
            continue
        if not tasks:
            tasks.append(pool.schedule(compile_look, (), COMPILING_S))
        if source.declared.compiles:
            tasks.append(pool.schedule(ask_apart, (ask_, short(job), source, True), COMPILING_S))
    for task in tasks:
        with suppress(Exception):  # the cases will say what is wrong
            task.result()


def ask_apart(
    ask_: Callable[[Job, Source], Response], job: Job, source: Source, many: bool
) -> Response:
    """Put a job to its source in a process of its own; one of a few need not be compiled.

    A job that is long is not asked twice: what loads the compiled kernels is a short one.
    """
    if many:
        compile_all()
        if source.kind != "engine" and job.source not in _loaded:
            _loaded.add(job.source)
            ask(short(job), source)
    response = ask_(job, source)
    if response.message.startswith(MemoryError.__name__):
        words = f"{response.message.rstrip(': ')}; a process may take {MEMORY_BYTES / 1e9:g} GB"
        return replace(response, message=words)
    return response


def outcome_of(task: Future[Response], time_limit_s: float) -> Response:
    """Return what came of a job in a process, its failure if that is to blame for it."""
    try:
        return task.result()
    except (CancelledError, StartError):
        raise
    except OvertimeError:
        words = f"no result within the time limit of {time_limit_s:g} s"
        return Response.failure(words, reason=Reason.UNDECIDED)
    except Exception as error:
        return Response.failure(str(error) if isinstance(error, TaskError) else one_line(error))
