"""A Dask cluster as the place where jobs are run.

A case whose worker dies is done again elsewhere, up to the scheduler's `allowed-failures`, after
which it is a failed row.
"""

import asyncio
import time
from collections.abc import AsyncGenerator, Callable, Generator, Sequence
from contextlib import suppress
from dataclasses import dataclass

from analytic.response import Response
from studies.kit.alongside import alongside
from studies.kit.dask_client import AsyncClient, ClusterError, client_of, gone, workers_of
from studies.kit.jobs import Job, ask
from studies.kit.refusing import one_line
from studies.kit.worker import RefusedError, fitness, work
from studies.sources.registry import Source

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
        for _ in alongside(self._answers(())):
            pass

    def __call__(self, jobs: Sequence[Job]) -> Generator[tuple[int, Response], None, None]:
        """Run the jobs."""
        if jobs:
            yield from alongside(self._answers(jobs))

    async def _answers(self, jobs: Sequence[Job]) -> AsyncGenerator[tuple[int, Response], None]:
        async with client_of(self.address) as client:
            ended: asyncio.Queue[asyncio.Task[Response]] = asyncio.Queue()
            numbers = {
                asyncio.create_task(self._response(client, job)): number
                for number, job in enumerate(jobs)
            }
            try:
                for task in numbers:
                    task.add_done_callback(ended.put_nowait)
                for _ in numbers:
                    task = await self._next(client, ended)
                    yield numbers[task], task.result()
            finally:
                for task in numbers:
                    task.cancel()
                await asyncio.gather(*numbers, return_exceptions=True)

    async def _response(self, client: AsyncClient, job: Job) -> Response:
        order = (fitness(), job, job.asked, self.ask, self.time_limit_s)
        try:
            future = client.submit(work, *order, pure=False)
        except OSError:
            raise gone(self.address) from None
        try:
            response: Response = await future.result()
            return response
        except Exception as error:
            if future.status == "error":
                return self._failure(error)
            # not the job's error, but that of the connection through which its answer came
            raise gone(self.address) from None

    def _failure(self, error: Exception) -> Response:
        """Return the failure as which a job ended; raise ClusterError if it must not be run."""
        if isinstance(error, RefusedError):
            raise ClusterError(self.address, str(error))
        if type(error).__name__ == "KilledWorker":
            return Response.failure("every worker that ran this case died")
        return Response.failure(one_line(error))

    async def _next(
        self, client: AsyncClient, ended: "asyncio.Queue[asyncio.Task[Response]]"
    ) -> "asyncio.Task[Response]":
        """Wait for the next job that ends; raise ClusterError when nobody is left to end one."""
        alone_since = time.monotonic()
        while True:
            with suppress(TimeoutError):
                return await asyncio.wait_for(ended.get(), LOOK_S)
            if await workers_of(client, self.address):
                alone_since = time.monotonic()
            elif time.monotonic() - alone_since > PATIENCE_S:
                raise ClusterError(self.address, "its workers have all gone; start another one")
