"""One decorator for every compiled kernel of the reference."""

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., Any])


def kernel(function: Function) -> Function:
    """Compile `function` at its first call, keep the result on disk, release the GIL.

    Sums may be reordered and contracted; infinities and NaN keep their meaning.
    """
    compile_ = numba.njit(
        cache=True, nogil=True, error_model="numpy", fastmath={"reassoc", "contract", "nsz"}
    )
    return cast(Function, compile_(function))
