"""What a worker of a cluster does: it says whether it is fit, and does to a job what Local would.

Models and solvers run in the worker's own process, engines and long solves in a process of their
own, so that a crash or the time limit is a failed row and costs no worker.
"""

import asyncio
import multiprocessing
import platform
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import CancelledError
from functools import cache
from typing import TYPE_CHECKING

from analytic.kernels.compiled import compile_all
from analytic.response import Response
from engines.registry import OWN
from studies.kit import provenance
from studies.kit.fingerprint import everything
from studies.kit.jobs import Job
from studies.kit.pool import Pool
from studies.kit.processes import ask_apart, compile_ahead, outcome_of
from studies.kit.together import ask_together
from studies.sources.registry import Source

if TYPE_CHECKING:
    from distributed import Worker

START = "dask worker ADDRESS --no-nanny --nthreads 1"


class RefusedError(Exception):
    """Raised on a worker that must not run a job."""


@cache
def fitness() -> dict[str, str]:
    """Return what must be the same on a worker for its results to be the same.

    The code is all of it: a worker that is another version is not asked which it knows.
    An engine of another package travels with its job.
    """
    packages = (*provenance.engine_packages(OWN), *provenance.NUMERICAL_PACKAGES)
    return {
        "code": everything(),
        "python": platform.python_version(),
        **{name: provenance.version_of(name) for name in packages},
    }


def unfit(expected: dict[str, str]) -> str:
    """Say why this worker must not run jobs; an empty string if it may."""
    here = fitness()
    different = [
        f"{name} {here.get(name)} there, {value} here"
        for name, value in expected.items()
        if here.get(name) != value
    ]
    if different:
        return "; ".join(different)
    if multiprocessing.current_process().daemon:
        return f"it has a nanny, under which no engine can have its own process; use {START}"
    return ""


def work(
    expected: dict[str, str],
    job: Job,
    source: Source,
    ask: Callable[[Job, Source], Response],
    time_limit_s: float,
) -> Response:
    """Run a job on this worker.

    Raises
    ------
    RefusedError
        If this worker is not fit.
    """
    _refuse_unless_fit(expected)
    compile_all()
    if job.needs_process(source):
        return _work_in_process(job, source, ask, time_limit_s)
    if job.source not in _loaded:
        # loading the compiled kernels is no part of the first case's run time
        _loaded.add(job.source)
        ask(job, source)
    return ask(job, source)


def work_together(
    expected: dict[str, str], jobs: Sequence[Job], time_limit_s: float
) -> list[Response]:
    """Run the jobs of a batch on this worker, at once.

    Raises
    ------
    RefusedError
        If this worker is not fit.
    studies.kit.pool.TaskError
        If the batch has no answer.
    """
    from distributed import Reschedule, get_worker

    _refuse_unless_fit(expected)
    pool = _processes_of(get_worker())
    try:
        task = pool.schedule(ask_together, (jobs,), time_limit_s * len(jobs))
        return list(task.result())
    except CancelledError:  # this worker is closing
        raise Reschedule from None


def _refuse_unless_fit(expected: dict[str, str]) -> None:
    if problem := unfit(expected):
        raise RefusedError(f"a worker cannot be used: {problem}")


def _work_in_process(
    job: Job, source: Source, ask: Callable[[Job, Source], Response], time_limit_s: float
) -> Response:
    from distributed import Reschedule, get_worker

    try:
        with _compiling:  # a case of another thread's waits for what it needs, too
            pool = _processes_of(get_worker())
            if job.source not in _compiled:
                compile_ahead(pool, ask, [(job, source)])
                _compiled.add(job.source)
        task = pool.schedule(ask_apart, (ask, job, source, True), time_limit_s)
        return outcome_of(task, time_limit_s)
    except CancelledError:  # this worker is closing
        raise Reschedule from None


_loaded: set[str] = set()
_compiled: set[str] = set()
_compiling = threading.Lock()


@cache
def _processes_of(worker: "Worker") -> Pool:
    """Return a worker's processes, one for each of its threads; they end when it closes."""
    from distributed import WorkerPlugin

    pool = Pool(worker.state.nthreads)

    class Ending(WorkerPlugin):
        async def teardown(self, worker: "Worker") -> None:
            await asyncio.to_thread(pool.stop)

    worker.loop.add_callback(worker.plugin_add, Ending(), name="rocking")
    return pool
