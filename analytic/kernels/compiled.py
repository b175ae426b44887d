"""Kernels in two forms, which agree to the bit: Python for a few cases, compiled code for many.

Compiling takes seconds, and to load what was compiled takes longer than a case or two in Python. So
a kernel is interpreted until a thread has spent its patience, or something is found that Python
raises where compiled code goes on; from then on it is compiled.
"""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import update_wrapper
from pathlib import Path
from typing import Any, ClassVar, TypeVar, cast

from analytic.kernels.kept import FULL, are_compiled, cache_folder, holds, kept_in

Answer = TypeVar("Answer")
Function = TypeVar("Function", bound=Callable[..., Any])

SOURCES = Path(__file__).parents[__name__.count(".") - 1]
"""The folder of the package that holds the reference's kernels and all that they call."""

FEW = 100
"""Cases up to which it may take less time to interpret them."""

MENDED = (ArithmeticError, ValueError)
"""What Python raises where compiled code goes on with inf or nan."""


class SpentError(Exception):
    """Raised where a thread has interpreted as much as it should."""


class Purse:
    """Steps that are interpreted before code is compiled.

    Parameters
    ----------
    sources : Path
        The folder of the code.
    loading : int
        About as many steps as are interpreted while what was compiled is loaded.
    compiling : int
        How many more are, where nothing was, before seconds are spent on compiling.
    """

    shut = False
    """Whether nothing more is interpreted: there are many cases to come."""

    def __init__(self, sources: Path, loading: int, compiling: int) -> None:
        self._sources, self._left, self._more = sources, loading, compiling

    @property
    def open(self) -> bool:
        """Whether anything is left."""
        return self._left > 0 and not Purse.shut

    def spend(self) -> None:
        """Take a step out; SpentError if there is none."""
        self._left -= 1
        if self._left < 0:
            if not self._more or are_compiled(self._sources):
                raise SpentError
            self._left, self._more = self._more, 0


class Within(threading.local):
    """The purse that a thread is spending while it interprets; None while it does not."""

    purse: Purse | None = None


_within = Within()


def interpreted() -> bool:
    """Return whether this thread is interpreting."""
    return _within.purse is not None


def spend() -> None:
    """Count a step that is interpreted; in compiled code, nothing.

    Raises
    ------
    SpentError
        If it is one too many.
    """
    if _within.purse is not None:
        _within.purse.spend()


@contextmanager
def interpreting(purse: Purse) -> Iterator[None]:
    """Let every kernel be interpreted, at the expense of a purse.

    Raises
    ------
    SpentError
        If it does not suffice.
    """
    import numpy as np

    before, _within.purse = _within.purse, purse
    try:
        # what numpy would only warn of is for compiled code, as what Python raises
        with np.errstate(divide="raise", over="raise", invalid="raise"):
            yield
    finally:
        _within.purse = before


def compile_all() -> None:
    """Interpret nothing more in this process: there are many cases to come."""
    from analytic.kernels import forms

    Purse.shut = True
    forms.compile_all()


class Kernel:
    """A function in both forms.

    It may be called a second time with the same arguments: what it writes, it does not read before.

    Parameters
    ----------
    function : callable
        What is interpreted, and what is compiled.
    sources : Path
        The folder of the modules that it consists of.
    purse : Purse or None
        At whose expense it is interpreted; None where others decide that.
    """

    tell: ClassVar[Callable[[str], None] | None] = None
    """Who is told, the first time, that compiling begins."""

    def __init__(self, function: Callable[..., Any], sources: Path, purse: Purse | None) -> None:
        update_wrapper(self, function)
        self.py_func = function
        self._sources, self._purse = sources, purse
        self._dispatcher: Any = None

    def __call__(self, *arguments: Any) -> Any:
        """Call the form that is due."""
        if interpreted():
            return self.py_func(*arguments)
        if self._dispatcher is not None or self._purse is None or not self._purse.open:
            return self.run(*arguments)
        try:
            with interpreting(self._purse):
                return self.py_func(*arguments)
        except (SpentError, *MENDED):
            return self.run(*arguments)

    def run(self, *arguments: Any) -> Any:
        """Call the compiled form, whatever is left."""
        try:
            return self.compiled(*arguments)
        except OSError as error:
            if error.errno not in FULL:
                raise
            self._dispatcher = _compiled(self.py_func, None)
            return self._dispatcher(*arguments)

    @property
    def compiled(self) -> Any:
        """The compiled form, a dispatcher of numba's."""
        if self._dispatcher is None:
            folder = kept_in(self._sources)
            tell = Kernel.tell
            if tell is not None and not holds(folder, self.py_func):
                Kernel.tell = None
                tell("compiling, once: some 10 to 40 s")
            self._dispatcher = _compiled(self.py_func, folder)
        return self._dispatcher

    @property
    def _numba_type_(self) -> Any:
        """What other kernels know it by."""
        return self.compiled._numba_type_


