"""Kernels in two forms, which agree to the bit: Python for a few short cases, compiled for more.

A kernel, and all that it calls, is a plain function of numbers, named tuples and arrays. To load
what was compiled takes as long as some thousand steps in Python, and to compile it some 20 s, once
for each version of the sources. So how many cases there are and how long they take decide
beforehand which form is called.
"""

import inspect
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any, ClassVar, Generic, ParamSpec, TypeVar

import numpy as np

from analytic.kernels.kept import FULL, cache_folder, holds, kept_in

Given = ParamSpec("Given")
Answer = TypeVar("Answer")

SOURCES = Path(__file__).parents[__name__.count(".") - 1]
"""The folder of the package that holds the reference's kernels and all that they call."""
FEW_CASES, FEW_STEPS = 200, 3000
"""Cases of a process, and steps of one, up to which Python takes less time."""
PLAIN = {"error_model": "numpy", "no_cfunc_wrapper": True}
"""How what kernels call is compiled."""

_compiling = threading.RLock()
_known = set[Callable[..., Any]]()
"""What compiled code may call."""


class Kernel(Generic[Given, Answer]):
    """A function in both forms, kept with other kernels of a package (`sources`).

    It may change arrays in named tuples alone, and makes none unless it is said to (`arrays`).
    """

    tell: ClassVar[Callable[[str], None] | None] = None
    """Who is told, the first time, that compiling begins."""
    cases: ClassVar[float] = 0
    """Cases that this process has solved."""

    def __init__(
        self, function: Callable[Given, Answer], sources: Path = SOURCES, *, arrays: bool = False
    ) -> None:
        self.function, self._sources, self._arrays = function, sources, arrays
        self._compiled: Callable[Given, Answer] | None = None

    def few(self, cases: int, steps: float) -> Callable[Given, Answer]:
        """Return the form for so many more cases of so many steps each."""
        Kernel.cases += cases
        return self.python if Kernel.cases <= FEW_CASES and steps <= FEW_STEPS else self.compiled

    def python(self, *given: Given.args, **named: Given.kwargs) -> Answer:
        """Answer in Python; where that raises, compiled code goes on with inf or nan."""
        lists: Any = [each.tolist() if isinstance(each, np.ndarray) else each for each in given]
        try:
            with np.errstate(divide="raise", over="raise", invalid="raise"):
                return self.function(*lists, **named)
        except (ArithmeticError, ValueError):
            return self.compiled(*given, **named)

    def compiled(self, *given: Given.args, **named: Given.kwargs) -> Answer:
        """Answer by compiled code; where it cannot be kept, it is compiled without."""
        if self._compiled is None:
            self._compiled = compiled(self.function, kept_in(self._sources), self._arrays)
        try:
            return self._compiled(*given, **named)
        except OSError as error:
            if error.errno not in FULL:
                raise
            self._compiled = compiled(self.function, None, self._arrays)
            return self._compiled(*given, **named)


def compile_all() -> None:
    """Interpret nothing more in this process: there are many cases to come."""
    Kernel.cases = np.inf


def compiled(
    function: Callable[Given, Answer], folder: Path | None, arrays: bool = False
) -> Callable[Given, Answer]:
    """Return a function compiled with all that it calls; no operations merge: bits are equal."""
    import numba

    if Kernel.tell is not None and not holds(folder, function):
        tell, Kernel.tell = Kernel.tell, None
        tell("compiling, once: some 10 to 40 s")
    with _compiling, cache_folder(folder):
        _introduce(function, arrays)
        njit: Any = numba.njit(cache=folder is not None, nogil=True, error_model="numpy")
        return njit(function)


def _introduce(function: Callable[..., Any], arrays: bool) -> None:
    """Let compiled code call what a function calls."""
    from numba.extending import register_jitable

    for name in function.__code__.co_names:
        called = function.__globals__.get(name)
        if inspect.isfunction(called) and called not in _known:
            _known.add(called)
            _introduce(called, arrays)
            register_jitable(**PLAIN, **({} if arrays else {"_nrt": False}))(called)
