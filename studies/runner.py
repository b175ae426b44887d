"""Many jobs: in parallel, resumable, with progress; a failure is a row and stops nothing."""

import hashlib
import json
import signal
import sys
from collections.abc import Callable, Generator, Mapping, Sequence
from concurrent.futures import Future, TimeoutError, as_completed
from contextlib import closing
from dataclasses import asdict, dataclass, field, is_dataclass
from multiprocessing import get_context
from typing import Any, Protocol

import numpy as np
from pebble import ProcessExpired, ProcessPool
from tqdm import tqdm

from analytic.block import RigidBlock
from analytic.motion import FloatArray, Motion
from analytic.response import Outcome, Response
from studies.journal import Journal, Row
from studies.sources import Source, resolve

LONG = 1e7
"""Steps, about a second of a compiled solver, beyond which a job gets a process of its own."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """One question to one source.

    Attributes
    ----------
    labels : mapping
        The first columns of the row.
    block, motion : RigidBlock, Motion
    source : str
        A source's name, as the user wrote it.
    duration, times
        As in `studies.respond`.
    options : mapping
        Further settings of the source.
    """

    labels: Mapping[str, Any]
    block: RigidBlock
    motion: Motion
    source: str
    duration: float | None = None
    times: FloatArray | None = None
    options: Mapping[str, Any] = field(default_factory=dict)

    @property
    def key(self) -> str:
        """The identity of the job: everything that its result depends on."""
        preset = resolve(self.source).preset
        parts = [asdict(self), type(self.motion).__name__, preset]
        text = json.dumps(parts, default=_plain, sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:24]

    @property
    def is_long(self) -> bool:
        """Whether a stepping source would take so many steps that it needs a time limit."""
        observed = self.motion.duration if self.duration is None else self.duration
        return observed * self.block.p > LONG * float(self.options.get("step", 1e-3))


def _plain(value: Any) -> Any:
    if is_dataclass(value) and not isinstance(value, type):
        return asdict(value)
    if isinstance(value, np.ndarray):
        return [str(value.dtype), value.shape, hashlib.sha256(value.tobytes()).hexdigest()]
    if isinstance(value, Mapping):
        return dict(value)
    raise TypeError(f"{value!r} cannot be part of a job's identity")


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
    """

    workers: int
    time_limit_s: float

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
                ask(job, source)
            yield number, ask(job, source)
        if slow:
            yield from self._in_processes(slow)

    def _in_processes(self, jobs: Mapping[int, Job]) -> Generator[tuple[int, Response], None, None]:
        # engines hold state of their own: no fork of a process that has loaded them
        pool = ProcessPool(max_workers=min(self.workers, len(jobs)), context=get_context("spawn"))
        try:
            # the source travels with the job, so that a worker needs no registry of its own
            tasks: dict[Future[Response], int] = {
                pool.schedule(
                    ask, args=(job, resolve(job.source)), timeout=self.time_limit_s
                ): number
                for number, job in jobs.items()
            }
            for task in as_completed(tasks):
                yield tasks[task], self._outcome(task.result)
        finally:
            pool.stop()  # type: ignore[no-untyped-call]
            pool.join()

    def _outcome(self, result: Callable[[], Response]) -> Response:
        try:
            return result()
        except TimeoutError:
            return Response.failure(f"no result within the time limit of {self.time_limit_s:g} s")
        except ProcessExpired as error:
            return Response.failure(_cause_of_death(error.exitcode))
        except Exception as error:
            return Response.failure(_one_line(error))


def ask(job: Job, source: Source) -> Response:
    """Run one job; whatever it raises becomes a failed response."""
    try:
        return source.call(
            job.block, job.motion, duration=job.duration, times=job.times, **job.options
        )
    except Exception as error:
        return Response.failure(_one_line(error))


def run_jobs(
    jobs: Sequence[Job],
    *,
    executor: Executor,
    reduce: Callable[[Response], Row],
    journal: Journal | None = None,
) -> list[Row]:
    """Run the jobs that are not in the journal yet, and return the rows of all in their order.

    Progress is shown on stderr if that is a terminal. `reduce` makes the columns that follow the
    labels and the source, `outcome` among them.
    """
    keys = [job.key for job in jobs]
    done = dict(journal.rows) if journal else {}
    pending = [number for number, key in enumerate(keys) if key not in done]
    finished = len(jobs) - len(pending)
    with (
        tqdm(total=len(jobs), initial=finished, disable=None, unit="case") as bar,
        closing(executor([jobs[number] for number in pending])) as answers,
    ):
        for position, response in answers:
            number = pending[position]
            row = {**jobs[number].labels, "source": jobs[number].source, **reduce(response)}
            done[keys[number]] = row
            if journal:
                journal.append(keys[number], row)
            bar.update()
    return [done[key] for key in keys]


def summary(response: Response) -> Row:
    """Return the columns that every study shares."""
    return {
        "outcome": response.outcome.value,
        "peak_ratio": float(response.peak_ratio),
        "impacts": len(response.impacts),
        "steps": int(response.steps),
        "wall_s": round(float(response.wall_s), 9),
        "message": response.message,
    }


_LABELS = ("figure", "panel", "aspect", "width_m", "omega_over_p")
"""Columns that name a failed case."""


def exit_code(rows: Sequence[Row], shown: int = 10) -> int:
    """Return 0 if every row is usable; else name those that failed on stderr and return 1."""
    failed = [row for row in rows if row["outcome"] == Outcome.FAILED.value]
    for row in failed[:shown]:
        case = ", ".join(f"{name} {row[name]}" for name in row if name in _LABELS)
        print(f"failed: {row['source']}{case and ', '}{case}: {row['message']}", file=sys.stderr)
    if len(failed) > shown:
        print(f"failed: {len(failed) - shown} more", file=sys.stderr)
    return 1 if failed else 0


def _one_line(error: Exception) -> str:
    return " ".join(f"{type(error).__name__}: {error}".split())


def _cause_of_death(exitcode: int) -> str:
    if exitcode < 0:
        return f"the process was ended by signal {signal.Signals(-exitcode).name}"
    return f"the process ended by itself with exit code {exitcode}"
