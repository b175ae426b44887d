"""Jobs side by side, here or on a Dask cluster: measured where they may fail, kept, counted."""

import multiprocessing
import socket
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from functools import partial
from math import tan
from pathlib import Path
from queue import Empty, SimpleQueue
from time import monotonic
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

import numpy as np
from tqdm import tqdm

from analytic.kernels.forms import Kernel, compile_all
from analytic.kernels.kept import are_compiled
from analytic.motion import SinePulse
from analytic.response import Outcome, Reason, Response
from engines.run.look import PACKAGE, compile_look
from studies.cases.refusal import BadInputError
from studies.kit.app import ended
from studies.kit.identity import Maker, maker_of
from studies.kit.jobs import Job, Row, ask, summary, unanswered
from studies.kit.say import say
from studies.kit.store import Store, labels_of, usable_cores
from studies.kit.workers import Lost, answers
from studies.sources.registry import resolve

if TYPE_CHECKING:
    from studies.kit.arguments import Computing  # it loads the parser, which workers do without

FEW = 32
"""Jobs up to which to interpret takes less time than to load what is compiled."""
TELL_S = 20.0
"""Time between two lines that say how far a run has come where no terminal shows a bar [s]."""
LABELS = ["name", "record", "scale", "figure", "panel", "case", "aspect", "width_m", "omega_over_p"]
"""Columns that name a failed case."""
CONNECT_S, ALONE_S = 10.0, 60.0
"""How long to wait for the scheduler and a first worker, and for one when all have died [s]."""
PARTS = 4
"""Of the jobs, for each worker: each part starts processes, which must load what they need."""

Measure = Callable[[Job], Row]
Rows = Iterator[tuple[int, Row]]
"""The number of each job with what was measured of it, in any order."""
Place = Callable[[Sequence[Job], Measure], Rows]
"""Where jobs are run."""


def here(jobs: Sequence[Job], measure: Measure) -> Rows:
    """Yield the number and row of each job, all measured in this process."""
    yield from ((number, measure(job)) for number, job in enumerate(jobs))


def local(
    jobs: Sequence[Job], measure: Measure, workers: int, limit_s: float, at_once: bool = False
) -> Rows:
    """Yield the number and row of each job: models in this process, engines in their own."""
    # nothing is compiled for a few jobs whose run times nobody reads (`at_once`)
    many = not at_once or len(jobs) > FEW
    if sys.stderr.isatty():
        Kernel.tell = say
    apart = [number for number, job in enumerate(jobs) if job.needs_process]
    for number in sorted({*range(len(jobs))}.difference(apart)):
        if many:
            _load(jobs[number])
        yield number, measure(jobs[number])
    if not apart:
        return
    if many:
        _compile_for([jobs[number] for number in apart])
    tasks = [(measure, jobs[number], many) for number in apart]
    for place, row in answers(_measured, tasks, min(workers, len(tasks)), limit_s):
        number = apart[place]
        if isinstance(row, Lost):
            reason = Reason.UNDECIDED if row.late else Reason.ERROR
            row = lost_row(measure, jobs[number], Response.failure(row.why, reason=reason))
        yield number, row


def with_response(job: Job) -> Row:
    """Return the columns that every row has, and the response."""
    response = ask(job)
    return {**summary(response), "response": response}


_loaded = set[str]()
"""Sources whose kernels this process has loaded."""


def _load(job: Job) -> None:
    """Load what is compiled of a job's source: that is no part of the first case's run time."""
    compile_all()
    if job.asked.kind != "engine" and job.source not in _loaded:
        _loaded.add(job.source)
        ask(_short(job))


def _measured(measure: Measure, job: Job, many: bool) -> Row:
    if many:
        _load(job)
    return measure(job)


def lost_row(measure: Measure, job: Job, response: Response) -> Row:
    """Return the row of a job whose process has ended without an answer."""
    with suppress(Exception):  # what ended the process may be the measure itself
        return measure(replace(job, lost=response))
    return unanswered(response.message)


def _short(job: Job) -> Job:
    """Return a job that takes no time and runs through the same compiled kernels."""
    case, system = job.case, job.case.system
    pulse = SinePulse(amplitude=2.0 * system.gravity * tan(system.alpha), omega=4.0 * system.p)
    duration = None if case.duration is None else pulse.duration
    times = None if case.times is None else np.linspace(0.0, pulse.duration, 3)
    options = {name: value for name, value in job.options.items() if name != "step"}
    return replace(
        job, case=replace(case, motion=pulse, duration=duration, times=times), options=options
    )


