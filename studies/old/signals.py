"""Signals that end a run: the first one unwinds it, and those that follow do not disturb that."""

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
AGAIN_S = 0.02
"""How long to wait for a callback to return that has swallowed an exception [s]."""

_raised = False


class Ended(KeyboardInterrupt):
    """Raised in place of a `KeyboardInterrupt` when one of the signals ENDING comes."""

    def __init__(self, number: int) -> None:
        super().__init__()
        self.number = number


def install() -> None:
    """Let a signal raise `Ended`, unless whoever started the process wants it ignored."""
    for number in ENDING:
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, _end)
    sys.unraisablehook = _on_lost


def ignore() -> None:
    """Let no further signal disturb the end of the process."""
    for number in ENDING:
        signal.signal(number, signal.SIG_IGN)


def _end(number: int, _: FrameType | None) -> None:
    global _raised
    if not _raised:
        _raised = True
        raise Ended(number)


def _on_lost(lost: "sys.UnraisableHookArgs") -> None:
    """Deal with an exception that a destructor or a callback of the compiler swallows."""
    if not _raised:
        sys.__unraisablehook__(lost)
    elif isinstance(lost.exc_value, Ended):
        threading.Timer(AGAIN_S, _raise_again, [lost.exc_value.number]).start()


def _raise_again(number: int) -> None:
    global _raised
    _raised = False
    os.kill(os.getpid(), number)


@contextmanager
def left_to_this_process() -> Iterator[None]:
    """Keep the terminal's signals from processes that start meanwhile: this one ends them."""
    from multiprocessing.resource_tracker import ensure_running

    # it unblocks SIGINT when it starts, and every process needs it
    ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGHUP})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
