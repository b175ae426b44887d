"""A Dask cluster as the place where jobs run; its workers run them as this machine would.

Dask is imported only here, and only when a cluster is named. A worker must have no nanny, under
which it could start no process: dask worker ADDRESS --no-nanny --nthreads 1.
"""

from __future__ import annotations

import multiprocessing
import socket
from collections.abc import Sequence
from functools import partial
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from analytic.response import Response
from studies.cases.refusal import BadInputError
from studies.kit.identity import Maker, maker_of
from studies.kit.jobs import Job
from studies.kit.run import Measure, Place, Rows, local, lost_row, makers_of
from studies.sources.registry import resolve

if TYPE_CHECKING:
    from studies.kit.arguments import Computing

CONNECT_S, ALONE_S = 10.0, 60.0
"""How long to wait for the scheduler and a first worker, and for one when all have died [s]."""
PARTS = 4
"""Of the jobs, for each worker: each part starts processes, which must load what they need."""


def _unfit(expected: dict[str, Maker], measure: Measure) -> str:
    """Say why this worker must not run jobs; an empty string if it may."""
    if multiprocessing.current_process().daemon:
        return "it has a nanny; use dask worker ADDRESS --no-nanny --nthreads 1"
    here = {name: maker_of(resolve(name), measure) for name in expected}
    return "; ".join(
        f"{name}: {what} is {here[name].get(what)} there, {value} here"
        for name, made in expected.items()
        for what, value in made.items()
        if here[name].get(what) != value
    )


def _work(jobs: Sequence[Job], measure: Measure, limit_s: float) -> list[Any]:
    return list(local(jobs, measure, 1, limit_s))


def on_cluster(address: str, limit_s: float, jobs: Sequence[Job], measure: Measure) -> Rows:
    """Yield the number and row of each job as `local` does, from a cluster that makes such rows."""
    try:
        from distributed import Client

        place = urlsplit(address)  # Dask itself would try again and again where nobody listens
        socket.create_connection((place.hostname or "", place.port or 0), CONNECT_S).close()
        client = Client(address, timeout=CONNECT_S, set_as_default=False)
        client.wait_for_workers(1, timeout=CONNECT_S)
    except Exception as error:
        words = "it must be the address of a running Dask scheduler with workers"
        raise BadInputError(f"--cluster is {address!r}; {words} ({error})") from error
    with client:
        expected = makers_of(jobs, measure)
        for worker, problem in client.run(_unfit, expected, measure).items():
            if problem:
                raise BadInputError(f"--cluster is {address!r}; its worker {worker}: {problem}")
        count = max(min(PARTS * sum(client.nthreads().values()), len(jobs)), 1)
        parts = [list(range(first, len(jobs), count)) for first in range(count)] if jobs else []
        tasks = {
            client.submit(_work, [jobs[n] for n in part], measure, limit_s, pure=False): part
            for part in parts
        }
        ended = SimpleQueue[Any]()
        for task in tasks:
            task.add_done_callback(ended.put)
        left = len(tasks)
        while left:
            try:
                task = ended.get(timeout=ALONE_S)
            except Empty:
                if client.nthreads():
                    continue
                words = "it has no worker any more"
                raise BadInputError(f"--cluster is {address!r}; {words}") from None
            left, part = left - 1, tasks[task]
            if task.status == "finished":
                yield from ((part[place], row) for place, row in task.result())
                continue
            lost = Response.failure(f"every worker that ran this case died: {task.exception()}")
            yield from ((n, lost_row(measure, jobs[n], lost)) for n in part)


def place_of(running: Computing, *, at_once: bool = False) -> Place:
    """Return where the options let jobs run; `at_once` as for `studies.kit.run.local`."""
    if running.cluster is None:
        return partial(local, workers=running.workers, limit_s=running.time_limit, at_once=at_once)
    return partial(on_cluster, running.cluster, running.time_limit)
