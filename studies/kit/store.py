"""A results folder: finished rows in SQLite, tables as CSV, and what made them as JSON."""

from __future__ import annotations

import json
import os
import platform
import sqlite3
import subprocess
import time
import tomllib
from collections.abc import Iterable, Mapping
from contextlib import suppress
from datetime import UTC, datetime
from functools import cache
from operator import methodcaller
from pathlib import Path
from typing import Any, Self

import pandas as pd

from analytic.kernels.forms import SOURCES
from analytic.kernels.kept import are_compiled
from engines import ENGINES
from studies.cases.refusal import BadInputError
from studies.kit.identity import COMPUTING, NOT_INSTALLED, ROOT, Maker, changed, version_of, why
from studies.kit.jobs import Job, Row
from studies.kit.say import say
from studies.kit.tables import PACKED, digest, table_in, tables_of, write_table, write_text

ROWS, PROVENANCE = "rows.sqlite", "provenance.json"
LOST = ("no result within the time limit", "the process ", "every worker ")
"""How the message of a row begins whose process has ended, which another run may not do."""

Rows = dict[str, tuple[Maker, Row]]
"""Key of a job -> what made its row, and the row."""

_plain = methodcaller("item")
"""Returns a number of numpy as one of Python."""


class FolderError(BadInputError):
    """A results folder that cannot be used; the message is one line that says why."""

    def __init__(self, folder: Path, problem: str, option: str = "--out") -> None:
        super().__init__(f"{option} is {str(folder)!r}; {problem}")


