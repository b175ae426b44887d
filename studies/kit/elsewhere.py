"""Rows of other results folders: of engines in an environment of their own, of another machine."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from engines import ENGINES
from studies.kit.jobs import Job
from studies.kit.journal import (
    JOURNAL,
    PROVENANCE,
    FolderError,
    Journal,
    Row,
    belongs_to,
    differences,
    rows_of,
)
from studies.kit.provenance import NOT_INSTALLED, record_of
from studies.sources.registry import resolve

OPTION = "--also"
"""By which the folders are named."""


def take(
    folder: Path, identity: Mapping[str, Any], jobs: Sequence[Job], journal: Journal
) -> dict[str, Any]:
    """Copy into a journal the rows of its jobs that it has not yet and another folder has.

    A failure is taken only where its engine is not installed; else it is tried again.

    Parameters
    ----------
    folder : Path
        Results of the same study, version and settings; versions of engines may differ.
    identity : mapping
        What the journal's own folder belongs to.
    jobs : sequence of Job
    journal : Journal

    Returns
    -------
    dict
        What a provenance says of it: the commit and machine of the other folder, the versions of
        the engines whose rows were taken, and their number.

    Raises
    ------
    FolderError
        If the folder holds no such results, or those of an engine that is installed in another
        version.
    """
    try:
        there, rows = _read(folder, identity)
        record = record_of(folder)
        made: Row = {name: record[name] for name in ("git", "machine")}
    except FolderError as error:
        raise FolderError(folder, error.problem, OPTION) from error
    except (OSError, ValueError, TypeError, KeyError) as error:
        problem = f"it must be a results folder, with its {JOURNAL} and {PROVENANCE}"
        raise FolderError(folder, problem, OPTION) from error
    asked = [job.key for job in jobs if job.key in rows]
    if not asked:
        raise FolderError(folder, "it holds no row of what is asked for", OPTION)
    lacking = {key: rows[key] for key in asked if key not in journal.rows}
    found = {key: row for key, row in lacking.items() if _taken(row)}
    versions: Row = {}
    for row in found.values():
        versions |= _versions_of(row["source"], there)
    _refuse_others(folder, versions, identity["engines"])
    for key, row in found.items():
        journal.append(key, row)
    return {**made, "engines": versions, "rows": len(found)}


def _read(folder: Path, identity: Mapping[str, Any]) -> tuple[Row, dict[str, Row]]:
    """Return the versions of a folder's engines, and its rows."""
    path = folder / JOURNAL
    found = belongs_to(path)
    there = dict(found.get("engines", {}))
    expected = {"journal": found["journal"], **identity, "engines": there}
    if found != expected:
        words = "it must hold results of the same version and settings"
        raise FolderError(folder, f"{words} ({differences(found, expected)})")
    return there, rows_of(path)


def _taken(row: Row) -> bool:
    """Return whether a row is better than one that could be made here."""
    engine = resolve(row["source"]).engine
    return row["outcome"] != "failed" or bool(engine and not ENGINES[engine].installed)


def _versions_of(source: str, there: Mapping[str, str]) -> Row:
    """Return the versions of the packages of a source's engine; of another source none."""
    engine = resolve(source).engine
    return {name: there[name] for name in ENGINES[engine].packages} if engine else {}


def _refuse_others(folder: Path, versions: Mapping[str, str], here: Mapping[str, str]) -> None:
    other = [
        f"{name} {version}, and {here[name]} is installed"
        for name, version in versions.items()
        if here[name] not in (version, NOT_INSTALLED)
    ]
    if other:
        raise FolderError(folder, f"it holds results of {'; '.join(other)}", OPTION)
