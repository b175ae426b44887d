"""Where compiled kernels are kept: beside their own sources alone, and never required."""

import errno
import hashlib
import os
import stat
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from shutil import rmtree
from typing import Any

FULL = (errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EACCES, errno.EPERM, errno.EIO)
"""Why a folder that could be written no longer can."""


def holds(folder: Path | None, function: Callable[..., Any]) -> bool:
    """Return whether a folder holds a compiled function."""
    name = f"{Path(function.__code__.co_filename).stem}.{function.__qualname__}"
    pattern = f"{name.replace('<', '').replace('>', '')}-*.nbi"
    return folder is not None and any(folder.rglob(pattern))


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


def are_compiled(sources: Path) -> bool:
    """Return whether any kernel in a folder was compiled before, by this process or another one."""
    folder = kept_in(sources)
    return folder is not None and any(folder.rglob("*.nbi"))


@cache
def kept_in(sources: Path) -> Path | None:
    """Return where a package's kernels are kept, named by all of its modules; None if nowhere."""
    digest = hashlib.sha256(Path(__file__).read_bytes())
    for path in sorted(sources.rglob("*.py")):
        digest.update(f"{path.relative_to(sources)}\0".encode() + path.read_bytes() + b"\0")
    name = f"kernels-{digest.hexdigest()[:16]}"
    for place in _places(sources):
        with suppress(OSError):
            (place / name).mkdir(parents=True, exist_ok=True)
            tempfile.TemporaryFile(dir=place / name).close()
            if place.parent == sources:
                for old in place.glob("kernels-*"):
                    if old.name != name:
                        rmtree(old, ignore_errors=True)
            return place / name
    return None


def _places(sources: Path) -> Iterator[Path]:
    """Yield where compiled kernels may be kept: as numba would, then where temporary files are."""
    if chosen := os.environ.get("NUMBA_CACHE_DIR"):
        yield Path(chosen)
    yield sources / "__pycache__"
    with suppress(RuntimeError):
        yield Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "rocking"
    private = Path(tempfile.gettempdir(), f"rocking-{os.getuid()}")
    with suppress(OSError):
        private.mkdir(mode=0o700, exist_ok=True)
        found = private.lstat()  # nobody else may write there: what lies in it will be run
        if (
            stat.S_ISDIR(found.st_mode)
            and found.st_uid == os.getuid()
            and not found.st_mode & 0o077
        ):
            yield private
