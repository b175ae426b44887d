"""Processes that do one task after another, whatever the tasks do to them.

Each is waited for no longer than its task may take; it is ended with all that it started, and
another one is started when it is needed.
"""

import io
import os
import pickle
import resource
import signal
import sys
from collections.abc import Callable
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from contextlib import suppress
from multiprocessing import Pipe, get_context
from multiprocessing.connection import Connection, wait
from pathlib import Path
from threading import Lock
from typing import Any, Self

from studies.old.keeper import work_in_a_child
from studies.old.refusing import one_line
from studies.old.signals import left_to_this_process

LOADING_S = 300.0
"""How long a process may take to load what a task needs [s]."""
ENDING_S = 5.0
"""How long a process may take to end what it has started [s]."""
MEMORY_BYTES = 2e9
"""What a process may take beside what it begins with [byte]; only Linux keeps it to that."""


class TaskError(Exception):
    """Why a task returns nothing, in one line: what it raised, or how its process ended."""


class OvertimeError(TaskError):
    """A task that took longer than it may."""


class StartError(Exception):
    """A process that could not be started."""


class Pool:
    """So many processes, started when there is something to do.

    Parameters
    ----------
    workers : int

    Attributes
    ----------
    preparing : Lock
        Held by who compiles what its processes need.
    prepared : set of str
        Names of the sources for which that is done.
    loaded : set of str
        Names of the sources whose kernels this process itself has loaded meanwhile.
    """

    def __init__(self, workers: int) -> None:
        self.preparing, self.prepared, self.loaded = Lock(), set[str](), set[str]()
        # a thread for each process: who starts one must live as long
        self._threads = ThreadPoolExecutor(workers)
        self._idle: list[_Worker] = []
        self._stopped, self._stop = Pipe(duplex=False)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def schedule(
        self, call: Callable[..., Any], arguments: tuple[Any, ...], limit_s: float
    ) -> Future[Any]:
        """Let a process call a function.

        Parameters
        ----------
        call, arguments : callable, tuple
            Sent to the process; the function is one of a module.
        limit_s : float
            How long the call may take [s], without what it must first load.

        Returns
        -------
        Future
            Of what it returns; TaskError if nothing, OvertimeError if not in time, StartError if
            there is no process, and CancelledError once the pool is stopped.
        """
        if self._stop.closed:
            raise CancelledError
        with left_to_this_process():
            return self._threads.submit(self._do, call, arguments, limit_s)

    def stop(self) -> None:
        """End every process; return when they have ended."""
        self._stop.close()
        self._threads.shutdown(cancel_futures=True)
        for worker in self._idle:
            worker.end()
        self._stopped.close()

    def _do(self, call: Callable[..., Any], arguments: tuple[Any, ...], limit_s: float) -> Any:
        worker = self._worker()
        try:
            done, answer = worker.answer(call, arguments, limit_s)
        except BaseException as error:
            worker.end()
            if isinstance(error, Exception):
                raise
            raise TaskError(one_line(error)) from None
        self._idle.append(worker)
        if not done:
            raise TaskError(answer)
        return answer

    def _worker(self) -> "_Worker":
        with suppress(IndexError):
            worker = self._idle.pop()
            if worker.process.is_alive():
                return worker
            worker.end()
        return _Worker(self._stopped)


class _Worker:
    """A process, as the thread sees it that gives it a task."""

    def __init__(self, stopped: Connection) -> None:
        self._stopped = stopped
        # engines hold state of their own: no fork of a process that has loaded them
        context = get_context("spawn")
        try:
            self._channel, theirs = context.Pipe()
            self.process = context.Process(target=_work, args=(theirs,))
            self.process.start()
        except (OSError, EOFError) as error:
            raise StartError(str(error)) from error
        theirs.close()

    def answer(self, call: Callable[..., Any], arguments: tuple[Any, ...], limit_s: float) -> Any:
        """Return whether a call succeeded, and what it returned or raised."""
        with suppress(BrokenPipeError):  # it has ended: its exit code says more
            self._channel.send((call, arguments))
        self._receive(LOADING_S)
        return self._receive(limit_s)

    def end(self) -> None:
        """End the process and all that it started."""
        self.process.terminate()
        self.process.join(ENDING_S)
        self.process.kill()
        self.process.join()
        self._channel.close()

    def _read(self, answer: bytes) -> Any:
        try:
            return _Reader(io.BytesIO(answer)).load()
        except Exception as error:
            raise TaskError(f"its answer cannot be read: {one_line(error)}") from None

    def _receive(self, limit_s: float) -> Any:
        ready = wait([self._channel, self.process.sentinel, self._stopped], limit_s)
        if not ready:
            raise OvertimeError(f"not within {limit_s:g} s")
        if self._stopped in ready:
            raise CancelledError
        with suppress(EOFError, ConnectionResetError):
            if self._channel.poll():
                return self._read(self._channel.recv_bytes())
        self.process.join(ENDING_S)
        raise TaskError(_cause_of_death(self.process.exitcode or 0))


class _Reader(pickle.Unpickler):
    """Reads an answer, for which no package is loaded that is not: it may be anybody's code."""

    def find_class(self, module: str, name: str) -> Any:
        if module.partition(".")[0] not in sys.modules:
            raise pickle.UnpicklingError(f"{module}.{name} is not loaded here")
        return super().find_class(module, name)


def _cause_of_death(exitcode: int) -> str:
    if exitcode < 0:
        return f"the process was ended by signal {signal.Signals(-exitcode).name}"
    return f"the process ended by itself with exit code {exitcode}"


def _work(channel: Connection) -> None:
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
        answer = _answer(call, arguments)
        try:
            channel.send(answer)
        except Exception as error:  # it cannot be sent
            channel.send((False, one_line(error)))


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
