"""Digests of a folder's tables: whether they are still what its study wrote."""

import gzip
import hashlib
import os
import zlib
from collections.abc import Iterable
from pathlib import Path

from studies.kit.journal import PACKED, PROVENANCE, FolderError
from studies.kit.provenance import record_of, write_record


def seal(folder: Path) -> None:
    """Write into a folder's provenance the digest of each table that lies beside it, unpacked.

    Every study does so with its own; what has been published from several folders is sealed anew.

    Raises
    ------
    OSError
        If there is no provenance, or a file cannot be read or written.
    """
    tables = sorted([*folder.glob("*.csv"), *folder.glob(f"*.csv{PACKED}")])
    kept = {path.name.removesuffix(PACKED): digest(path) for path in tables}
    write_record(folder / PROVENANCE, record_of(folder) | {"tables": kept})


def digest(path: Path) -> str:
    """Return the SHA-256 of a table's text, packed or not."""
    with gzip.open(path) if path.suffix == PACKED else path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def check(folder: Path, names: Iterable[str], option: str) -> None:
    """Refuse tables that are not what a study wrote; those that are not there are passed over.

    Parameters
    ----------
    folder : Path
    names : iterable of str
        Tables, each perhaps in a folder inside, beside its provenance.
    option : str
        By which the folder is named.

    Raises
    ------
    FolderError
        That names the first table which was edited or cut, or which no provenance tells of.
    """
    for name in names:
        for path in (folder / name, folder / f"{name}{PACKED}"):
            if os.path.lexists(path) and (problem := _problem(path)):
                raise FolderError(folder, f"its {path.relative_to(folder)} {problem}", option)


def _problem(path: Path) -> str:
    """Return what is wrong with a table, in words; nothing if it is as it was written."""
    if not path.is_file():
        return "must be a file"
    try:
        known = dict(record_of(path.parent)["tables"]).get(path.name.removesuffix(PACKED))
    except (OSError, ValueError, TypeError, KeyError, RecursionError):
        known = None
    if known is None:
        words = f"must be beside the {PROVENANCE} that has its digest"
        return f"{words}; the command that made it writes one when it is run again"
    try:
        same = digest(path) == known
    except (EOFError, gzip.BadGzipFile, zlib.error):
        same = False
    return "" if same else f"is not what its {PROVENANCE} tells of: edited, cut or of another run"
