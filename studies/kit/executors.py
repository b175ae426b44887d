"""Where jobs are run: on the machine at hand, or on a cluster that is named."""

import sys
from collections.abc import Callable, Generator, Mapping, Sequence
from concurrent.futures import as_completed
from contextlib import suppress
from dataclasses import dataclass
from typing import Protocol

from analytic.kernels.compiled import Kernel, compile_all
from analytic.kernels.kept import are_compiled
from analytic.response import Response
from engines.parts.compiled import PACKAGE
from studies.kit.jobs import Job, ask
from studies.kit.pool import Pool, StartError, TaskError
from studies.kit.processes import ask_apart, compile_ahead, outcome_of
from studies.kit.refusing import say
from studies.kit.together import ask_together, batches
from studies.sources.registry import Source

FEW = 32
"""Jobs up to which to interpret what they need takes less time than to compile or to load it."""


class Executor(Protocol):
    """Where jobs are run: yields the number of each job with its response, in any order."""

    def __call__(self, jobs: Sequence[Job]) -> Generator[tuple[int, Response], None, None]:
        """Run the jobs."""


@dataclass(frozen=True, slots=True)
class Local:
    """The machine at hand: models and solvers in this process, engines in processes of their own.

    A compiled solver cannot be stopped from within its process: a long solve is treated as an
    engine's. Jobs that an engine can answer at once are, where they are asked as `ask` does; of a
    batch that has no answer each is asked by itself, so that the failure is that of its own row.

    Attributes
    ----------
    workers : int
        Number of processes.
    time_limit_s : float
        Wall-clock time [s] after which a case in a process of its own is given up.
    ask : callable, optional
        How a job is put to its source.
    at_once : bool, optional
        Whether somebody waits for the answers and nobody for their run times: of a few jobs,
        nothing is compiled.
    """

    workers: int
    time_limit_s: float
    ask: Callable[[Job, Source], Response] = ask
    at_once: bool = False

    def __call__(self, jobs: Sequence[Job]) -> Generator[tuple[int, Response], None, None]:
        """Run the jobs."""
        slow: dict[int, Job] = {}
        many = not self.at_once or len(jobs) > FEW
        if many:
            compile_all()
        if sys.stderr.isatty():
            Kernel.tell = say
        loaded: set[str] = set()
        for number, job in enumerate(jobs):
            source = job.asked
            if job.needs_process(source):
                slow[number] = job
                continue
            if many and job.source not in loaded:
                # loading the compiled kernels is no part of the first case's run time
                loaded.add(job.source)
                self.ask(job, source)
            yield number, self.ask(job, source)
        if slow:
            yield from self._in_processes(slow, many)

    def _in_processes(
        self, jobs: Mapping[int, Job], many: bool
    ) -> Generator[tuple[int, Response], None, None]:
        firsts: dict[str, Job] = {}
        for job in jobs.values():
            firsts.setdefault(job.source, job)
        with Pool(min(self.workers, len(jobs))) as pool:
            if many:
                if Kernel.tell is not None and not are_compiled(PACKAGE):
                    Kernel.tell("compiling what engines need, once: some 10 to 40 s")
                compile_ahead(pool, self.ask, [(job, job.asked) for job in firsts.values()])
            pending = dict(jobs)
            try:
                if many and self.ask is ask:
                    for number, response in self._in_batches(pool, jobs):
                        del pending[number]
                        yield number, response
                # the source travels with the job, so that a worker needs no registry of its own
                tasks = {
                    pool.schedule(ask_apart, (self.ask, job, job.asked, many), self.time_limit_s): n
                    for n, job in pending.items()
                }
                for task in as_completed(tasks):
                    yield tasks[task], outcome_of(task, self.time_limit_s)
            except StartError as error:
                raise OSError(f"a process could not be started ({error})") from error

    def _in_batches(
        self, pool: Pool, jobs: Mapping[int, Job]
    ) -> Generator[tuple[int, Response], None, None]:
        """Run what can be run at once, each batch as long as its jobs may take one by one."""
        tasks = {}
        for numbers in batches(jobs, self.workers):
            limit_s = self.time_limit_s * len(numbers)
            task = pool.schedule(ask_together, ([jobs[n] for n in numbers],), limit_s)
            tasks[task] = numbers
        for task in as_completed(tasks):
            answers: list[Response] = []
            with suppress(TaskError):
                answers = task.result()
            yield from zip(tasks[task], answers, strict=False)
