"""A Dask cluster as the place where jobs are run.

A case whose worker dies is done again elsewhere, up to the scheduler's `allowed-failures`, after
which it is a failed row.
"""

import time
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import CancelledError, Future
from contextlib import suppress
from dataclasses import dataclass
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING

from analytic.response import Response
from studies.kit.dask_client import ClusterError, client_of, gone, workers_of
from studies.kit.jobs import Job, ask
from studies.kit.refusing import one_line
from studies.kit.worker import RefusedError, fitness, work
from studies.sources.registry import Source

if TYPE_CHECKING:
    from distributed import Client

LOOK_S = 1.0
"""How long to wait for the next answer before asking whether anybody is left to give it [s]."""
PATIENCE_S = 60.0
"""How long to wait for another worker when the last one has gone [s]."""


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
        with client_of(self.address):
            pass

    def __call__(self, jobs: Sequence[Job]) -> Generator[tuple[int, Response], None, None]:
        """Run the jobs."""
        if not jobs:
            return
        ended: SimpleQueue[Future[Response]] = SimpleQueue()
        with client_of(self.address) as client:
            executor, numbers = client.get_executor(pure=False), {}
            for number, job in enumerate(jobs):
                order = (fitness(), job, job.asked, self.ask, self.time_limit_s)
                task = executor.submit(work, *order)
                numbers[task] = number
                task.add_done_callback(ended.put)
            for _ in jobs:
                task = self._next(client, ended)
                yield numbers.pop(task), self._response(client, task)

    def _next(self, client: "Client", ended: "SimpleQueue[Future[Response]]") -> "Future[Response]":
        """Wait for the next job that ends; raise ClusterError when nobody is left to end one."""
        alone_since = time.monotonic()
        while True:
            with suppress(Empty):
                return ended.get(timeout=LOOK_S)
            if workers_of(client, self.address):
                alone_since = time.monotonic()
            elif time.monotonic() - alone_since > PATIENCE_S:
                raise ClusterError(self.address, "its workers have all gone; start another one")

    def _response(self, client: "Client", task: "Future[Response]") -> Response:
        """Return a job's response, or the failure as which it ended.

        Raises
        ------
        ClusterError
            If it must not be run, or the scheduler has gone.
        """
        from distributed import KilledWorker

        try:
            return task.result()
        except RefusedError as error:
            raise ClusterError(self.address, str(error)) from None
        except KilledWorker:
            return Response.failure("every worker that ran this case died")
        except (Exception, CancelledError) as error:
            if isinstance(error, CancelledError) or client.status != "running":
                raise gone(self.address) from None
            return Response.failure(one_line(error))
