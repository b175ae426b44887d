"""Rows of other results folders: of engines in an environment of their own, of another machine."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from engines import ENGINES
from studies.kit.jobs import Job
from studies.kit.journal import (
    FORMAT,
    JOURNAL,
    PROVENANCE,
    FolderError,
    Journal,
    Row,
    belongs_to,
    differences,
    rows_in,
)
from studies.kit.provenance import NOT_INSTALLED, record_of
from studies.sources.registry import resolve

OPTION = "--also"
"""By which the folders are named."""


class Elsewhere(NamedTuple):
    """What another results folder holds.

    Attributes
    ----------
    folder : Path
    rows : mapping
        By the keys of their jobs, failures among them.
    engines : mapping
        Package of an engine -> its version there.
    made : mapping
        What its provenance says of commit and machine.
    """

    folder: Path
    rows: Mapping[str, Row]
    engines: Mapping[str, str]
    made: Row


def read(folder: Path, identity: Mapping[str, Any]) -> Elsewhere:
    """Read results of what an identity names; versions of engines may differ.

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
        engines = dict(found["engines"])
        expected = {"journal": FORMAT, **identity, "engines": engines}
        if found != expected:
            words = "it must hold results of the same version and settings"
            raise FolderError(folder, f"{words} ({differences(found, expected)})")
        record = record_of(folder)
        made = {name: record[name] for name in ("git", "machine")}
        return Elsewhere(folder, rows_in(folder, path.read_bytes()), engines, made)
    except FolderError as error:
        raise FolderError(folder, error.problem, OPTION) from error
    except (OSError, ValueError, TypeError, KeyError) as error:
        raise FolderError(folder, problem, OPTION) from error


def take(
    other: Elsewhere, jobs: Sequence[Job], journal: Journal, here: Mapping[str, str]
) -> dict[str, Any]:
    """Copy into a journal the rows of its jobs that it has not yet.

    A failure is taken only where its engine is not installed; else it is tried again.

    Parameters
    ----------
    other : Elsewhere
    jobs : sequence of Job
    journal : Journal
    here : mapping
        Package of an engine -> its version here.

    Returns
    -------
    dict
        What a provenance says of it: the commit and machine of the other folder, the versions of
        the engines whose rows were taken, and their number.

    Raises
    ------
    FolderError
        If there is no row of the jobs, or one of an engine that is installed in another version.
    """
    by_key = {job.key: job for job in jobs}
    asked = [key for key in by_key if key in other.rows]
    if not asked:
        raise FolderError(other.folder, "it holds no row of what is asked for", OPTION)
    if not all(by_key[key].has_made(other.rows[key]) for key in asked):
        raise FolderError(other.folder, f"its {JOURNAL} has a row of something else", OPTION)
    lacking = {key: other.rows[key] for key in asked if key not in journal.rows}
    found = {key: row for key, row in lacking.items() if _is_wanted(row)}
    engines = {resolve(row["source"]).engine for row in found.values()} - {""}
    packages = [name for engine in sorted(engines) for name in ENGINES[engine].packages]
    versions = {name: other.engines[name] for name in packages}
    others = [
        f"{name} {version}, and {here[name]} is installed"
        for name, version in versions.items()
        if here[name] not in (version, NOT_INSTALLED)
    ]
    if others:
        raise FolderError(other.folder, f"it holds results of {'; '.join(others)}", OPTION)
    for key, row in found.items():
        journal.append(key, row)
    return {**other.made, "engines": versions, "rows": len(found)}


def _is_wanted(row: Row) -> bool:
    """Return whether a row is as good as one that could be made here."""
    engine = resolve(row["source"]).engine
    return row["outcome"] != "failed" or bool(engine and not ENGINES[engine].installed)
