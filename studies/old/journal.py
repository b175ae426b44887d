"""A results folder: who may write to it, what it belongs to, and the rows finished so far."""

import errno
import fcntl
import gzip
import hashlib
import json
import os
import re
import shutil
import stat
import zlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

from studies.old.drafts import draft

Row = dict[str, Any]
"""One line of a table."""

Maker = Mapping[str, str]
"""What made a row: the name of each thing that it depends on -> its version, or a hash of it."""

FORMAT = 3
"""Version of the journal's own format."""

JOURNAL, LOCK, PROVENANCE = "journal.jsonl", ".lock", "provenance.json"
"""Files of every results folder, beside the products of its study."""

PACKED = ".gz"
"""What the name of a packed journal or table ends in; one that is not packed is the newer."""


NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
"""What a write says of which nothing was written; of a part of it nothing is said."""

_LINE = re.compile(rb'\{"crc": "([0-9a-f]{8})", (.*\})', re.DOTALL)


class FolderError(Exception):
    """A results folder that cannot be used; the message is one line that says why."""

    def __init__(self, folder: Path, problem: str, option: str = "--out") -> None:
        super().__init__(f"{option} is {str(folder)!r}; {problem}")
        self.problem = problem


class Entry(NamedTuple):
    """A finished row, and what made it."""

    row: Row
    maker: Maker


Kept: TypeAlias = dict[str, Entry]
"""What a journal holds, by the keys of its jobs."""


class Journal:
    """Rows on disk, appended one at a time; a line that was not completed does not count.

    The first line says of which study and settings the rows are. Every other line is one finished
    job, `{"crc": ..., "key": ..., "made": ..., "row": {...}}`, crc its checksum, or what made
    those that follow and name it, `{"crc": ..., "made": ..., "of": {...}}`. Of rows with the same
    key the last one counts. Failures are written down but not remembered, so that a rerun tries
    them again.
    """

    def __init__(self, path: Path, kept: Kept) -> None:
        self.folder, self.kept = path.parent, kept
        makers = {id(entry.maker): entry.maker for entry in kept.values()}
        self._named = set(map(named, makers.values()))
        self._path = path
        self._descriptor = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_NOFOLLOW)

    def append(self, key: str, row: Row, maker: Maker) -> None:
        """Store one finished row and what made it, at once and in one piece.

        Raises
        ------
        FolderError
            If the folder is no longer there.
        """
        self.check()
        made = named(maker)
        if made not in self._named:
            self._write({"made": made, "of": dict(maker)})
            self._named.add(made)
        self._write({"key": key, "made": made, "row": row})
        self.kept[key] = Entry(row, maker)

    def _write(self, entry: Mapping[str, Any]) -> None:
        line = seal(entry)
        try:
            if os.write(self._descriptor, line) == len(line):
                return
        except OSError as error:
            if error.errno not in NO_ROOM:
                raise
        raise OSError(errno.ENOSPC, "the disk is full", str(self._path))

    def check(self) -> None:
        """Raise FolderError if the folder, or the journal in it, is no longer there."""
        try:
            there = os.path.samestat(self._path.stat(), os.fstat(self._descriptor))
        except (FileNotFoundError, NotADirectoryError):
            there = False
        if not there:
            problem = f"its {JOURNAL} was removed during the run, and its rows with it"
            raise FolderError(self._path.parent, problem)

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
        Study and settings; must equal those that the folder was made with.
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
    header = seal({"journal": FORMAT, **identity})
    with ExitStack() as stack:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            _refuse_strangers(path, header, products)
            stack.enter_context(_locked(folder))
            _unpack(path)
            if _refuse_strangers(path, header, products):
                path.write_bytes(header)
            journal = Journal(path, _finished(path, identity))
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


def _refuse_strangers(path: Path, header: bytes, products: Sequence[str]) -> bool:
    """Refuse a folder with files that are not ours; say whether its journal has yet to begin."""
    folder = path.parent
    for name in (LOCK, JOURNAL, JOURNAL + PACKED, PROVENANCE):
        # a link leads elsewhere, and on a pipe or a device a run would hang
        if os.path.lexists(folder / name) and not stat.S_ISREG((folder / name).lstat().st_mode):
            raise FolderError(folder, f"its {name} must be a file")
    for name in products:
        if (folder / name).is_dir():
            raise FolderError(folder, f"its {name} must be a file")
    packed = path.with_name(path.name + PACKED)
    if packed.exists() and not path.exists():
        return False
    content = path.read_bytes() if path.exists() else b""
    # a run may have been killed while it wrote the first line
    if not header.startswith(content) or content.endswith(b"\n"):
        return False
    strange = [name for name in (PROVENANCE, *products) if os.path.lexists(folder / name)]
    if (folder / LOCK).exists() and (folder / LOCK).stat().st_size:
        strange.append(LOCK)
    if strange:
        raise FolderError(folder, f"it must be new, and it holds a {strange[0]} of unknown origin")
    return True


