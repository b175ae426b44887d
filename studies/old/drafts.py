"""Files written in one piece: each is complete, or it is still the one before."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO


@contextmanager
def draft(path: Path) -> Iterator[BinaryIO]:
    """Yield a new file that takes the place of `path` if the context ends well.

    Raises
    ------
    OSError
        As `draft_place` does.
    """
    with draft_place(path) as part, part.open("wb") as file:
        yield file


@contextmanager
def draft_place(path: Path) -> Iterator[Path]:
    """Yield where to write a new file that takes the place of `path` if the context ends well.

    It lies beside `path`, is empty and of the same suffix, and no link, so that nothing elsewhere
    is touched.

    Raises
    ------
    OSError
        That names `path`, whatever it was that could not be written.
    """
    part = path.with_name(f".part.{path.name}")
    try:
        part.unlink(missing_ok=True)
        flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW
        os.close(os.open(part, flags, 0o666))
        yield part
        part.replace(path)
    except BaseException as error:
        with suppress(OSError):
            part.unlink()
        if isinstance(error, OSError) and error.errno:
            raise OSError(error.errno, error.strerror, str(path)) from error
        raise
