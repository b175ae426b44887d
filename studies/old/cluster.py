"""A Dask cluster as the place where jobs are run, with a time limit on every question to it.

Dask is imported only here and on a worker, and only when a cluster is named. Whether the
connection is encrypted, and whom it trusts, is Dask's own configuration (`distributed.comm.tls`),
as on the scheduler and the workers. A case whose worker dies is done again elsewhere, up to the
scheduler's `allowed-failures`, after which it is a failed row.

A worker says whether it is fit, and runs its jobs as `Local` does: models and solvers in its own
process, engines and long solves in a process of their own, so that a crash or the time limit is a
failed row and costs no worker.
"""

import asyncio
import logging
import multiprocessing
import platform
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError, Future
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import cache
from queue import Empty, SimpleQueue
from threading import Lock
from typing import TYPE_CHECKING, Any

from analytic.response import Response
from engines.registry import OWN
from studies.old import provenance
from studies.old.arguments import BadInputError
from studies.old.executors import Answers, Ask, Local
from studies.old.fingerprint import everything
from studies.old.jobs import Job, ask
from studies.old.pool import Pool
from studies.old.refusing import one_line

if TYPE_CHECKING:
    from distributed import Client, Worker

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


def work(expected: dict[str, str], job: Job, ask: Ask, time_limit_s: float) -> Response:
    """Run a job on this worker, as `Local` does on a machine.

    Raises
    ------
    RefusedError
        If this worker is not fit.
    """
    from distributed import Reschedule, get_worker

    if problem := unfit(expected):
        raise RefusedError(f"a worker cannot be used: {problem}")
    with _starting:
        pool = _processes_of(get_worker())
    try:
        ((_, answer),) = Local(1, time_limit_s, ask)([job], pool)
    except CancelledError:  # this worker is closing
        raise Reschedule from None
    return answer


_starting = Lock()


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


CONNECT_S = 10.0
"""How long to wait for the scheduler, and for a first worker [s]."""
ANSWER_S = 60.0
"""How long to wait for any other answer [s]; a worker may have to import this project first."""
CLOSE_S = 1.0
"""How long to wait for the scheduler to see a client off [s]."""
LOOK_S = 1.0
"""How long to wait for the next answer before asking whether anybody is left to give it [s]."""
PATIENCE_S = 60.0
"""How long to wait for another worker when the last one has gone [s]."""


class ClusterError(BadInputError):
    """A cluster that cannot be used; the message is one line that says why."""

    def __init__(self, address: str, problem: str) -> None:
        super().__init__(f"--cluster is {address!r}; {problem}")


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
    ask: Ask = ask

    def check(self) -> None:
        """Raise ClusterError unless the cluster can be used."""
        with self._client():
            pass

    def __call__(self, jobs: Sequence[Job]) -> Answers:
        """Run the jobs."""
        if not jobs:
            return
        ended: SimpleQueue[Future[Response]] = SimpleQueue()
        with self._client() as client:
            executor = client.get_executor(pure=False)
            numbers: dict[Future[Response], int] = {}
            for number, job in enumerate(jobs):
                task = executor.submit(work, fitness(), job, self.ask, self.time_limit_s)
                numbers[task] = number
                task.add_done_callback(ended.put)
            while numbers:
                task = self._next(client, ended)
                yield numbers.pop(task), self._response(client, task)

    @contextmanager
    def _client(self) -> Iterator["Client"]:
        """Connect to a scheduler whose workers run this very version."""
        try:
            from distributed import utils
        except ImportError:
            raise self._error("it needs Dask: pip install 'rocking[cluster]'") from None
        # nobody but this project tells the user what happens to the cluster
        for name in logging.root.manager.loggerDict:
            if name.partition(".")[0] in ("distributed", "tornado"):
                logging.getLogger(name).setLevel(logging.CRITICAL + 1)
        runner = utils.LoopRunner()
        runner.start()
        try:
            try:
                found = utils.sync(runner.loop, connected, self.address, callback_timeout=CONNECT_S)
            except Exception as error:
                # whoever listens there may have said anything
                late = isinstance(error, TimeoutError)
                reason = f"no answer within {CONNECT_S:g} s" if late else one_line(error)
                problem = f"it must be the address of a running Dask scheduler ({reason})"
                raise self._error(problem) from None
            try:
                self._refuse_unfit(found)
                yield found
            finally:
                utils.sync(runner.loop, _close, found)
        finally:
            runner.stop()

    def _refuse_unfit(self, client: "Client") -> None:
        with suppress(TimeoutError):
            client.wait_for_workers(1, timeout=CONNECT_S)
        if not self._answer(client, client.nthreads):
            raise self._error(f"it has no workers; start one with {START}")
        problems = self._answer(client, client.run, unfit, fitness(), on_error="return")
        for worker, problem in problems.items():
            if problem:
                words = one_line(problem) if isinstance(problem, Exception) else problem
                raise self._error(f"its worker {worker} cannot be used: {words}")

    def _answer(self, client: "Client", question: Callable[..., Any], *of: Any, **more: Any) -> Any:
        """Return the answer to a question that a client puts to the scheduler or its workers."""
        try:
            if client.status == "running":
                return client.sync(question, *of, callback_timeout=ANSWER_S, **more)
        except TimeoutError:
            raise self._error(f"no answer within {ANSWER_S:g} s") from None
        except OSError:
            pass
        raise self._gone()

    def _next(self, client: "Client", ended: "SimpleQueue[Future[Response]]") -> "Future[Response]":
        """Wait for the next job that ends; raise ClusterError when nobody is left to end one."""
        alone_since = time.monotonic()
        while True:
            with suppress(Empty):
                return ended.get(timeout=LOOK_S)
            if self._answer(client, client.nthreads):
                alone_since = time.monotonic()
            elif time.monotonic() - alone_since > PATIENCE_S:
                raise self._error("its workers have all gone; start another one")

    def _response(self, client: "Client", task: "Future[Response]") -> Response:
        """Return the response of a job, or the failure as which it ended."""
        from distributed import KilledWorker

        try:
            return task.result()
        except RefusedError as error:
            raise self._error(str(error)) from None
        except KilledWorker:
            return Response.failure("every worker that ran this case died")
        except (Exception, CancelledError) as error:
            if isinstance(error, CancelledError) or client.status != "running":
                raise self._gone() from None
            return Response.failure(one_line(error))

    def _error(self, problem: str) -> ClusterError:
        return ClusterError(self.address, problem)

    def _gone(self) -> ClusterError:
        return self._error("its scheduler has gone")


async def connected(address: str) -> "Client":
    """Return a client of a scheduler, or raise whatever Dask does."""
    from distributed import Client
    from distributed.comm.addressing import get_address_host_port

    # Dask itself would try again and again where nobody listens
    _, writer = await asyncio.open_connection(*get_address_host_port(address, strict=True))
    writer.close()
    client = Client(address, asynchronous=True, timeout=CONNECT_S, set_as_default=False)
    try:
        await client
        return client
    except BaseException:
        await _close(client)
        raise


async def _close(client: "Client") -> None:
    with suppress(OSError):
        await client.close(timeout=CLOSE_S)