def form_for(cases: int, kernel: Function) -> Function:
    """Return the form of a kernel that is called for so many cases.

    Parameters
    ----------
    cases : int, of which more than FEW are for the compiled form
    kernel : Kernel
    """
    known: Any = kernel
    return known.run if cases > FEW else kernel


def keeper(sources: Path, *, purse: Purse | None = None) -> Callable[[Function], Function]:
    """Return the decorator of the kernels in a folder, which call no kernel of another one.

    Compiled, a kernel is kept on disk, and other threads of Python run while it does. No operation
    is merged with another: whether it is would depend on what the compiler inlines, and the last
    digit on which process compiled.

    Parameters
    ----------
    sources : Path, the folder of the modules that the kernels consist of
    purse : Purse or None, see `Kernel`
    """

    def decorate(function: Function) -> Function:
        return cast(Function, Kernel(function, sources, purse))

    return decorate


kernel = keeper(SOURCES, purse=Purse(SOURCES, loading=5_000, compiling=30_000))
"""Let a function have both forms, and be called from Python."""


def instead(of: Callable[..., Any], **options: Any) -> Callable[[Function], Function]:
    """Let kernels that are compiled call a function in place of one that Python calls."""

    def decorate(function: Function) -> Function:
        _waiting.append((of, function, options))
        return function

    return decorate


def inner(function: Function) -> Function:
    """Let kernels call a function that makes no array.

    It counts no references to the arrays that it is given, which in the step of a response take as
    long as its arithmetic.
    """
    return instead(function, _nrt=False)(function)


def maker(function: Function) -> Function:
    """Let kernels call a function that makes arrays."""
    return instead(function)(function)


_waiting: list[tuple[Callable[..., Any], Callable[..., Any], dict[str, Any]]] = []
"""What is compiled into kernels, and not yet known to numba."""

_compiling = threading.RLock()


def _compiled(function: Callable[..., Any], folder: Path | None) -> Any:
    import numba

    njit: Any = numba.njit  # its types leave out what it takes with an underscore
    with _compiling:
        _introduce()
        compile_ = njit(cache=folder is not None, nogil=True, error_model="numpy")
        with cache_folder(folder):
            return compile_(function)


def _introduce() -> None:
    """Tell numba what stands in compiled code for the functions that Python calls."""
    from numba.extending import overload

    tell: Any = overload
    while _waiting:
        of, function, options = _waiting.pop(0)
        known = {"error_model": "numpy", "no_cfunc_wrapper": True, **options}
        tell(of, jit_options=known, strict=False)(_always(function))


def _always(function: Callable[..., Any]) -> Callable[..., Any]:
    def typed(*_: Any, **__: Any) -> Callable[..., Any]:
        return function

    return typed


def listed(numbers: Any) -> Any:
    """Return an array as lists, which Python reads faster; in compiled code, the array."""
    return numbers if isinstance(numbers, list) else numbers.tolist()


def constant(numbers: Any) -> Callable[[int], float]:
    """Return what reads a number of an array that stays as it is."""
    lists = numbers.tolist()

    def number(i: int) -> Any:
        return lists[i]

    instead(number, _nrt=False)(lambda i: numbers[i])
    return number


@instead(spend, _nrt=False)
def _spend_nothing() -> None:
    return None


@instead(listed)
def _as_it_is(numbers: Any) -> Any:
    return numbers
