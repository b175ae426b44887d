"""What ran: versions, settings, commit, machine."""

import hashlib
import json
import os
import platform
import subprocess
import sys
import time
from datetime import UTC, datetime
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

from studies.kit.journal import FolderError

PACKAGES = ("numpy", "scipy", "numba", "pandas", "matplotlib", "cyclopts", "pebble", "tqdm")
ROOT = Path(__file__).parents[2]


def version_of(package: str) -> str:
    """Return the version of an installed package, "not installed" without it."""
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "not installed"


@cache
def project_version() -> str:
    """Return the version of this project, whether it is installed or run from its source."""
    source = ROOT / "pyproject.toml"
    if source.is_file():
        import tomllib

        return str(tomllib.loads(source.read_text(encoding="utf-8"))["project"]["version"])
    return version_of("rocking")


@cache
def code_fingerprint() -> str:
    """Return a hash of everything that decides a number: the reference, engines and cases."""
    files = [
        path
        for part in ("analytic", "engines", "studies")
        for path in sorted((ROOT / part).rglob("*.py"))
    ]
    digest = hashlib.sha256()
    for path in files:
        digest.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()[:12]


def engine_packages() -> list[str]:
    """Return the distributions whose versions decide what the engines answer."""
    from engines import ENGINES

    return [package for engine in ENGINES.values() for package in engine.packages]


def identity(study: str, **settings: Any) -> dict[str, Any]:
    """Return what the rows of a results folder depend on besides their own case and source."""
    parts = {
        "study": study,
        "version": project_version(),
        "code": code_fingerprint(),
        "engines": {name: version_of(name) for name in engine_packages()},
        "settings": settings,
    }
    # as it will be read back: a tuple becomes a list
    return dict(json.loads(json.dumps(parts)))


def git_commit() -> dict[str, Any] | None:
    """Return the commit of the source and whether it was edited since; None without git."""
    try:
        commit = _git("rev-parse", "HEAD")
        return {"commit": commit, "edited": bool(_git("status", "--porcelain", "-uno"))}
    except (OSError, subprocess.SubprocessError):
        return None


def _git(*arguments: str) -> str:
    if not (ROOT / ".git").exists():
        raise FileNotFoundError("not a working copy")
    command = ["git", "-C", str(ROOT), *arguments]
    done = subprocess.run(command, capture_output=True, text=True, timeout=10, check=True)
    return done.stdout.strip()


def _cpu_model() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        return next(
            line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")
        )
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()


def usable_cores() -> int:
    """Return the number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def begin(path: Path, subject: dict[str, Any], arguments: dict[str, Any]) -> dict[str, Any]:
    """Write the provenance of a run that begins, after those that were made here before.

    Raises
    ------
    FolderError
        If there is a provenance of something else.
    """
    record = {
        **subject,
        "git": git_commit(),
        "python": sys.version.split()[0],
        "packages": {name: version_of(name) for name in PACKAGES},
        "machine": {
            "cpu": _cpu_model(),
            "cores": usable_cores(),
            "os": platform.platform(),
        },
        "runs": [
            *_earlier_runs(path, subject),
            {"start": datetime.now(UTC).isoformat(timespec="seconds"), **arguments},
        ],
    }
    write_text(path, json.dumps(record, indent=2) + "\n")
    return record


def _earlier_runs(path: Path, subject: dict[str, Any]) -> list[Any]:
    if not path.exists():
        return []
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
        if all(record[name] == value for name, value in subject.items()):
            return list(record["runs"])
    except (ValueError, KeyError, TypeError):
        pass
    problem = "it must be new, or hold results of the same version and settings"
    raise FolderError(path.parent, f"{problem} (its provenance.json says otherwise)")


def finish(path: Path, record: dict[str, Any], began: float, **counted: int) -> None:
    """Add to the last run how long it took since `began` (`time.perf_counter`), and what it did."""
    record["runs"][-1] |= {"duration_s": round(time.perf_counter() - began, 3), **counted}
    write_text(path, json.dumps(record, indent=2) + "\n")


def write_text(path: Path, text: str) -> None:
    """Write a file in one piece: it is complete, or it is still the one before."""
    draft = path.with_name(f".{path.name}.part")
    draft.write_text(text, encoding="utf-8")
    draft.replace(path)
