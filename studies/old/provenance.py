"""What ran: versions, settings, commit, machine, and the digests of what was written."""

import errno
import gzip
import hashlib
import json
import math
import os
import platform
import subprocess
import time
import zlib
from collections.abc import Iterable, Mapping
from contextlib import suppress
from datetime import UTC, datetime
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

from studies.old.drafts import draft
from studies.old.fingerprint import ROOT
from studies.old.journal import PACKED, PROVENANCE, FolderError

NOT_INSTALLED = "not installed"
"""What stands for the version of a package that is not there."""
NUMERICAL_PACKAGES = ("numpy", "scipy", "numba")
"""Packages that a number may depend on."""
TOOLS = ("pandas", "matplotlib", "cyclopts", "tqdm")
"""Packages that run, keep and show what the others find."""


def version_of(package: str) -> str:
    """Return the version of an installed package, `NOT_INSTALLED` without it."""
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return NOT_INSTALLED


@cache
def project_version() -> str:
    """Return the version of this project, whether it is installed or run from its source."""
    source = ROOT / "pyproject.toml"
    if source.is_file():
        import tomllib

        return str(tomllib.loads(source.read_text(encoding="utf-8"))["project"]["version"])
    return version_of("rocking")


def engine_packages(names: Iterable[str] | None = None) -> list[str]:
    """Return the distributions whose versions decide what engines answer: all, or some."""
    from engines import ENGINES

    return [package for name in names or ENGINES for package in ENGINES[name].packages]


def subject(study: str, **settings: Any) -> dict[str, Any]:
    """Return what all rows of a results folder are of: the study, and its settings."""
    # as it will be read back: a tuple becomes a list
    return dict(json.loads(json.dumps({"study": study, "settings": settings})))


def versions() -> dict[str, Any]:
    """Return the versions of what may have a part in a number: project, Python, packages."""
    return {
        "version": project_version(),
        "python": platform.python_version(),
        "engines": {name: version_of(name) for name in engine_packages()},
        "packages": {name: version_of(name) for name in NUMERICAL_PACKAGES},
    }


def git_commit() -> dict[str, Any] | None:
    """Return the commit of the source and whether it was edited since; None without git."""
    if not (ROOT / ".git").exists():
        return None
    try:
        commit, edited = (
            subprocess.run(
                ["git", "-C", str(ROOT), *words.split()],
                capture_output=True,
                text=True,
                timeout=10,
                check=True,
            ).stdout.strip()
            for words in ("rev-parse HEAD", "status --porcelain -uno")
        )
    except (OSError, subprocess.SubprocessError):
        return None
    return {"commit": commit, "edited": bool(edited)}


def _cpu_model() -> str:
    with suppress(OSError):
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()


def usable_cores() -> int:
    """Return the number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def begin(path: Path, subject: dict[str, Any], arguments: dict[str, Any]) -> dict[str, Any]:
    """Write the provenance of a run that begins, after those that were made here before.

    A run is the first after an installation where what it calls has yet to be compiled.

    Raises
    ------
    FolderError
        If there is a provenance of something else.
    """
    from analytic.kernels.compiled import SOURCES
    from analytic.kernels.kept import are_compiled

    earlier, git, here = _earlier(path, subject), git_commit(), versions()
    for name, version in earlier.get("engines", {}).items():
        # an engine that is no longer here made its rows in the version of then
        if here["engines"].get(name) == NOT_INSTALLED:
            here["engines"][name] = version
    record = {
        **subject,
        **here,
        "git": git,
        "tools": {name: version_of(name) for name in TOOLS},
        "machine": {"cpu": _cpu_model(), "cores": usable_cores(), "os": platform.platform()},
        "tables": dict(earlier.get("tables", {})),
        "runs": [
            *earlier["runs"],
            {
                "start": datetime.now(UTC).isoformat(timespec="seconds"),
                "first": not are_compiled(SOURCES),
                "git": git,
                **arguments,
            },
        ],
    }
    write_record(path, record)
    return record


def write_record(path: Path, record: Mapping[str, Any]) -> None:
    """Write a provenance in one piece."""
    write_text(path, json.dumps(record, indent=2) + "\n")


def record_of(folder: Path) -> dict[str, Any]:
    """Return the provenance of a results folder; OSError if there is no such file."""
    path = folder / PROVENANCE
    if not path.is_file():
        # a pipe would be waited for
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(path))
    return dict(json.loads(path.read_text(encoding="utf-8")))


def engines_of(record: Mapping[str, Any]) -> dict[str, str]:
    """Return the versions of a record's engines, also of those that answered elsewhere."""
    versions = dict(record["engines"])
    for run in record["runs"]:
        for taken in run.get("also", ()):
            versions |= taken["engines"]
    return versions


def whole_runs(record: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the runs of a record that computed all rows, and went on until the end."""
    return [run for run in record["runs"] if run.get("computed") == run.get("rows", math.nan)]


def _earlier(path: Path, subject: dict[str, Any]) -> dict[str, Any]:
    if not path.exists():
        return {"runs": []}
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
        if all(record[name] == value for name, value in subject.items()):
            return {**record, "runs": list(record["runs"])}
    except (ValueError, KeyError, TypeError, RecursionError):
        pass
    problem = "it must be new, or hold results of the same study and settings"
    raise FolderError(path.parent, f"{problem} (its provenance.json says otherwise)")


def finish(path: Path, record: dict[str, Any], began: float, **found: Any) -> None:
    """Add to the last run how long it took since `began` (`time.perf_counter`), and what it did.

    A command finishes twice: when its tables are written, and when it has reduced and drawn them.
    """
    record["runs"][-1] |= {"duration_s": round(time.perf_counter() - began, 3), **found}
    write_record(path, record)


def write_text(path: Path, text: str) -> None:
    """Write a file in one piece: it is complete, or it is still the one before.

    Parameters
    ----------
    path : Path
        In a folder that there is.
    text : str
        Written in UTF-8, its line ends as they are.

    Raises
    ------
    OSError
        That names `path`.
    """
    with draft(path) as file:
        file.write(text.encode())


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
