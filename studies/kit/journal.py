"""A results folder: who may write to it, what it belongs to, and the rows finished so far."""

import fcntl
import json
import os
import stat
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from studies.kit.sealed import seal, unseal

Row = dict[str, Any]
"""One line of a table."""

FORMAT = 2
"""Version of the journal's own format."""

JOURNAL, LOCK, PROVENANCE = "journal.jsonl", ".lock", "provenance.json"
"""Files of every results folder, beside the products of its study."""


class FolderError(Exception):
    """A results folder that cannot be used; the message is one line that says why."""

    def __init__(self, folder: Path, problem: str, option: str = "--out") -> None:
        super().__init__(f"{option} is {str(folder)!r}; {problem}")
        self.problem = problem


class Journal:
    """Rows on disk, appended one at a time; a line that was not completed does not count.

    The first line is the identity of the study: whatever changes the meaning of its rows. Every
    other line is one finished job, `{"crc": ..., "key": ..., "row": {...}}`, crc its checksum.
    Failures are written down but not remembered, so that a rerun tries them again.
    """

    def __init__(self, path: Path, rows: dict[str, Row]) -> None:
        self.rows = rows
        self._path = path
        self._descriptor = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_NOFOLLOW)

    def append(self, key: str, row: Row) -> None:
        """Store one finished row, at once and in one piece.

        Raises
        ------
        FolderError
            If the folder is no longer there.
        """
        self.check()
        _write(self._descriptor, {"key": key, "row": row})
        self.rows[key] = row

    def check(self) -> None:
        """Raise FolderError if the folder, or the journal in it, is no longer there."""
        try:
            there = os.path.samestat(self._path.stat(), os.fstat(self._descriptor))
        except (FileNotFoundError, NotADirectoryError):
            there = False
        if not there:
            problem = f"its {JOURNAL} was removed during the run, and its rows with it"
            raise FolderError(self._path.parent, problem)

    def stranger(self, key: str) -> FolderError:
        """Return the refusal of a row that is not one of the job which its key names."""
        problem = f"its {JOURNAL} has a row of something else under the key {key}"
        return FolderError(self._path.parent, problem)

    def close(self) -> None:
        """Bring the rows to the disk."""
        os.fsync(self._descriptor)
        os.close(self._descriptor)


@contextmanager
def open_journal(
    folder: Path, identity: Mapping[str, Any], products: Sequence[str]
) -> Iterator[Journal]:
    """Lock a results folder and open its journal, made new if there is none.

    Parameters
    ----------
    folder : Path
        Created if needed.
    identity : mapping
        Must equal the one that the folder was made with.
    products : sequence of str
        Names of the files that the study writes; where one of them lies in a folder without a
        journal, it is somebody else's.

    Raises
    ------
    FolderError
        If the folder cannot be written, is in use, is damaged, holds something else, or is removed
        meanwhile.
    """
    path = folder / JOURNAL
    header = {"journal": FORMAT, **identity}
    with ExitStack() as stack:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            _refuse_strangers(path, header, products)
            stack.enter_context(_locked(folder))
            if _refuse_strangers(path, header, products):
                _begin(path, header)
            journal = Journal(path, _finished(path, header))
        except (FileExistsError, NotADirectoryError) as error:
            raise FolderError(folder, "it must be a folder, not a file") from error
        except OSError as error:
            problem = f"it must be a folder that can be written ({error.strerror or error})"
            raise FolderError(folder, problem) from error
        stack.callback(journal.close)
        yield journal
        journal.check()


@contextmanager
def _locked(folder: Path) -> Iterator[None]:
    with (folder / LOCK).open("a") as lock:
        try:
            # the kernel releases it when the process ends, however it ends
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise FolderError(folder, "it must not be in use by another run") from error
        yield