def _unpack(path: Path) -> None:
    packed = path.with_name(path.name + PACKED)
    if path.exists() or not packed.exists():
        return
    try:
        with draft(path) as file, gzip.open(packed) as inside:
            shutil.copyfileobj(inside, file)
    except (EOFError, gzip.BadGzipFile, zlib.error) as error:
        raise FolderError(path.parent, f"its {packed.name} is damaged") from error


def _finished(path: Path, identity: Mapping[str, Any]) -> Kept:
    """Read the finished rows, and cut off a last line that a killed run left incomplete."""
    content = path.read_bytes()
    kept = rows_of(path, content, identity, "it must be new, or hold")
    whole = content.rfind(b"\n") + 1
    if whole < len(content):
        os.truncate(path, whole)
    return {key: entry for key, entry in kept.items() if entry.row["outcome"] != "failed"}


def rows_of(
    path: Path, content: bytes, identity: Mapping[str, Any], must: str = "it must hold"
) -> Kept:
    """Return what a journal holds, failures among it.

    Parameters
    ----------
    path : Path
    content : bytes
        Of the journal there.
    identity : mapping
        Study and settings, which must be those of the journal.
    must : str, optional
        How the refusal of another one begins.

    Raises
    ------
    FolderError
        If the file is no journal, is damaged, or belongs to something else.
    """
    line = content.partition(b"\n")[0]
    try:
        found = json.loads(line)
    except (ValueError, RecursionError):
        found = None
    if not isinstance(found, dict) or "journal" not in found:
        raise FolderError(path.parent, f"its {path.name} is not a journal of results")
    found = _entry(path.parent, 1, line) if "crc" in found else found
    if found != (asked := {"journal": FORMAT, **identity}):
        there, here = _leaves(found), _leaves(asked)
        other = "; ".join(
            f"{name}: {json.dumps(there.get(name))} there, {json.dumps(here.get(name))} here"
            for name in here | there
            if there.get(name) != here.get(name)
        )
        raise FolderError(path.parent, f"{must} results of the same study and settings ({other})")
    return rows_in(path.parent, content)


def rows_in(folder: Path, content: bytes) -> Kept:
    """Return what a folder's journal holds, failures among it.

    Raises
    ------
    FolderError
        If one that was completed is damaged.
    """
    kept: Kept = {}
    makers: dict[str, Maker] = {}
    for number, line in enumerate(content.split(b"\n")[1:-1], start=2):
        found = _entry(folder, number, line)
        made, of = found.get("made"), found.get("of")
        if isinstance(of, dict) and made == named(of):
            makers[made] = of
            continue
        key, row = found.get("key"), found.get("row")
        if not isinstance(key, str) or made not in makers:
            raise _damage(folder, number)
        if not isinstance(row, dict) or "outcome" not in row:
            raise _damage(folder, number)
        kept.pop(key, None)
        kept[key] = Entry(row, makers[made])
    return kept


def named(maker: Maker) -> str:
    """Return by what a journal knows what made some of its rows."""
    return hashlib.sha256(json.dumps(dict(maker), sort_keys=True).encode()).hexdigest()[:12]


def _leaves(values: Mapping[str, Any], prefix: str = "") -> Row:
    """Return the innermost values of nested mappings, each with its path."""
    leaves: Row = {}
    for name, value in values.items():
        if isinstance(value, dict):
            leaves |= _leaves(value, f"{prefix}{name} ")
        else:
            leaves[prefix + name] = value
    return leaves


def seal(entry: Mapping[str, Any]) -> bytes:
    """Return an entry as a line of JSON whose first member is the checksum of the others."""
    text = json.dumps(entry).encode()[1:]
    return b'{"crc": "%08x", %b\n' % (zlib.crc32(text), text)


def unseal(line: bytes) -> Row:
    """Return the entry of a line, which comes without its end.

    Raises
    ------
    ValueError
        If the line is not what `seal` made. Every change of a single bit is noticed, and of two,
        and of any within four bytes.
    """
    match = _LINE.fullmatch(line)
    if match is None or int(match[1], 16) != zlib.crc32(match[2]):
        raise ValueError("the line is damaged")
    return dict(json.loads(b"{" + match[2]))


def _entry(folder: Path, number: int, line: bytes) -> Row:
    try:
        return unseal(line)
    except (ValueError, RecursionError) as error:
        raise _damage(folder, number) from error


def _damage(folder: Path, number: int) -> FolderError:
    return FolderError(folder, f"its {JOURNAL} is damaged in line {number}")