class Store:
    """The rows of a study in a folder, which one run at a time may write to."""

    def __init__(self, folder: Path, study: str, table: str = "") -> None:
        self.folder, self.study, self.table = folder, study, table
        self._began, self._computed = time.perf_counter(), 0
        self._taken: list[Row] = []
        self._first = not are_compiled(SOURCES)
        try:
            fresh = not (folder / ROWS).exists()
            if fresh and folder.is_dir() and not _may_be_filled(folder, study, table):
                words = f"it must be new or empty, or hold the {ROWS} of this study"
                raise FolderError(folder, words)
            folder.mkdir(parents=True, exist_ok=True)
            self._base = sqlite3.connect(folder / ROWS, timeout=0.2, isolation_level=None)
            # a row that is written survives kill -9; the lock ends with the process
            for line in ("locking_mode=EXCLUSIVE", "journal_mode=WAL", "synchronous=NORMAL"):
                self._base.execute(f"PRAGMA {line}")
            self._base.execute("CREATE TABLE IF NOT EXISTS rows (key PRIMARY KEY, made, row)")
            self._base.execute("CREATE TABLE IF NOT EXISTS study (name PRIMARY KEY)")
            self._base.execute("BEGIN IMMEDIATE")
            known = [name for (name,) in self._base.execute("SELECT name FROM study")] or [study]
            self._base.execute("INSERT OR IGNORE INTO study VALUES (?)", known)
            self._base.execute("COMMIT")
        except OSError as error:
            words = f"it must be a folder that can be written ({error.strerror or error})"
            raise FolderError(folder, words) from error
        except sqlite3.Error as error:
            busy = "locked" in str(error)
            words = "it must not be in use by another run" if busy else f"its {ROWS}: {error}"
            raise FolderError(folder, words) from error
        if known != [study]:
            raise FolderError(
                folder, f"it holds results of {known[0]}; {study} needs another folder"
            )
        self.filled = fresh and (folder / PROVENANCE).is_file()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        with suppress(sqlite3.Error):
            self._base.execute("PRAGMA journal_mode=DELETE")  # one file, which can be copied
        self._base.close()

    def kept(self, jobs: Mapping[str, Job], makers: Mapping[str, Maker]) -> dict[str, Row]:
        """Return the rows that would be made so now, without those that another run may mend."""
        # a folder that holds rows of what is not asked for is refused: no table loses them unseen
        if self.filled:
            self._fill(jobs, makers)
        rows = self._rows()
        if other := [row for key, (_, row) in rows.items() if key not in jobs]:
            labels = labels_of(next(iter(jobs.values()))) if jobs else ["source"]
            self._refuse_unasked(other[0], labels)
        found, stale = _sorted(rows, jobs, makers)
        if stale:
            say(f"{len(found)} of {len(jobs)} rows are kept; computed again: {why(stale)}")
        return {
            key: row
            for key, row in found.items()
            if row["outcome"] != "failed" or not str(row.get("message", "")).startswith(LOST)
        }

    def _rows(self) -> Rows:
        try:
            return _read(self._base)
        except (sqlite3.Error, ValueError, TypeError) as error:
            raise FolderError(self.folder, f"its {ROWS} is damaged ({error})") from error

    def _refuse_unasked(self, row: Mapping[Any, Any], labels: Iterable[str]) -> None:
        """Refuse a row that is not asked for, by its labels; it may differ in other options."""
        which = ", ".join(f"{name} {row[name]}" for name in labels if name in row)
        words = f"it also holds results of {which}; ask for those, too, or use a new folder"
        raise FolderError(self.folder, words)

    def _fill(self, jobs: Mapping[str, Job], makers: Mapping[str, Maker]) -> None:
        """Take the rows of a folder's table, which its provenance says what made."""
        made = provenance_of(self.folder).get("made", {})
        keys = {json.dumps(labels_of(job), default=_plain): key for key, job in jobs.items()}
        labels = [*labels_of(next(iter(jobs.values())))] if jobs else []
        for row in table_in(self.folder, self.table).to_dict("records"):
            name = json.dumps({label: row.get(label) for label in labels}, default=_plain)
            if name not in keys:
                self._refuse_unasked(row, labels)
            if row["source"] in made:
                self._write(keys[name], row, made[row["source"]])
        self.filled = False

    def add(self, key: str, row: Row, maker: Maker) -> None:
        """Store a row that was computed, at once and in one piece."""
        self._write(key, row, maker)
        self._computed += 1

    def _write(self, key: str, row: Mapping[Any, Any], maker: Maker) -> None:
        values = key, json.dumps(maker, sort_keys=True), json.dumps(row, default=_plain)
        try:
            self._base.execute("REPLACE INTO rows VALUES (?, ?, ?)", values)
        except sqlite3.Error as error:
            raise FolderError(self.folder, f"its {ROWS} cannot be written ({error})") from error

    def take(self, other: Path, jobs: Mapping[str, Job], makers: Mapping[str, Maker]) -> None:
        """Copy from another folder the rows of some jobs that would be made so here."""
        rows = _rows_of(other)
        found, stale = _sorted(rows, jobs, makers)
        if not found:
            words = f"all its rows are stale ({why(stale)})"
            none = "it holds no row of what is asked for"
            raise FolderError(other, words if stale else none, "--also")
        if stale:
            say(f"not taken from {str(other)!r}: {why(stale)}")
        mine, count, engines = self._rows(), 0, dict[str, str | None]()
        for key, row in found.items():
            source = jobs[key].asked
            able = not source.engine or source.declared.installed
            known = key in mine and not changed(mine[key][0], makers[row["source"]])
            if known or (row["outcome"] == "failed" and able):
                continue
            made = rows[key][0]
            self._write(key, row, made)
            packages = source.declared.packages if source.engine else ()
            engines |= {name: made[name] for name in packages if name in made}
            count += 1
        record = provenance_of(other)
        said = {name: record.get(name) for name in ("git", "machine")}
        self._taken.append({**said, "engines": engines, "rows": count})

    def finish(
        self,
        tables: Mapping[str, pd.DataFrame],
        makers: Mapping[str, Maker],
        rows: int,
        /,
        **asked: Any,
    ) -> None:
        """Write tables by their names, and what made them: versions, sources, what was asked."""
        for name, table in tables.items():
            write_table(self.folder / f"{name}.csv", _with_head(table, self.study, name))
        before = provenance_of(self.folder)
        run = {
            "start": datetime.now(UTC).isoformat(timespec="seconds"),
            "first": self._first,  # since an installation: it compiles what it calls
            "git": commit(),
            **asked,
            "duration_s": round(time.perf_counter() - self._began, 3),
            **{"rows": rows, "computed": self._computed},
            **({"also": self._taken} if self._taken else {}),
        }
        record = {"study": self.study, **versions(before), "git": commit(), "machine": machine()}
        if not self._computed:  # its times are of where its rows were computed
            record["machine"] = before.get("machine", record["machine"])
        runs = [*before.get("runs", ()), run]
        write_record(self.folder, {**record, "made": makers, "runs": runs})


def _with_head(table: pd.DataFrame, study: str, name: str) -> pd.DataFrame:
    """Return a table of a study; one that has no columns with those of the published one."""
    if len(table.columns):
        return table
    columns = Path(__file__).parents[1] / "published" / "columns.csv"
    known = pd.read_csv(columns, keep_default_na=False)
    mine = known["table"].isin([f"{study}/{name}.csv{end}" for end in ("", PACKED)])
    return pd.DataFrame(columns=known.loc[mine, "column"].drop_duplicates())


def _read(base: sqlite3.Connection) -> Rows:
    rows = base.execute("SELECT key, made, row FROM rows").fetchall()
    then = {made: json.loads(made) for made in {made for _, made, _ in rows}}
    return {key: (then[made], json.loads(text)) for key, made, text in rows}


def _rows_of(other: Path) -> Rows:
    """Return the rows of the folder that --also names."""
    if not (other / ROWS).is_file():
        words = f"it must be a results folder, with its {ROWS} and {PROVENANCE}"
        raise FolderError(other, words, "--also")
    try:
        base = sqlite3.connect(f"file:{other / ROWS}?mode=ro", uri=True, timeout=0.2)
        rows = _read(base)
        base.close()
    except (sqlite3.Error, ValueError, TypeError) as error:
        raise FolderError(other, f"its {ROWS} cannot be read ({error})", "--also") from error
    return rows


