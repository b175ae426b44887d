"""One decorator for every compiled kernel of a package, and where the compiled code is kept."""

import hashlib
import os
import stat
import tempfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from shutil import rmtree
from typing import Any, TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., Any])

_numba: Any = numba.config

SOURCES = Path(__file__).parents[__name__.count(".") - 1]
"""The folder of the package that holds the reference's kernels and all that they call."""


def keeper(
    sources: Path, *, counted: bool = True, nogil: bool = True
) -> Callable[[Function], Function]:
    """Return the decorator of the kernels in a folder, which call no kernel of another one.

    It compiles a function at its first call, keeps the result on disk, and releases the GIL unless
    told not to. What makes no array needs no references to its arrays counted.

    No operation is merged with another: whether it is would depend on what the compiler inlines,
    and the last digit on which process compiled.
    """

    def kernel(function: Function) -> Function:
        folder = kept_in(sources)
        njit: Any = numba.njit  # its types leave out what it takes with an underscore
        compile_ = njit(cache=folder is not None, nogil=nogil, error_model="numpy", _nrt=counted)
        with _cache_folder(folder):
            return cast(Function, compile_(function))

    return kernel


kernel = keeper(SOURCES)
"""Compile a kernel of the reference at its first call."""

inner = keeper(SOURCES, counted=False)
"""Compile, as `kernel`, what makes no array and assigns to no slice of one.

It counts no references to the arrays that it is given, which in the step of a response take as long
as its arithmetic.
"""


@cache
def kept_in(sources: Path = SOURCES) -> Path | None:
    """Return the folder of the compiled kernels; None where no place can be written."""
    return folder_for(sources, places(sources))


def are_compiled(sources: Path = SOURCES) -> bool:
    """Return whether any kernel in a folder was compiled before, by this process or another one."""
    folder = kept_in(sources)
    return folder is not None and any(folder.rglob("*.nbi"))


def folder_for(sources: Path, where: Iterable[Path]) -> Path | None:
    """Return a folder in the first of these places that can be written, for these sources alone.

    It is named by what all modules of the package say, and by how they are compiled: numba sees a
    change of a kernel's own module, not of a kernel that it calls in another one.
    """
    digest = hashlib.sha256(Path(__file__).read_bytes())
    for path in sorted(sources.rglob("*.py")):
        digest.update(f"{path.relative_to(sources)}\0".encode() + path.read_bytes() + b"\0")
    name = f"kernels-{digest.hexdigest()[:16]}"
    for place in where:
        with suppress(OSError):
            (place / name).mkdir(parents=True, exist_ok=True)
            tempfile.TemporaryFile(dir=place / name).close()
            if place.parent == sources:
                _forget(path for path in place.glob("kernels-*") if path.name != name)
            return place / name
    return None


def places(sources: Path) -> Iterator[Path]:
    """Yield where compiled kernels may be kept: as numba would, then where temporary files are."""
    if _numba.CACHE_DIR:
        yield Path(_numba.CACHE_DIR)
    yield sources / "__pycache__"
    with suppress(RuntimeError):
        yield Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "rocking"
    with suppress(OSError):
        yield _private(Path(tempfile.gettempdir(), f"rocking-{os.getuid()}"))


def _private(folder: Path) -> Path:
    """Make a folder that nobody else can write to: what lies in it will be run."""
    folder.mkdir(mode=0o700, exist_ok=True)
    found = folder.lstat()
    if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.getuid() or found.st_mode & 0o077:
        raise PermissionError(f"{folder} is open to others")
    return folder


def _forget(folders: Iterable[Path]) -> None:
    for folder in folders:
        rmtree(folder, ignore_errors=True)


@contextmanager
def _cache_folder(folder: Path | None) -> Iterator[None]:
    """Let numba keep what is decorated meanwhile in a folder; it asks when it decorates."""
    before = _numba.CACHE_DIR
    _numba.CACHE_DIR = str(folder or "")
    try:
        yield
    finally:
        _numba.CACHE_DIR = before
