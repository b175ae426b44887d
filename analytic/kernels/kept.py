"""Where compiled kernels are kept."""

import errno
import hashlib
import os
import stat
import tempfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from shutil import rmtree
from typing import Any

FULL = (errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EACCES, errno.EPERM, errno.EIO)
"""Why a folder that could be written no longer can."""


@cache
def kept_in(sources: Path) -> Path | None:
    """Return the folder of the compiled kernels; None where no place can be written."""
    return folder_for(sources, places(sources))


def are_compiled(sources: Path) -> bool:
    """Return whether any kernel in a folder was compiled before, by this process or another one."""
    folder = kept_in(sources)
    return folder is not None and any(folder.rglob("*.nbi"))


def holds(folder: Path | None, function: Callable[..., Any]) -> bool:
    """Return whether a folder holds a compiled function.

    Parameters
    ----------
    folder : Path or None, as `kept_in` returns it; None holds nothing
    function : callable, what was compiled
    """
    name = f"{Path(function.__code__.co_filename).stem}.{function.__qualname__}"
    pattern = f"{name.replace('<', '').replace('>', '')}-*.nbi"
    return folder is not None and any(folder.rglob(pattern))


def folder_for(sources: Path, where: Iterable[Path]) -> Path | None:
    """Return a folder in the first of these places that can be written, for these sources alone.

    It is named by what all modules of the package say, and by how they are compiled: numba sees a
    change of a kernel's own module, not of a kernel that it calls in another one.
    """
    compiling = Path(__file__).with_name("compiled.py")
    digest = hashlib.sha256(compiling.read_bytes())
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
    chosen = os.environ.get("NUMBA_CACHE_DIR")
    if chosen:
        yield Path(chosen)
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
def cache_folder(folder: Path | None) -> Iterator[None]:
    """Let numba keep what is decorated meanwhile in a folder; it asks when it decorates."""
    import numba

    known: Any = numba.config
    before = known.CACHE_DIR
    known.CACHE_DIR = str(folder or "")
    try:
        yield
    finally:
        known.CACHE_DIR = before
