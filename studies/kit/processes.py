"""A job in a process of its own: how it is put to its source there, and what came of it."""

import signal
from collections.abc import Callable
from concurrent.futures import TimeoutError
from concurrent.futures.process import BrokenProcessPool

from analytic.response import Reason, Response
from studies.kit.jobs import Job, ask, one_line, short
from studies.sources.registry import Source

_loaded: set[str] = set()
"""Sources whose kernels this process has loaded."""


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
