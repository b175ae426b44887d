"""Processes that do one task after another, whatever the tasks do to them.

Each has a thread of this process, which waits for it no longer than a task may take, starts another
in its place when it ends, and ends it with all that it started.
"""

import atexit
import os
import resource
import sys
import time
from collections.abc import Callable
from concurrent.futures import CancelledError, Future
from contextlib import suppress
from multiprocessing import get_context
from pathlib import Path
from queue import SimpleQueue
from threading import Event, Thread
from typing import TYPE_CHECKING, Any, NamedTuple, Self

from studies.kit.keeper import work_in_a_child
from studies.kit.refusing import one_line
from studies.kit.signals import left_to_this_process

if TYPE_CHECKING:
    from multiprocessing.connection import Connection

LOOK_S = 0.1
"""How long to wait for an answer before asking whether somebody is left to give it [s]."""
LOADING_S = 300.0
"""How long a process may take to load what a task needs [s]."""
ENDING_S = 5.0
"""How long a process may take to end what it has started [s]."""
MEMORY_BYTES = 4e9
"""What a process may take beside what it begins with [byte]; only Linux keeps it to that."""


class EndedError(Exception):
    """A process that ended before it gave an answer; a negative exit code is that of a signal."""

    def __init__(self, exitcode: int) -> None:
        super().__init__(exitcode)
        self.exitcode = exitcode


class OvertimeError(Exception):
    """A task that took longer than it may."""


class TaskError(Exception):
    """What a task raised, in one line."""


class StartError(Exception):
    """A process that could not be started."""


class Task(NamedTuple):
    """What to call, and for how long at most [s]."""

    future: Future[Any]
    call: Callable[..., Any]
    arguments: tuple[Any, ...]
    limit_s: float


class Pool:
    """So many processes, started when there is something to do.

    Parameters
    ----------
    workers : int
    """

    def __init__(self, workers: int) -> None:
        self._tasks: SimpleQueue[Task | None] = SimpleQueue()
        self._stopped = Event()
        self._threads = [Thread(target=self._serve, daemon=True) for _ in range(workers)]
        with left_to_this_process():
            for thread in self._threads:
                thread.start()
        atexit.register(self.stop)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def schedule(
        self, call: Callable[..., Any], arguments: tuple[Any, ...], limit_s: float
    ) -> Future[Any]:
        """Let a process call a function.

        Returns
        -------
        Future
            Of what it returns; EndedError, OvertimeError, TaskError or StartError if nothing, and
            CancelledError once the pool is stopped.
        """
        if self._stopped.is_set():
            raise CancelledError
        task = Task(Future(), call, arguments, limit_s)
        self._tasks.put(task)
        return task.future

    def stop(self) -> None:
        """End every process; return when they have ended."""
        atexit.unregister(self.stop)
        self._stopped.set()
        for _ in self._threads:
            self._tasks.put(None)
        for thread in self._threads:
            thread.join()

    def _serve(self) -> None:
        worker: _Worker | None = None
        while task := self._tasks.get():
            try:
                if worker and not worker.process.is_alive():
                    worker.end()
                    worker = None
                worker = worker or _Worker(self._stopped)
                task.future.set_result(worker.answer(task))
            except TaskError as error:
                task.future.set_exception(error)
            except BaseException as error:
                if worker:
                    worker.end()
                worker, known = None, isinstance(error, Exception)
                task.future.set_exception(error if known else TaskError(one_line(error)))
        if worker:
            worker.end()


class _Worker:
    """A process, as the thread sees it that gives it tasks."""

    def __init__(self, stopped: Event) -> None:
        self._stopped = stopped
        if stopped.is_set():
            raise CancelledError
        # engines hold state of their own: no fork of a process that has loaded them
        context = get_context("spawn")
        try:
            self._channel, theirs = context.Pipe()
            self.process = context.Process(target=_work, args=(theirs,))
            self.process.start()
        except (OSError, EOFError) as error:
            raise StartError(str(error)) from error
        theirs.close()

    def answer(self, task: Task) -> Any:
        """Return what a task returns; see `Pool.schedule`."""
        with suppress(BrokenPipeError):  # it has ended: its exit code says more
            self._channel.send((task.call, task.arguments))
        self._receive(LOADING_S)
        done, answer = self._receive(task.limit_s)
        if not done:
            raise TaskError(answer)
        return answer

    def end(self) -> None:
        """End the process and all that it started."""
        self.process.terminate()
        self.process.join(ENDING_S)
        self.process.kill()
        self.process.join()
        self._channel.close()

    def _receive(self, limit_s: float) -> Any:
        deadline = time.monotonic() + limit_s
        while not self._channel.poll(max(min(LOOK_S, deadline - time.monotonic()), 0.0)):
            if self._stopped.is_set():
                raise CancelledError
            if time.monotonic() > deadline:
                raise OvertimeError
            if not self.process.is_alive() and not self._channel.poll():
                raise EndedError(self.process.exitcode or 0)
        try:
            return self._channel.recv()
        except (EOFError, ConnectionResetError):
            self.process.join(ENDING_S)
            raise EndedError(self.process.exitcode or 0) from None


def _work(channel: "Connection") -> None:
    """Do in a process of its own what comes along a channel."""
    work_in_a_child()
    _be_silent()
    _bound_memory()
    while True:
        try:
            call, arguments = channel.recv()
        except EOFError:
            return
        except BaseException as error:
            channel.send(None)
            channel.send((False, one_line(error)))
            continue
        channel.send(None)  # what it needs is loaded: its time runs from here
        channel.send(_answer(call, arguments))


def _answer(call: Callable[..., Any], arguments: tuple[Any, ...]) -> tuple[bool, Any]:
    asked = os.getpid()
    try:
        return True, call(*arguments)
    except BaseException as error:  # nobody interrupts this process: it is the task's own
        return False, one_line(error)
    finally:
        if os.getpid() != asked:
            os._exit(0)  # a fork that the task has forgotten


def _be_silent() -> None:
    """Read from nowhere and write to nowhere: both are the user's."""
    nowhere = os.open(os.devnull, os.O_RDWR)
    for number in range(3):
        os.dup2(nowhere, number)


def _bound_memory() -> None:
    if sys.platform == "linux":
        held = int(Path("/proc/self/statm").read_text().split()[5]) * resource.getpagesize()
        bound = int(held + MEMORY_BYTES)
        for known in resource.getrlimit(resource.RLIMIT_DATA):  # the user's own bound holds too
            bound = bound if known == resource.RLIM_INFINITY else min(bound, known)
        resource.setrlimit(resource.RLIMIT_DATA, (bound, bound))
