"""Tables as files: written in one piece, and read back to the bit."""

from __future__ import annotations

import gzip
import hashlib
import os
from base64 import b64decode, b64encode
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

PACKED = ".gz"


@contextmanager
def draft(path: Path) -> Iterator[Path]:
    """Yield where to write a file that takes the place of `path` if the context ends well."""
    part = path.with_name(f".part.{path.name}")
    try:
        part.unlink(missing_ok=True)
        os.close(os.open(part, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW, 0o666))
        yield part
        part.replace(path)
    except BaseException as error:
        with suppress(OSError):
            part.unlink()
        if isinstance(error, OSError) and error.errno:
            raise OSError(error.errno, error.strerror, str(path)) from error
        raise


def write_text(path: Path, text: str) -> None:
    """Write a file in UTF-8 in one piece: it is complete, or it is still the one before."""
    with draft(path) as part:
        part.write_bytes(text.encode())


def write_table(path: Path, table: pd.DataFrame) -> None:
    """Write a table without its index as CSV, numbers to the bit and missing ones as nan."""
    write_text(path, table.to_csv(index=False, na_rep="nan"))


def split(rows: Iterable[Mapping[str, Any]], label: str) -> dict[str, pd.DataFrame]:
    """Return the rows of each value of a label as a table, with the columns that they have."""
    found = defaultdict[str, list[Mapping[str, Any]]](list)
    for row in rows:
        found[row[label]].append(row)
    return {name: pd.DataFrame(of) for name, of in found.items()}


def read_table(path: Path, *words: str) -> pd.DataFrame:
    """Read a table back as it was written; named are its columns of words, besides message."""
    texts = dict.fromkeys(("message", *words), str)
    try:
        heads = [str(name) for name in pd.read_csv(path, nrows=0)]
        missing = {name: ["nan"] for name in heads if name not in words}
        return pd.read_csv(path, keep_default_na=False, na_values=missing, dtype=texts)
    except pd.errors.EmptyDataError:
        return pd.DataFrame()


def table_in(folder: Path, name: str, *words: str) -> pd.DataFrame:
    """Read a table of a folder, packed or not; return an empty one where there is no such file."""
    paths = (folder / f"{name}.csv", folder / f"{name}.csv{PACKED}")
    return next((read_table(path, *words) for path in paths if path.is_file()), pd.DataFrame())


def tables_of(folder: Path) -> Iterable[Path]:
    """Return the tables of a folder, packed or not."""
    return sorted([*folder.glob("*.csv"), *folder.glob(f"*.csv{PACKED}")])


def digest(path: Path) -> str:
    """Return the SHA-256 of a table's text, packed or not."""
    with gzip.open(path) if path.suffix == PACKED else path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def packed(numbers: NDArray[np.float64]) -> str:
    """Return numbers as text that a row can hold, to the bit."""
    return b64encode(np.ascontiguousarray(numbers).tobytes()).decode()


def unpacked(text: str) -> NDArray[np.float64]:
    """Return the numbers that `packed` made text of, in one row."""
    return np.frombuffer(b64decode(text), np.float64)