def _refuse_strangers(path: Path, header: Mapping[str, Any], products: Sequence[str]) -> bool:
    """Refuse a folder with files that are not ours; say whether its journal has yet to begin."""
    folder = path.parent
    for name in (LOCK, JOURNAL, PROVENANCE):
        # a link leads elsewhere, and on a pipe or a device a run would hang
        if os.path.lexists(folder / name) and not stat.S_ISREG((folder / name).lstat().st_mode):
            raise FolderError(folder, f"its {name} must be a file")
    for name in products:
        if (folder / name).is_dir():
            raise FolderError(folder, f"its {name} must be a file")
    content = path.read_bytes() if path.exists() else b""
    # a run may have been killed while it wrote the first line
    if not seal(header).startswith(content) or content.endswith(b"\n"):
        return False
    strange = [name for name in (PROVENANCE, *products) if os.path.lexists(folder / name)]
    if (folder / LOCK).exists() and (folder / LOCK).stat().st_size:
        strange.append(LOCK)
    if strange:
        raise FolderError(folder, f"it must be new, and it holds a {strange[0]} of unknown origin")
    return True


def _begin(path: Path, header: Mapping[str, Any]) -> None:
    start = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_NOFOLLOW, 0o644)
    try:
        _write(start, header)
    finally:
        os.close(start)


def _finished(path: Path, header: Mapping[str, Any]) -> dict[str, Row]:
    """Read the finished rows, and cut off a last line that a killed run left incomplete."""
    found = belongs_to(path)
    if found != header:
        words = "it must be new, or hold results of the same version and settings"
        raise FolderError(path.parent, f"{words} ({differences(found, header)})")
    content = path.read_bytes()
    rows = rows_in(path.parent, content)
    whole = content.rfind(b"\n") + 1
    if whole < len(content):
        os.truncate(path, whole)
    return {key: row for key, row in rows.items() if row["outcome"] != "failed"}


def belongs_to(path: Path) -> Row:
    """Return a journal's first line.

    Raises
    ------
    FolderError
        If the file is no journal, or its first line is damaged.
    """
    with path.open("rb") as file:
        line = file.readline().removesuffix(b"\n")
    try:
        found = json.loads(line)
    except (ValueError, RecursionError):
        found = None
    if not isinstance(found, dict) or "journal" not in found:
        raise FolderError(path.parent, f"its {path.name} is not a journal of results")
    return _entry(path.parent, 1, line) if "crc" in found else found


def rows_in(folder: Path, content: bytes) -> dict[str, Row]:
    """Return the rows of a folder's journal by their keys, failures among them.

    Raises
    ------
    FolderError
        If one that was completed is damaged.
    """
    rows: dict[str, Row] = {}
    for number, line in enumerate(content.split(b"\n")[1:-1], start=2):
        key, row = _row(folder, number, line)
        rows.pop(key, None)
        rows[key] = row
    return rows


def differences(found: Mapping[str, Any], here: Mapping[str, Any]) -> str:
    """Return where what a folder belongs to is not what is asked for, in words."""
    there, ours = _leaves(found), _leaves(here)
    names = [name for name in (*ours, *there) if there.get(name) != ours.get(name)]
    return "; ".join(
        f"{name}: {json.dumps(there.get(name))} there, {json.dumps(ours.get(name))} here"
        for name in dict.fromkeys(names)
    )


def _leaves(values: Mapping[str, Any], prefix: str = "") -> Row:
    """Return the innermost values of nested mappings, each with its path."""
    leaves: Row = {}
    for name, value in values.items():
        if isinstance(value, dict):
            leaves |= _leaves(value, f"{prefix}{name} ")
        else:
            leaves[prefix + name] = value
    return leaves


def _row(folder: Path, number: int, line: bytes) -> tuple[str, Row]:
    entry = _entry(folder, number, line)
    key, row = entry.get("key"), entry.get("row")
    if not isinstance(key, str) or not isinstance(row, dict) or "outcome" not in row:
        raise _damage(folder, number)
    return key, row


def _entry(folder: Path, number: int, line: bytes) -> Row:
    try:
        return unseal(line)
    except (ValueError, RecursionError) as error:
        raise _damage(folder, number) from error


def _damage(folder: Path, number: int) -> FolderError:
    return FolderError(folder, f"its {JOURNAL} is damaged in line {number}")


def _write(descriptor: int, entry: Mapping[str, Any]) -> None:
    line = seal(entry)
    if os.write(descriptor, line) < len(line):
        raise OSError("the disk is full")
