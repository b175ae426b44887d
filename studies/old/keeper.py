"""A process whose end is the end of all that it started: children, theirs, and those that left it.

It works in a child, and stays behind to end what that leaves running. Linux gives it whoever loses
a parent; elsewhere a process has no keeper, and what it started outlives it.
"""

import ctypes
import os
import resource
import signal
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import NoReturn

END_WITH_PARENT, ADOPT = 1, 36
"""Linux: PR_SET_PDEATHSIG, PR_SET_CHILD_SUBREAPER."""


def work_in_a_child() -> None:
    """Return in a child of this process, which ends as that does, and everything else with it.

    A SIGTERM ends all of them, as does the end of the thread that started this process.
    """
    if sys.platform != "linux":
        return
    _end_with_parent(signal.SIGTERM)
    _control(ADOPT, 1)
    signal.signal(signal.SIGTERM, lambda *_: _end(-signal.SIGTERM))
    child, ended = os.fork(), 0
    if child:
        while ended != child:  # or one of those that were left to this process
            ended, status = os.wait()
        _end(os.waitstatus_to_exitcode(status))
    os.setsid()
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    _end_with_parent(signal.SIGKILL)


def _end_with_parent(number: int) -> None:
    _control(END_WITH_PARENT, number)
    if os.getppid() == 1:  # it has ended meanwhile
        os._exit(1)


def _control(what: int, value: int) -> None:
    ctypes.CDLL(None).prctl(what, ctypes.c_ulong(value), 0, 0, 0)


def _end(code: int) -> NoReturn:
    """End every descendant, and then this process with an exit code, or by a signal -code."""
    with suppress(ChildProcessError):
        while True:
            for child in _children():
                with suppress(OSError):
                    os.kill(child, signal.SIGKILL)
            os.wait()  # the children of one that ends are this process's from then on
    if code < 0:
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        with suppress(OSError):  # SIGKILL has no handler
            signal.signal(-code, signal.SIG_DFL)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, [-code])
        os.kill(os.getpid(), -code)
    os._exit(code)


def _children() -> Iterator[int]:
    for process in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            # behind its name, which may be anything: state, parent, ...
            words = (process / "stat").read_text(errors="replace").rpartition(")")[2].split()
            if int(words[1]) == os.getpid():
                yield int(process.name)
