"""One decorator for every compiled kernel of the reference."""

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., Any])


def kernel(function: Function) -> Function:
    """Compile `function` at its first call, keep the result on disk, release the GIL.

    A product and a sum may become one operation; nothing is reordered, since then the compiler
    may take x - x for zero, infinite or not.
    """
    compile_ = numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
    return cast(Function, compile_(function))
