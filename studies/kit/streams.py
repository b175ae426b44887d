"""Standard streams that can be written to, whatever the process was started with."""

import io
import os
import sys
from contextlib import suppress


def prepare() -> None:
    """Send what goes to a closed stream nowhere, and show what a terminal cannot as marks.

    A descriptor that stays free would be taken by the next file that is opened, and whatever an
    engine prints would go into it.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)
    sys.stdout = sys.stdout or os.fdopen(1, "w", closefd=False)
    sys.stderr = sys.stderr or os.fdopen(2, "w", closefd=False)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            # a terminal without Greek letters shows question marks instead
            stream.reconfigure(errors="replace")


def say(line: str) -> None:
    """Write a line to stderr, if somebody is there to read it."""
    with suppress(OSError):
        print(line, file=sys.stderr)


def finish() -> None:
    """Write what is waiting to be written, or give it up where that has failed before."""
    try:
        sys.stdout.flush()
    except OSError:
        give_up_output()


def give_up_output() -> None:
    """Send further output nowhere, what is waiting to be written included."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
