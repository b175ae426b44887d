"""Rows of other results folders: of engines in an environment of their own, of another machine."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from engines import ENGINES
from studies.kit.identity import Makers, changed, why
from studies.kit.jobs import Job
from studies.kit.journal import (
    FORMAT,
    JOURNAL,
    PROVENANCE,
    FolderError,
    Journal,
    Kept,
    Row,
    belongs_to,
    differences,
    rows_in,
)
from studies.kit.provenance import record_of
from studies.kit.streams import say
from studies.sources.registry import resolve

OPTION = "--also"
"""By which the folders are named."""


class Elsewhere(NamedTuple):
    """What another results folder holds.

    Attributes
    ----------
    folder : Path
    kept : Kept
        Its rows, failures among them, and what made them.
    made : mapping
        What its provenance says of commit and machine.
    """

    folder: Path
    kept: Kept
    made: Row


def read(folder: Path, subject: Mapping[str, Any]) -> Elsewhere:
    """Read results of a study with certain settings.

    Raises
    ------
    FolderError
        If the folder holds no such results.
    """
    problem = f"it must be a results folder, with its {JOURNAL} and {PROVENANCE}"
    path = folder / JOURNAL
    if not (path.is_file() and (folder / PROVENANCE).is_file()):
        raise FolderError(folder, problem, OPTION)  # on a pipe a run would hang
    try:
        found = belongs_to(path)
        expected = {"journal": FORMAT, **subject}
        if found != expected:
            words = "it must hold results of the same study and settings"
            raise FolderError(folder, f"{words} ({differences(found, expected)})")
        record = record_of(folder)
        made = {name: record[name] for name in ("git", "machine")}
        return Elsewhere(folder, rows_in(folder, path.read_bytes()), made)
    except FolderError as error:
        raise FolderError(folder, error.problem, OPTION) from error
    except (OSError, ValueError, TypeError, KeyError) as error:
        raise FolderError(folder, problem, OPTION) from error


def take(other: Elsewhere, jobs: Sequence[Job], journal: Journal, makers: Makers) -> dict[str, Any]:
    """Copy into a journal the rows of its jobs that it has not yet and that would be made so here.

    A failure is taken only where its engine is not installed; else it is tried again. How many
    rows are left, since they would be made otherwise here, is said on stderr.

    Parameters
    ----------
    other : Elsewhere
    jobs : sequence of Job
    journal : Journal
    makers : Makers
        What makes the rows of the jobs here.

    Returns
    -------
    dict
        What a provenance says of it: the commit and machine of the other folder, the versions of
        the engines whose rows were taken, and their number.

    Raises
    ------
    FolderError
        If there is no row of the jobs, or none that would be made so here.
    """
    entries, made_by = other.kept
    asked = {key: job for job in jobs if (key := job.key) in entries}
    if not asked:
        raise FolderError(other.folder, "it holds no row of what is asked for", OPTION)
    if not all(job.has_made(entries[key].row) for key, job in asked.items()):
        raise FolderError(other.folder, f"its {JOURNAL} has a row of something else", OPTION)
    versions: dict[str, str] = {}
    stale, taken = [], 0
    for key, job in asked.items():
        row, then, now = entries[key].row, made_by[entries[key].made], makers.of(job)
        known = key in journal.entries and not changed(journal.maker_of(key), now)
        if changed(then, now):
            stale.append((job.source, then, now))
        elif not known and _is_wanted(row):
            journal.append(key, row, then)
            taken += 1
            engine = job.asked.engine
            packages = ENGINES[engine].packages if engine else ()
            versions |= {name: then[name] for name in packages}
    if len(stale) == len(asked):
        raise FolderError(other.folder, f"all its rows are stale ({why(stale)})", OPTION)
    if stale:
        say(f"not taken from {str(other.folder)!r}: {why(stale)}")
    return {**other.made, "engines": versions, "rows": taken}


def _is_wanted(row: Row) -> bool:
    """Return whether a row is as good as one that could be made here."""
    engine = resolve(row["source"]).engine
    return row["outcome"] != "failed" or bool(engine and not ENGINES[engine].installed)
