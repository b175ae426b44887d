"""Where jobs are run: on the machine at hand, or on a cluster that is named."""

import signal
from collections.abc import Callable, Generator, Mapping, Sequence
from concurrent.futures import Future, TimeoutError, as_completed
from dataclasses import dataclass
from multiprocessing import get_context
from typing import Protocol

from pebble import ProcessExpired, ProcessPool

from analytic.response import Reason, Response
from studies.kit import provenance
from studies.kit.jobs import Job, ask, one_line
from studies.sources.registry import Source, resolve


class Executor(Protocol):
    """Where jobs are run: yields the number of each job with its response, in any order."""

    def __call__(self, jobs: Sequence[Job]) -> Generator[tuple[int, Response], None, None]:
        """Run the jobs."""


@dataclass(frozen=True, slots=True)
class Local:
    """The machine at hand: models and solvers in this process, engines in processes of their own.

    A compiled solver cannot be stopped from within its process: a long solve is treated as an
    engine's.

    Attributes
    ----------
    workers : int
        Number of processes.
    time_limit_s : float
        Wall-clock time [s] after which a case in a process of its own is given up.
    ask : callable, optional
        How a job is put to its source.
    """

    workers: int
    time_limit_s: float
    ask: Callable[[Job, Source], Response] = ask

    def __call__(self, jobs: Sequence[Job]) -> Generator[tuple[int, Response], None, None]:
        """Run the jobs."""
        slow: dict[int, Job] = {}
        loaded: set[str] = set()
        for number, job in enumerate(jobs):
            source = resolve(job.source)
            if source.kind == "engine" or job.is_long:
                slow[number] = job
                continue
            if job.source not in loaded:
                # loading the compiled kernels is no part of the first case's run time
                loaded.add(job.source)
                self.ask(job, source)
            yield number, self.ask(job, source)
        if slow:
            yield from self._in_processes(slow)

    def _in_processes(self, jobs: Mapping[int, Job]) -> Generator[tuple[int, Response], None, None]:
        # engines hold state of their own: no fork of a process that has loaded them
        pool = ProcessPool(max_workers=min(self.workers, len(jobs)), context=get_context("spawn"))
        try:
            # the source travels with the job, so that a worker needs no registry of its own
            tasks: dict[Future[Response], int] = {
                pool.schedule(
                    self.ask, args=(job, resolve(job.source)), timeout=self.time_limit_s
                ): number
                for number, job in jobs.items()
            }
            for task in as_completed(tasks):
                yield tasks[task], outcome_of(task.result, self.time_limit_s)
        finally:
            pool.stop()  # type: ignore[no-untyped-call]
            pool.join()


def choose(
    jobs: int | None,
    time_limit_s: float,
    cluster: str | None,
    ask: Callable[[Job, Source], Response] = ask,
) -> Executor:
    """Return the executor that the command line's --jobs, --time-limit and --cluster ask for.

    Raises
    ------
    studies.cluster.ClusterError
        If the cluster cannot be used.
    """
    if cluster is None:
        return Local(jobs or provenance.usable_cores(), time_limit_s, ask)
    from studies.kit.cluster import Cluster

    chosen = Cluster(cluster, time_limit_s, ask)
    chosen.check()
    return chosen


def outcome_of(result: Callable[[], Response], time_limit_s: float) -> Response:
    """Return the result of a process, or the failure as which it ended."""
    try:
        return result()
    except TimeoutError:
        words = f"no result within the time limit of {time_limit_s:g} s"
        return Response.failure(words, reason=Reason.UNDECIDED)
    except ProcessExpired as error:
        return Response.failure(_cause_of_death(error.exitcode))
    except Exception as error:
        return Response.failure(one_line(error))


def _cause_of_death(exitcode: int) -> str:
    if exitcode < 0:
        return f"the process was ended by signal {signal.Signals(-exitcode).name}"
    return f"the process ended by itself with exit code {exitcode}"
