"""A job in a process of its own: how it is put to its source there, and what came of it."""

import signal
from collections.abc import Callable, Iterable
from concurrent.futures import Future, TimeoutError
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from analytic.response import Reason, Response
from engines import ENGINES
from engines.look import compile_look
from studies.kit.jobs import Job, ask, one_line, short
from studies.kit.signals import left_to_this_process
from studies.sources.registry import Source

if TYPE_CHECKING:
    from pebble import ProcessPool

COMPILING_S = 1800.0
"""Nothing takes longer to compile [s]."""

_loaded: set[str] = set()
"""Sources whose kernels this process has loaded."""


def compile_ahead(
    pool: "ProcessPool",
    ask_: Callable[[Job, Source], Response],
    asked: Iterable[tuple[Job, Source]],
) -> None:
    """Compile what engines need on a machine, before any time limit holds.

    Parameters
    ----------
    pool : ProcessPool
        One of its processes compiles; the others load what was compiled.
    ask_ : callable
        How a job is put to its source.
    asked : iterable of (Job, Source)
        A job of each source.
    """
    tasks: list[Future[Any]] = []
    with left_to_this_process():
        for job, source in asked:
            if source.engine not in ENGINES or not source.declared.installed:
                continue
            if not tasks:
                tasks.append(pool.schedule(compile_look, timeout=COMPILING_S))
            if source.declared.compiles:
                order = (ask_, short(job), source)
                tasks.append(pool.schedule(ask_loaded, args=order, timeout=COMPILING_S))
    for task in tasks:
        with suppress(Exception):  # the cases will say what is wrong
            task.result()


def ask_loaded(ask_: Callable[[Job, Source], Response], job: Job, source: Source) -> Response:
    """Put a job to its source in a process of its own.

    A job that is long is not asked twice: what loads the compiled kernels is a short one.
    """
    if source.kind != "engine" and job.source not in _loaded:
        _loaded.add(job.source)
        ask(short(job), source)
    return ask_(job, source)


def outcome_of(result: Callable[[], Response], time_limit_s: float) -> Response:
    """Return the result of a process, or the failure as which it ended."""
    from pebble import ProcessExpired

    try:
        return result()
    except TimeoutError:
        words = f"no result within the time limit of {time_limit_s:g} s"
        return Response.failure(words, reason=Reason.UNDECIDED)
    except ProcessExpired as error:
        return Response.failure(_cause_of_death(error.exitcode))
    except BrokenProcessPool:
        # no case is to blame
        raise
    except Exception as error:
        return Response.failure(one_line(error))


def _cause_of_death(exitcode: int) -> str:
    if exitcode < 0:
        return f"the process was ended by signal {signal.Signals(-exitcode).name}"
    return f"the process ended by itself with exit code {exitcode}"
