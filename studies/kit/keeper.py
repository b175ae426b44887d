"""A process whose end is the end of all that it started: children, theirs, and those that left it.

It works in a child, and stays behind to end what that leaves running. Linux gives it whoever loses
a parent; elsewhere a process has no keeper, and what it started outlives it.
"""

import ctypes
import os
import resource
import signal
import sys
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
    child = os.fork()
    if child:
        _end(_exit_code_of(child))
    os.setsid()
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    _end_with_parent(signal.SIGKILL)


def _end_with_parent(number: int) -> None:
    _control(END_WITH_PARENT, number)
    if os.getppid() == 1:  # it has ended meanwhile
        os._exit(1)


def _control(what: int, value: int) -> None:
    ctypes.CDLL(None).prctl(what, ctypes.c_ulong(value), 0, 0, 0)


def _exit_code_of(child: int) -> int:
    """Wait for a child, and for those that were left to this process meanwhile."""
    while True:
        ended, status = os.wait()
        if ended == child:
            return os.waitstatus_to_exitcode(status)


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


def _children() -> list[int]:
    return [int(path.name) for path in Path("/proc").glob("[0-9]*") if _parent(path) == os.getpid()]


def _parent(process: Path) -> int:
    try:
        # behind its name, which may be anything: state, parent, ...
        return int((process / "stat").read_text(errors="replace").rpartition(")")[2].split()[1])
    except OSError:
        return 0
