"""A Dask cluster as the place where jobs are run; Dask is imported only when one is named.

A worker does to a job what this machine would: models and solvers in its own process, engines and
long solves in a process of their own, so that a crash or the time limit is a failed row and costs
no worker. A case whose worker dies is done again elsewhere, up to the scheduler's
`allowed-failures`, after which it is a failed row.
"""

import atexit
import hashlib
import logging
import multiprocessing
import platform
import queue
import socket
import time
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

from pebble import ProcessPool

from analytic.response import Response
from studies.kit import provenance
from studies.kit.arguments import BadInputError
from studies.kit.executors import ask_loaded, outcome_of
from studies.kit.fingerprint import PACKAGES, ROOT
from studies.kit.jobs import Job, ask, one_line
from studies.sources.registry import Source, resolve

if TYPE_CHECKING:
    from distributed import Client, Future

CONNECT_S = 10.0
"""How long to wait for the scheduler, and for a first worker [s]."""
PATIENCE_S = 60.0
"""How long to wait for another worker when the last one has gone [s]."""
START = "dask worker ADDRESS --no-nanny --nthreads 1"


class ClusterError(BadInputError):
    """A cluster that cannot be used; the message is one line that says why."""

    def __init__(self, address: str, problem: str) -> None:
        super().__init__(f"--cluster is {address!r}; {problem}")


class RefusedError(Exception):
    """Raised on a worker that must not run a job."""


@dataclass(frozen=True, slots=True)
class Cluster:
    """An executor whose jobs run on the workers of a Dask scheduler.

    Attributes
    ----------
    address : str
        Of the scheduler, as in tcp://127.0.0.1:8786.
    time_limit_s : float
        As in `Local`.
    ask : callable, optional
        How a job is put to its source.
    """

    address: str
    time_limit_s: float
    ask: Callable[[Job, Source], Response] = ask

    def check(self) -> None:
        """Raise ClusterError unless the cluster can be used."""
        client = connect(self.address)
        client.close()

    def __call__(self, jobs: Sequence[Job]) -> Generator[tuple[int, Response], None, None]:
        """Run the jobs."""
        if not jobs:
            return
        client = connect(self.address)
        done: queue.SimpleQueue[int] = queue.SimpleQueue()
        futures: dict[int, Future[Response]] = {}
        try:
            for number, job in enumerate(jobs):
                futures[number] = client.submit(
                    work,
                    fitness(),
                    job,
                    resolve(job.source),
                    self.ask,
                    self.time_limit_s,
                    pure=False,
                )
            for number, future in futures.items():
                future.add_done_callback(lambda _, number=number: done.put(number))
            while futures:
                number = self._next(client, done)
                yield number, self._answer(futures.pop(number))
        finally:
            client.close(timeout=1.0)

    def _next(self, client: "Client", done: "queue.SimpleQueue[int]") -> int:
        """Wait for the next job that ends; raise ClusterError when nobody is left to end one."""
        alone_since = time.monotonic()
        while True:
            try:
                return done.get(timeout=1.0)
            except queue.Empty:
                if client.status != "running":
                    raise ClusterError(self.address, "its scheduler has gone") from None
            if client.nthreads():
                alone_since = time.monotonic()
            elif time.monotonic() - alone_since > PATIENCE_S:
                raise ClusterError(self.address, "its workers have all gone; start another one")

    def _answer(self, future: "Future[Response]") -> Response:
        if future.status == "finished":
            return future.result()
        if future.status in ("cancelled", "lost"):
            raise ClusterError(self.address, "its scheduler has gone")
        error = future.exception()
        if isinstance(error, RefusedError):
            raise ClusterError(self.address, str(error))
        if type(error).__name__ == "KilledWorker":
            return Response.failure("every worker that ran this case died")
        return Response.failure(one_line(error))


def connect(address: str) -> "Client":
    """Return a client of a cluster whose workers run this very version.

    Raises
    ------
    ClusterError
        If Dask is not installed, nobody answers, there is no worker, or one is unfit.
    """
    try:
        from distributed import Client
    except ImportError:
        raise ClusterError(address, "it needs Dask: pip install 'rocking[cluster]'") from None
    for name in ("distributed", "tornado"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
    try:
        _knock(address)
        client = Client(address, timeout=CONNECT_S, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        problem = f"it must be the address of a running Dask scheduler ({one_line(error)})"
        raise ClusterError(address, problem) from None
    try:
        _refuse_unfit(client, address)
    except BaseException:
        client.close(timeout=1.0)
        raise
    return client


def _knock(address: str) -> None:
    """Raise OSError or ValueError unless somebody listens; a client that fails leaves threads."""
    from distributed.comm.addressing import get_address_host_port

    with socket.create_connection(get_address_host_port(address, strict=True), CONNECT_S):
        pass


def _refuse_unfit(client: "Client", address: str) -> None:
    try:
        client.wait_for_workers(1, timeout=CONNECT_S)
    except TimeoutError:
        raise ClusterError(address, f"it has no workers; start one with {START}") from None
    found = client.run(unfit, fitness(), on_error="return")
    for worker, problem in found.items():
        if problem:
            raise ClusterError(address, f"its worker {worker} cannot be used: {_words(problem)}")


def _words(problem: Any) -> str:
    if isinstance(problem, ModuleNotFoundError):
        return f"{problem.name} is not installed there"
    return one_line(problem) if isinstance(problem, Exception) else str(problem)


@cache
def fitness() -> dict[str, str]:
    """Return what must be the same on a worker for its results to be the same."""
    digest = hashlib.sha256()
    for part in PACKAGES:
        for path in sorted((ROOT / part).rglob("*.py")):
            name = path.relative_to(ROOT).as_posix()
            digest.update(name.encode() + b"\0" + path.read_bytes() + b"\0")
    packages = (*provenance.engine_packages(), *provenance.NUMERICAL_PACKAGES)
    return {
        "code": digest.hexdigest()[:12],
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
    """Run a job on this worker."""
    if problem := unfit(expected):
        raise RefusedError(f"a worker cannot be used: {problem}")
    if source.kind == "engine" or job.is_long:
        task = _processes().schedule(ask_loaded, args=(ask, job, source), timeout=time_limit_s)
        return outcome_of(task.result, time_limit_s)
    if job.source not in _loaded:
        # loading the compiled kernels is no part of the first case's run time
        _loaded.add(job.source)
        ask(job, source)
    return ask(job, source)


_loaded: set[str] = set()


@cache
def _processes() -> ProcessPool:
    """Return this worker's processes, one for each of its threads."""
    from distributed import get_worker

    threads = get_worker().state.nthreads
    pool = ProcessPool(max_workers=threads, context=multiprocessing.get_context("spawn"))
    atexit.register(pool.stop)
    return pool
