"""Where jobs are run: on the machine at hand, or on a cluster that is named.

In processes of their own, where engines are concerned: how a process asks, and what came of it.
"""

import sys
from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from concurrent.futures import CancelledError, Future, as_completed
from contextlib import nullcontext, suppress
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

from analytic.kernels.compiled import Kernel, compile_all
from analytic.kernels.kept import are_compiled
from analytic.response import Reason, Response
from engines import ENGINES
from engines.parts.compiled import PACKAGE
from engines.run.monitor import compile_monitor
from studies.old.jobs import Job, ask, short
from studies.old.pool import MEMORY_BYTES, OvertimeError, Pool, StartError, TaskError
from studies.old.refusing import one_line, say
from studies.sources.registry import Source

Ask: TypeAlias = Callable[[Job, Source], Response]
"""How a job is put to its source."""


COMPILING_S = 1800.0
"""Nothing takes longer to compile [s]."""

_loaded: set[str] = set()
"""Sources whose kernels this process has loaded."""


def _compile_ahead(pool: Pool, ask_: Ask, jobs: Iterable[Job]) -> None:
    """Compile what the engines of jobs need on a machine, before any time limit holds.

    One process of the pool does so, once for each source; the others load what was compiled.
    """
    tasks: list[Future[Any]] = []
    with pool.preparing:  # who asks meanwhile waits for what it needs, too
        for job in jobs:
            source = job.asked
            known = source.engine in ENGINES and job.source not in pool.prepared
            if not known or not source.declared.installed:
                continue
            if not pool.prepared:
                tasks.append(pool.schedule(compile_monitor, (), COMPILING_S))
            pool.prepared.add(job.source)
            if source.declared.compiles:
                tasks.append(pool.schedule(_ask_apart, (ask_, short(job), True), COMPILING_S))
        for task in tasks:
            with suppress(Exception):  # the cases will say what is wrong
                task.result()


def _ask_apart(ask_: Ask, job: Job, many: bool) -> Response:
    """Put a job to its source, in a process of a pool that need not have registered it.

    Where jobs are many, the kernels are compiled first, and those of a model or solver loaded by a
    short question, as a long one is not asked twice.
    """
    if many:
        compile_all()
        if job.asked.kind != "engine" and job.source not in _loaded:
            _loaded.add(job.source)
            ask(short(job), job.asked)
    response = ask_(job, job.asked)
    if response.message.startswith(MemoryError.__name__):
        words = f"{response.message.rstrip(': ')}; a process may take {MEMORY_BYTES / 1e9:g} GB"
        return replace(response, message=words)
    return response


def _outcome_of(task: Future[Response], time_limit_s: float) -> Response:
    """Return what came of a job in a process: its response, or a failed one that says why."""
    try:
        return task.result()
    except (CancelledError, StartError):
        raise
    except OvertimeError:
        words = f"no result within the time limit of {time_limit_s:g} s"
        return Response.failure(words, reason=Reason.UNDECIDED)
    except Exception as error:
        return Response.failure(str(error) if isinstance(error, TaskError) else one_line(error))


FEW = 32
"""Jobs up to which to interpret what they need takes less time than to compile or to load it."""


Answers: TypeAlias = Generator[tuple[int, Response], None, None]
"""The number of each job with its response, in any order."""

Executor: TypeAlias = Callable[[Sequence[Job]], Answers]
"""Where jobs are run."""


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
    at_once : bool, optional
        Whether somebody waits for the answers and nobody for their run times: of a few jobs,
        nothing is compiled.
    """

    workers: int
    time_limit_s: float
    ask: Ask = ask
    at_once: bool = False

    def __call__(self, jobs: Sequence[Job], pool: Pool | None = None) -> Answers:
        """Run the jobs.

        Parameters
        ----------
        jobs : sequence of Job
        pool : Pool, optional
            Whose processes are used, and may be again; by default new ones, which end.
        """
        slow: dict[int, Job] = {}
        loaded = pool.loaded if pool else set[str]()
        many = not self.at_once or len(jobs) > FEW
        if many:
            compile_all()
        if sys.stderr.isatty():
            Kernel.tell = say
        for number, job in enumerate(jobs):
            if job.needs_process:
                slow[number] = job
                continue
            if many and job.source not in loaded:
                # loading the compiled kernels is no part of the first case's run time
                loaded.add(job.source)
                self.ask(job, job.asked)
            yield number, self.ask(job, job.asked)
        if slow:
            with nullcontext(pool) if pool else Pool(min(self.workers, len(slow))) as processes:
                yield from self._in_processes(processes, slow, many)

    def _in_processes(self, pool: Pool, jobs: Mapping[int, Job], many: bool) -> Answers:
        if many:
            if Kernel.tell is not None and not are_compiled(PACKAGE):
                Kernel.tell("compiling what engines need, once: some 10 to 40 s")
            _compile_ahead(pool, self.ask, jobs.values())
        try:
            tasks = {
                pool.schedule(_ask_apart, (self.ask, job, many), self.time_limit_s): number
                for number, job in jobs.items()
            }
            for task in as_completed(tasks):
                yield tasks[task], _outcome_of(task, self.time_limit_s)
        except StartError as error:
            raise OSError(f"a process could not be started ({error})") from error
