"""A results folder: who may write to it, what it belongs to, and the rows finished so far."""

import fcntl
import json
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

Row = dict[str, Any]
"""One line of a table."""

FORMAT = 1
"""Version of the journal's own format."""


class FolderError(Exception):
    """A results folder that cannot be used; the message is one line that says why."""

    def __init__(self, folder: Path, problem: str) -> None:
        super().__init__(f"--out is {str(folder)!r}; {problem}")


class Journal:
    """Rows on disk, appended one at a time; a line that was not completed does not count.

    The first line is the identity of the study: whatever changes the meaning of its rows. Every
    other line is one finished job, `{"key": ..., "row": {...}}`. Failures are written down but not
    remembered, so that a rerun tries them again.
    """

    def __init__(self, path: Path, rows: dict[str, Row]) -> None:
        self.rows = rows
        self._descriptor = os.open(path, os.O_WRONLY | os.O_APPEND)

    def append(self, key: str, row: Row) -> None:
        """Store one finished row, at once and in one piece."""
        _write(self._descriptor, {"key": key, "row": row})
        self.rows[key] = row

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
        If the folder cannot be written, is in use, or holds something else.
    """
    path = folder / "journal.jsonl"
    header = {"journal": FORMAT, **identity}
    with ExitStack() as stack:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            stack.enter_context(_locked(folder))
            _check_new_or_ours(folder, path, header, products)
            journal = Journal(path, _finished(path))
        except (FileExistsError, NotADirectoryError) as error:
            raise FolderError(folder, "it must be a folder, not a file") from error
        except OSError as error:
            problem = f"it must be a folder that can be written ({error.strerror or error})"
            raise FolderError(folder, problem) from error
        stack.callback(journal.close)
        yield journal


@contextmanager
def _locked(folder: Path) -> Iterator[None]:
    with (folder / ".lock").open("a") as lock:
        try:
            # the kernel releases it when the process ends, however it ends
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise FolderError(folder, "it must not be in use by another run") from error
        yield


def _check_new_or_ours(
    folder: Path, path: Path, header: Mapping[str, Any], products: Sequence[str]
) -> None:
    complete = path.read_bytes().rpartition(b"\n")[0] if path.exists() else b""
    if not complete:
        _refuse_strangers(folder, products)
        start = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
        _write(start, header)
        os.close(start)
        return
    try:
        found = json.loads(complete.partition(b"\n")[0])
    except ValueError:
        found = None
    if not isinstance(found, dict) or "journal" not in found:
        raise FolderError(folder, "its journal.jsonl is not a journal of results")
    if found != header:
        raise FolderError(
            folder,
            "it must be new, or hold results of the same version and settings "
            f"({_differences(found, dict(header))})",
        )


def _refuse_strangers(folder: Path, products: Sequence[str]) -> None:
    for name in products:
        if (folder / name).exists():
            raise FolderError(folder, f"it must be new, and it holds a {name} of unknown origin")


def _differences(found: Row, here: Row) -> str:
    names = [name for name in (*here, *found) if found.get(name) != here.get(name)]
    return "; ".join(
        f"{name}: {json.dumps(found.get(name))} there, {json.dumps(here.get(name))} here"
        for name in dict.fromkeys(names)
    )


def _finished(path: Path) -> dict[str, Row]:
    """Read the finished rows, and cut off a last line that a killed run left incomplete."""
    content = path.read_bytes()
    complete = content[: content.rfind(b"\n") + 1]
    if len(complete) < len(content):
        os.truncate(path, len(complete))
    rows: dict[str, Row] = {}
    for number, line in enumerate(complete.splitlines()[1:], start=2):
        try:
            entry = json.loads(line)
            key, row = entry["key"], entry["row"]
        except (ValueError, TypeError, KeyError) as error:
            problem = f"its journal.jsonl is damaged in line {number}"
            raise FolderError(path.parent, problem) from error
        rows.pop(key, None)
        if row["outcome"] != "failed":
            rows[key] = row
    return rows


def _write(descriptor: int, entry: Mapping[str, Any]) -> None:
    line = json.dumps(entry).encode() + b"\n"
    if os.write(descriptor, line) < len(line):
        raise OSError("the disk is full")
