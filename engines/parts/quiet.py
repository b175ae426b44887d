"""Silence for libraries that write past Python to the output of the whole process."""

import contextlib
import os
import sys
import warnings
from collections.abc import Iterator
from importlib import import_module
from typing import Any


@contextlib.contextmanager
def silence() -> Iterator[None]:
    """Let nothing reach the process's output and error streams while the context lasts."""
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.flush()
    kept = {number: os.dup(number) for number in (1, 2)}
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        for number in kept:
            os.dup2(nowhere, number)
        yield
    finally:
        os.close(nowhere)
        for number, copy in kept.items():
            os.dup2(copy, number)
            os.close(copy)


def imported(library: str) -> Any:
    """Import a library without what it writes past Python, and without its warnings."""
    if library in sys.modules:
        return sys.modules[library]
    with silence(), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return import_module(library)
