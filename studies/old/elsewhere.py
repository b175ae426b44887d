"""Rows of other results folders: of engines in an environment of their own, of another machine."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

from engines import ENGINES
from studies.old.identity import Makers, sorted_rows, why
from studies.old.jobs import Job
from studies.old.journal import JOURNAL, PROVENANCE, FolderError, Journal, Kept, Row, rows_of
from studies.old.provenance import record_of
from studies.old.refusing import say
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


@contextmanager
def _blamed(folder: Path) -> Iterator[None]:
    """Refuse a folder by the option that it was named by."""
    problem = f"it must be a results folder, with its {JOURNAL} and {PROVENANCE}"
    try:
        yield
    except FolderError as error:
        raise FolderError(folder, error.problem, OPTION) from error
    except (OSError, ValueError, TypeError, KeyError) as error:
        raise FolderError(folder, problem, OPTION) from error


def read(folder: Path, subject: Mapping[str, Any]) -> Elsewhere:
    """Read results of a study with certain settings.

    Raises
    ------
    FolderError
        If the folder holds no such results.
    """
    with _blamed(folder):
        record = record_of(folder)
        path = folder / JOURNAL
        if not path.is_file():
            raise FileNotFoundError  # on a pipe a run would hang
        kept = rows_of(path, path.read_bytes(), subject)
        return Elsewhere(folder, kept, {name: record[name] for name in ("git", "machine")})


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
    with _blamed(other.folder):
        valid, stale = sorted_rows(jobs, other.kept, makers, other.folder)
        if not valid:
            words = f"all its rows are stale ({why(stale)})"
            raise FolderError(
                other.folder, words if stale else "it holds no row of what is asked for"
            )
    versions: dict[str, str] = {}
    here, _ = sorted_rows(jobs, journal.kept, makers, journal.folder)
    taken = [key for key, row in valid.items() if key not in here and _is_wanted(row)]
    for key in taken:
        row, then = other.kept[key]
        journal.append(key, row, then)
        engine = resolve(row["source"]).engine
        versions |= {name: then[name] for name in (ENGINES[engine].packages if engine else ())}
    if stale:
        say(f"not taken from {str(other.folder)!r}: {why(stale)}")
    return {**other.made, "engines": versions, "rows": len(taken)}


def _is_wanted(row: Row) -> bool:
    """Return whether a row is as good as one that could be made here."""
    engine = resolve(row["source"]).engine
    return row["outcome"] != "failed" or bool(engine and not ENGINES[engine].installed)
