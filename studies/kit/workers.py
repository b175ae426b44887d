"""Processes that do one task after another; one that ends takes one task with it, not the run."""

import ctypes
import os
import resource
import signal
import sys
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from typing import Any

from studies.kit.app import postpone
from studies.kit.say import one_line

MEMORY_BYTES = 4_000_000_000
"""What a process may allocate [byte]; only Linux keeps it to that."""
LOADING_S = 300.0
"""How long a process may take to start and to load what a task needs [s]."""


@dataclass(frozen=True, slots=True)
class Lost:
    """A task without an answer: why, in one line, and whether it ran out of time."""

    why: str
    late: bool = False


def answers(
    call: Callable[..., Any], tasks: Sequence[tuple[Any, ...]], workers: int, limit_s: float
) -> Iterator[tuple[int, Any]]:
    """Yield the number of each task with what ``call(*task)`` returns, or a `Lost`, as they end."""
    waiting, idle, busy = deque(enumerate(tasks)), list[_Worker](), list[_Worker]()
    try:
        while waiting or busy:
            while waiting and len(busy) < workers:
                worker = idle.pop() if idle else _Worker()
                worker.give(call, *waiting.popleft())
                busy.append(worker)
            first = min(worker.until for worker in busy) - time.monotonic()
            ends = [end for worker in busy for end in (worker.channel, worker.process.sentinel)]
            wait(ends, max(first, 0.0))
            for worker in list(busy):
                if (answer := worker.look(limit_s)) is not None:
                    busy.remove(worker)
                    idle += [worker] * worker.process.is_alive()
                    yield worker.number, answer[0]
    finally:
        for worker in (*busy, *idle):
            worker.end()


class _Worker:
    """A process, seen from the one that gives it tasks."""

    def __init__(self) -> None:
        context = get_context("spawn")  # engines hold state of their own, which no fork may share
        self.channel, theirs = context.Pipe()
        self.process = context.Process(target=_serve, args=(theirs,))
        # what a terminal sends to all in it waits meanwhile
        before = signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT, signal.SIGHUP))
        try:
            self.process.start()
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
        theirs.close()
        self.number, self.until = -1, 0.0

    def give(self, call: Callable[..., Any], number: int, task: tuple[Any, ...]) -> None:
        self.number, self.until = number, time.monotonic() + LOADING_S
        with suppress(BrokenPipeError):  # it has ended: its exit code will say more
            self.channel.send((call, task))

    def look(self, limit_s: float) -> tuple[Any] | None:
        """Return its answer or the `Lost` as which it ended; None while it works."""
        try:
            while self.channel.poll():
                found: tuple[Any] | None = self.channel.recv()
                if found is not None:
                    return found
                self.until = time.monotonic() + limit_s  # it has loaded: its time runs from here
        except (EOFError, OSError):
            self.process.join(1.0)
        except Exception as error:
            self.end()
            return (Lost(f"its answer cannot be read: {one_line(error)}"),)
        if not self.process.is_alive():
            self.end()
            return (Lost(_end_of(self.process.exitcode or 0)),)
        if time.monotonic() < self.until:
            return None
        self.end()
        return (Lost(f"no result within the time limit of {limit_s:g} s", late=True),)

    def end(self) -> None:
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(self.process.pid or 0, signal.SIGKILL)
        self.process.kill()
        self.process.join()
        self.channel.close()


def _end_of(code: int) -> str:
    if code < 0:
        return f"the process was ended by signal {signal.Signals(-code).name}"
    return f"the process ended by itself with exit code {code}"


def _prepare() -> None:
    """Take this process away from the user's terminal, and bound its memory."""
    os.setsid()  # a group of its own: it does not see Ctrl-C, and is ended with all it started
    nowhere = os.open(os.devnull, os.O_RDWR)
    for number in range(3):
        os.dup2(nowhere, number)
    if sys.platform == "linux":
        libc = ctypes.CDLL(None)
        libc.prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG: it ends with its parent
        libc.mallopt(-3, 1 << 20)  # M_MMAP_THRESHOLD: what is large is given back when it is freed
        known = [each for each in resource.getrlimit(resource.RLIMIT_DATA) if each >= 0]
        bound = min([MEMORY_BYTES, *known])
        resource.setrlimit(resource.RLIMIT_DATA, (bound, bound))


def _serve(channel: Connection) -> None:
    _prepare()
    postpone("pandas")  # a measure's module imports it; few measures use it
    me = os.getpid()
    while True:
        try:
            call, task = channel.recv()
        except EOFError:
            return
        except BaseException as error:
            channel.send((Lost(one_line(error)),))
            continue
        channel.send(None)
        try:
            answer = call(*task)
        except BaseException as error:
            answer = Lost(one_line(error))
        if os.getpid() != me:
            os._exit(0)  # a fork that the task has forgotten
        try:
            channel.send((answer,))
        except Exception as error:  # what cannot be sent
            channel.send((Lost(one_line(error)),))
