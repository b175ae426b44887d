"""What compiled functions of engines are made of: a decorator, and the numbers that they keep.

There is one source for both uses: where a few cases are interpreted, and where numba is switched
off, as by NUMBA_DISABLE_JIT=1, the same functions run as Python.
"""

import os
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Self, TypeVar, cast, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from analytic.kernels.compiled import (
    MENDED,
    Purse,
    SpentError,
    interpreted,
    interpreting,
    keeper,
    maker,
    spend,
)

__all__ = ["interpreted", "spend"]

FloatArray = NDArray[np.float64]

PACKAGE = Path(__file__).parents[__name__.count(".") - 1]
"""The folder of the package that holds the engines' kernels and all that they call."""

kernel = keeper(PACKAGE)
"""Let a function be called from Python in either form; see `analytic.kernels.compiled.keeper`."""

shared = maker
"""Let kernels call a function, compiled into them; called from Python it remains Python."""

PURSE = Purse(PACKAGE, loading=20_000, compiling=100_000)

Answer = TypeVar("Answer")


def switched_off() -> bool:
    """Return whether compiled functions run as Python."""
    return os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")


def interpreted_first(run: Callable[[], Answer]) -> Answer:
    """Return what a run answers: interpreted, if this process still may; else compiled."""
    if PURSE.open:
        try:
            with interpreting(PURSE):
                return run()
        except (SpentError, *MENDED):
            pass
    return run()


class State:
    """Numbers under names, which functions read and write in place.

    A subclass names its fields, each a float, an int, a bool, another state, or an array of
    floats: ``Annotated[FloatArray, (4, 4)]``. For compiled functions what is made of it is one of
    numpy's records, which stay in an array; for Python, which reads those slowly, an object.
    """

    @classmethod
    @cache
    def kind(cls) -> np.dtype[np.void]:
        """Return the names and kinds of the fields."""
        return np.dtype([(name, *_kind(hint)) for name, hint in cls.fields().items()], align=True)

    @classmethod
    @cache
    def record(cls) -> np.dtype[np.void]:
        """Return the same for arrays: one object, or numba would compare two at every call."""
        return np.dtype((np.record, cls.kind()))

    @classmethod
    @cache
    def fields(cls) -> dict[str, Any]:
        """Return what the fields are declared as."""
        return get_type_hints(cls, include_extras=True)

    @classmethod
    def blank(cls, count: int = 1) -> Sequence[Self]:
        """Return an array of such states, all zeros; a state alone is slow to hand over."""
        if interpreted():
            return [cls.plain() for _ in range(count)]
        return cast(Sequence[Self], np.zeros(count, cls.record()))

    @classmethod
    def plain(cls) -> Self:
        """Return such a state as an object."""
        state = cls()
        for name, hint in cls.fields().items():
            setattr(state, name, _zero(hint))
        return state


def _kind(hint: Any) -> tuple[Any, ...]:
    if get_origin(hint) is Annotated:
        return (np.float64, get_args(hint)[1])
    return (hint.kind() if issubclass(hint, State) else np.dtype(hint),)


def _zero(hint: Any) -> Any:
    if get_origin(hint) is Annotated:
        return np.zeros(get_args(hint)[1])
    return hint.plain() if issubclass(hint, State) else hint()


def fill(state: State, **values: float) -> None:
    """Set fields of a state."""
    for name, value in values.items():
        setattr(state, name, value)
