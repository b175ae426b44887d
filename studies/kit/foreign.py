"""Engines of other packages: each is loaded once by a process of its own before it is loaded here.

An import may end or stop the process in which it runs: that is then a line, and not the end of a
command.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from engines import registry
from engines.declaration import Engine
from engines.registry import UnloadableError
from studies.kit.workers import Lost, answers

LOADING_S = 60.0
"""How long an engine of another package may take to be loaded [s]."""


@contextmanager
def tried_apart() -> Iterator[None]:
    """Let an engine of another package be loaded here only after another process has loaded it."""

    def loaded(name: str) -> Engine:
        apart(_load, name)
        return registry.loaded(name)

    registry.elsewhere = loaded
    try:
        yield
    finally:
        registry.elsewhere = None


def _load(name: str) -> None:
    registry.loaded(name)


def apart(call: Callable[..., Any], engine: str) -> Any:
    """Return what a function returns for an engine, in a process of its own.

    UnloadableError if it raises, or its process ends or takes longer than `LOADING_S`.
    """
    ((_, answer),) = answers(_tried, [(call, engine)], 1, LOADING_S)
    if isinstance(answer, Lost):
        raise UnloadableError(f"engine {engine!r} cannot be loaded: {answer.why}")
    found, problem = answer
    if problem:
        raise UnloadableError(problem)
    return found


def _tried(call: Callable[..., Any], engine: str) -> tuple[Any, str]:
    try:
        return call(engine), ""
    except ValueError as error:
        return None, str(error)