def _compile_for(jobs: Sequence[Job]) -> None:
    """Compile what the engines of jobs need, before any time limit holds; others then load it."""
    able = [job for job in jobs if job.asked.engine and job.asked.declared.installed]
    first = {job.source: job for job in reversed(able)}
    if not first:
        return
    if Kernel.tell is not None and not are_compiled(PACKAGE):
        Kernel.tell("compiling what engines need, once: some 10 to 40 s")
    ahead = [_short(job) for job in first.values() if job.asked.declared.compiles]
    tasks = [(compile_look,), *((ask, job) for job in ahead)]
    with suppress(Exception):  # the cases will say what is wrong
        list(answers(_call, tasks, 1, 1800.0))  # [s]; nothing takes longer to compile


def _call(call: Callable[..., Any], *given: Any) -> None:
    compile_all()  # a short job would be interpreted, and the first long one compile in its time
    call(*given)


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
        answered = SimpleQueue[Any]()
        for task in tasks:
            task.add_done_callback(answered.put)
        left = len(tasks)
        while left:
            try:
                task = answered.get(timeout=ALONE_S)
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


def place_of(running: "Computing", *, at_once: bool = False) -> Place:
    """Return where the options let jobs run; `at_once` as for `studies.kit.run.local`."""
    if running.cluster is None:
        workers = running.jobs or usable_cores()
        return partial(local, workers=workers, limit_s=running.time_limit, at_once=at_once)
    return partial(on_cluster, running.cluster, running.time_limit)


def run(
    jobs: Sequence[Job],
    measure: Measure,
    place: Place = here,
    store: Store | None = None,
    also: Sequence[Path] = (),
) -> list[Row]:
    """Run the jobs that neither a store nor folders in `also` have a row of; return all rows."""
    labels = [labels_of(job) for job in jobs]
    if store is None:
        rows = dict(place(jobs, measure))
        return [{**labels[number], **rows[number]} for number in range(len(jobs))]
    keys = [job.key for job in jobs]
    by_key = dict(zip(keys, jobs, strict=True))
    makers = makers_of(jobs, measure)
    done = store.kept(by_key, makers)
    for folder in also:
        store.take(folder, by_key, makers)
    if also:
        done = store.kept(by_key, makers)
    left = [number for number, key in enumerate(keys) if key not in done]
    with (
        _going_on(store, done, len(jobs)),
        tqdm(total=len(jobs), initial=len(jobs) - len(left), disable=None, unit="case") as bar,
    ):
        told, lines = monotonic(), not sys.stderr.isatty()  # a log has no place for a bar
        for number, row in place([jobs[number] for number in left], measure):
            if lines and monotonic() - told > TELL_S:
                told = monotonic()
                say(f"{len(done)} of {len(jobs)} cases")
            key = keys[left[number]]
            done[key] = {**labels[left[number]], **row}
            store.add(key, done[key], makers[jobs[left[number]].source])
            bar.update()
            if ended:
                raise KeyboardInterrupt(ended[0])
    return [done[key] for key in keys]


def makers_of(jobs: Sequence[Job], measure: Measure) -> dict[str, Maker]:
    """Return what makes the rows of each source now."""
    sources = {job.source: job for job in jobs}
    return {name: maker_of(job.asked, measure) for name, job in sources.items()}


@contextmanager
def _going_on(store: Store, done: dict[str, Row], count: int) -> Iterator[None]:
    """Say of a run that ends early how many rows are kept, and how to go on."""
    try:
        yield
    except (KeyboardInterrupt, BadInputError, OSError) as stop:
        kept = f"{len(done)} of {count} rows are kept in {str(store.folder)!r}"
        text = f"{kept}; the same command goes on from there"
        if isinstance(stop, KeyboardInterrupt):
            stop.args = (*stop.args[:1], text)
            raise
        raise BadInputError(f"{stop}; {text}") from stop


def exit_code(rows: Sequence[Row], shown: int = 10) -> int:
    """Return 0 if every row is usable; else name some that failed on stderr and return 1."""
    failed = [row for row in rows if row["outcome"] == Outcome.FAILED.value]
    for row in failed[:shown]:
        case = ", ".join(f"{name} {row[name]}" for name in row if name in LABELS)
        print(f"failed: {row['source']}{case and ', '}{case}: {row['message']}", file=sys.stderr)
    if len(failed) > shown:
        print(f"failed: {len(failed) - shown} more", file=sys.stderr)
    return 1 if failed else 0