def _may_be_filled(folder: Path, study: str, table: str) -> bool:
    """Return whether a folder without a store is empty, or holds a table to fill one from."""
    if not any(each for each in folder.iterdir() if not each.name.startswith(".")):
        return True
    known = any((folder / f"{table}.csv{end}").is_file() for end in ("", PACKED))
    return bool(table) and known and provenance_of(folder).get("study") == study


def labels_of(job: Job) -> Row:
    """Return the columns that name a job's row."""
    return {**job.labels, "source": job.source}


def _sorted(
    rows: Rows, jobs: Mapping[str, Job], makers: Mapping[str, Maker]
) -> tuple[dict[str, Row], list[tuple[str, Maker, Maker]]]:
    """Return the rows of jobs that would be made so now, and of the others why not."""
    found, stale = {}, []
    for key in (key for key in rows if key in jobs):
        source, (then, row) = jobs[key].source, rows[key]
        if changed(then, makers[source]):
            stale.append((source, then, makers[source]))
        else:
            found[key] = row
    return found, stale


@cache
def project_version() -> str:
    """Return the version of this project, whether it is installed or run from its source."""
    source = ROOT / "pyproject.toml"
    if source.is_file():
        return str(tomllib.loads(source.read_text(encoding="utf-8"))["project"]["version"])
    return version_of("rocking")


def versions(before: Mapping[str, Any]) -> dict[str, Any]:
    """Return the versions of all that computes; of an absent engine the one that `before` names."""
    engines = {name: version_of(name) for one in ENGINES.values() for name in one.packages}
    known = before.get("engines", {})
    engines |= {name: known[name] for name in known if engines.get(name) == NOT_INSTALLED}
    return {
        "version": project_version(),
        "python": platform.python_version(),
        "engines": engines,
        "packages": {name: version_of(name) for name in (*COMPUTING, "pandas", "matplotlib")},
    }


@cache
def commit() -> dict[str, Any] | None:
    """Return the commit of the source and whether it was edited since; None without git."""
    if not (ROOT / ".git").exists():
        return None
    words = ["git", "describe", "--always", "--abbrev=40", "--exclude=*", "--dirty"]
    with suppress(OSError, subprocess.SubprocessError):
        said = subprocess.run(
            words, cwd=ROOT, capture_output=True, text=True, timeout=10, check=True
        )
        hash_, _, edited = said.stdout.strip().partition("-")
        return {"commit": hash_, "edited": bool(edited)}
    return None


def machine() -> dict[str, Any]:
    """Return the processor, the number of cores and the operating system."""
    cpu = platform.processor() or platform.machine()
    with suppress(OSError, StopIteration):
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        named = next(line for line in lines if line.startswith("model name"))
        cpu = named.partition(":")[2].strip()
    return {"cpu": cpu, "cores": usable_cores(), "os": platform.platform()}


def usable_cores() -> int:
    """Return the number of cores that this process may use."""
    here = hasattr(os, "sched_getaffinity")
    return len(os.sched_getaffinity(0)) if here else os.cpu_count() or 1


def provenance_of(folder: Path) -> dict[str, Any]:
    """Return what a folder's provenance says; nothing where there is none."""
    path = folder / PROVENANCE
    with suppress(ValueError, RecursionError):
        record = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
        if isinstance(record, dict):
            return record
    raise FolderError(folder, f"its {PROVENANCE} cannot be read")


def write_record(folder: Path, record: Mapping[str, Any]) -> None:
    """Write a provenance with the digest of each table that lies beside it."""
    kept = {path.name.removesuffix(PACKED): digest(path) for path in tables_of(folder)}
    write_text(folder / PROVENANCE, json.dumps({**record, "tables": kept}, indent=2) + "\n")


def engines_of(record: Mapping[str, Any]) -> dict[str, str]:
    """Return the versions of a record's engines, also of those that answered elsewhere."""
    taken = [also["engines"] for run in record["runs"] for also in run.get("also", ())]
    return {name: it for known in (record["engines"], *taken) for name, it in known.items()}


def check(folder: Path, names: Iterable[str], option: str) -> None:
    """Refuse tables of a folder that are not what a study wrote; a missing one is passed over."""
    for name in names:
        for path in (folder / name, folder / f"{name}{PACKED}"):
            if os.path.lexists(path) and (problem := _problem(path)):
                raise FolderError(folder, f"its {path.relative_to(folder)} {problem}", option)


def _problem(path: Path) -> str:
    if not path.is_file():
        return "must be a file"
    known = provenance_of(path.parent).get("tables", {}).get(path.name.removesuffix(PACKED))
    if known is None:
        return f"must be beside the {PROVENANCE} that has its digest"
    try:
        same = digest(path) == known
    except (EOFError, OSError):
        same = False
    return "" if same else f"is not what its {PROVENANCE} tells of: edited, cut or of another run"
