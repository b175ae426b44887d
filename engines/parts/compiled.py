"""What compiled functions of engines are made of: a decorator, and the numbers that they keep.

There is one source for both uses: where numba is switched off, as by NUMBA_DISABLE_JIT=1, the same
functions run as Python.
"""

from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Self, TypeVar, cast, get_args, get_origin, get_type_hints

import numba
import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from analytic.kernels.compiled import keeper

FloatArray = NDArray[np.float64]

PACKAGE = Path(__file__).parents[__name__.count(".") - 1]
"""The folder of the package that holds the engines' kernels and all that they call."""

kernel = keeper(PACKAGE)
"""Compile a function at its first call; see `analytic.kernels.compiled.keeper`."""

exclusive = keeper(PACKAGE, nogil=False)
"""Compile, as `kernel`, what calls a library that keeps some of its numbers for the whole process:
no other thread of Python runs meanwhile."""

Function = TypeVar("Function", bound=Callable[..., Any])


SWITCHED_OFF = "numba is switched off"


def switched_off() -> bool:
    """Return whether compiled functions run as Python."""
    settings: Any = numba.config
    return bool(settings.DISABLE_JIT)


def shared(function: Function) -> Function:
    """Let kernels call a function, compiled into them; called from Python it remains Python."""
    return register_jitable(error_model="numpy", no_cfunc_wrapper=True)(function)


class State:
    """Numbers under names, which a compiled function reads and writes in place.

    A subclass names its fields, each a float, an int, a bool, another state, or an array of
    floats: ``Annotated[FloatArray, (4, 4)]``. What is made of it is one of numpy's records, which
    stay in an array.
    """

    @classmethod
    @cache
    def kind(cls) -> np.dtype[np.void]:
        """Return the names and kinds of the fields."""
        hints = get_type_hints(cls, include_extras=True)
        return np.dtype([(name, *_kind(hint)) for name, hint in hints.items()], align=True)

    @classmethod
    def blank(cls, count: int = 1) -> Sequence[Self]:
        """Return an array of such states, all zeros; a state alone is slow to hand over."""
        return cast(Sequence[Self], np.zeros(count, np.dtype((np.record, cls.kind()))))


def _kind(hint: Any) -> tuple[Any, ...]:
    if get_origin(hint) is Annotated:
        return (np.float64, get_args(hint)[1])
    return (hint.kind() if issubclass(hint, State) else np.dtype(hint),)


def fill(state: State, **values: float) -> None:
    """Set fields of a state."""
    for name, value in values.items():
        setattr(state, name, value)
