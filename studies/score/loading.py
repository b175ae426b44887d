"""Code from outside, loaded first where it can do no harm, and then under guard."""

import os
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from engines.registry import announce
from studies.kit.pool import Pool, TaskError
from studies.kit.signals import ENDING

LOADING_S = 60.0
"""How long an engine from outside may take to be loaded [s]."""


def problem_elsewhere(place: str) -> str:
    """Load an engine in a process of its own; say why that cannot be done, or nothing.

    Parameters
    ----------
    place : str
        As in `engines.registry.announce`.
    """
    with Pool(1) as pool:
        try:
            return str(pool.schedule(problem_of, (place,), LOADING_S).result())
        except TaskError as error:
            return f"engine {place!r} cannot be loaded: {error}"


def problem_of(place: str) -> str:
    """Make an engine known to this process; say why that cannot be done, or nothing."""
    try:
        announce(place)
    except ValueError as error:
        return str(error)
    return ""


@contextmanager
def guarded() -> Iterator[None]:
    """Take back afterwards what code may have changed: streams, folder, clock and signals.

    What it prints goes nowhere.
    """
    streams, folder, clock = (sys.stdin, sys.stdout, sys.stderr), Path.cwd(), dict(vars(time))
    handlers = {number: signal.getsignal(number) for number in ENDING}
    sys.stdout.flush()
    copies = [os.dup(number) for number in range(3)]
    with Path(os.devnull).open("r+") as nowhere:
        for number in range(3):
            os.dup2(nowhere.fileno(), number)
        sys.stdin = sys.stdout = sys.stderr = nowhere
        try:
            yield
        finally:
            sys.stdin, sys.stdout, sys.stderr = streams
            for number, copy in enumerate(copies):
                os.dup2(copy, number)
                os.close(copy)
            os.chdir(folder)
            vars(time).update(clock)
            for number, handler in handlers.items():
                if signal.getsignal(number) is not handler:
                    signal.signal(number, handler)
