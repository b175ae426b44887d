"""One decorator for every compiled kernel of the reference."""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., Any])


def kernel(function: Function) -> Function:
    """Compile `function` at its first call, keep the result on disk, release the GIL.

    No operation is merged with another: whether it is would depend on what the compiler inlines,
    and the last digit on which process compiled.
    """
    compile_ = numba.njit(cache=True, nogil=True, error_model="numpy")
    return cast(Function, compile_(function))


def forget_what_changed(folder: Path) -> None:
    """Delete a folder's compiled kernels if one of its modules has changed since.

    numba sees a change of a kernel's own module, not of a kernel that it calls in another one.
    """
    text = b"\0".join(path.read_bytes() for path in sorted(folder.rglob("*.py")))
    stamp, cache = hashlib.sha256(text).hexdigest(), folder / "__pycache__"
    mark = cache / "kernels.txt"
    try:
        if mark.is_file() and mark.read_text() == stamp:
            return
        for kept in folder.rglob("*.nb[ci]"):
            kept.unlink(missing_ok=True)
        cache.mkdir(exist_ok=True)
        mark.write_text(stamp)
    except OSError:
        # a folder that cannot be written holds no kernels of an earlier version either
        return


forget_what_changed(Path(__file__).parents[1])
