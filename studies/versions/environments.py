"""The packages of each release: a folder with the engine alone, found before all that is here.

What differs between two releases is then the engine alone, and its folder takes no more room than
that. Only a library that was built with an older numpy gets one, too. A folder is filled once and
kept.
"""

import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

from engines import ENGINES
from studies.kit.fingerprint import ROOT
from studies.kit.journal import Row
from studies.kit.provenance import write_text
from studies.versions.releases import MIB, Release, bytes_in

MADE = "made.json"
"""File that a finished folder is known by: disk_mib, its room [MiB], and setup_s, the time that
filling it took [s]."""

OLD_NUMPY = ("numpy<2", "pandas<3")
"""What a library needs that was built with an older numpy, and the pandas that works with that."""

BUILT_WITH_OLD_NUMPY = "numpy.core.multiarray failed to import"
"""What it says without."""


class NoEnvironmentError(Exception):
    """A release that cannot be installed; one line says why."""


def is_made(folder: Path) -> bool:
    """Say whether a folder holds the finished packages of a release."""
    return (folder / MADE).is_file()


def variables(folder: Path | None = None) -> dict[str, str]:
    """Return the variables of a process that looks in a folder before it looks where this does."""
    first = [] if folder is None else [folder.absolute()]
    return {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, [*first, ROOT, *sys.path]))}


def environment(folder: Path, release: Release) -> Row:
    """Return what is known of the packages of a release in a folder, filled if it is not yet.

    Raises
    ------
    NoEnvironmentError
        If the release cannot be installed.
    """
    made = folder / MADE
    if not is_made(folder):
        shutil.rmtree(folder, ignore_errors=True)
        began = time.perf_counter()
        _install(folder, "--no-deps", f"{release.package}=={release.version}")
        if _needs_old_numpy(folder, ENGINES[release.engine].library):
            _install(folder, *OLD_NUMPY)
        took = round(time.perf_counter() - began, 1)
        found = {"disk_mib": round(bytes_in(folder) / MIB, 1), "setup_s": took}
        write_text(made, json.dumps(found) + "\n")
    return dict(json.loads(made.read_text(encoding="utf-8")))


def _needs_old_numpy(folder: Path, library: str) -> bool:
    """Say whether a library fails for being built with an older numpy than the one that is here."""
    command = [sys.executable, "-P", "-c", f"import {library}"]
    done = subprocess.run(
        command, env=variables(folder), capture_output=True, text=True, check=False
    )
    return bool(done.returncode) and BUILT_WITH_OLD_NUMPY in done.stderr


def _install(folder: Path, *requirements: str) -> None:
    pip = [sys.executable, "-m", "pip", "install", "--target", str(folder)]
    quiet = ["--quiet", "--no-input", "--retries", "1", "--disable-pip-version-check"]
    command = [*pip, *quiet, "--only-binary", ":all:", *requirements]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        said = [line.strip() for line in (done.stderr or done.stdout).splitlines() if line.strip()]
        errors = [line for line in said if line.startswith("ERROR")] or said or ["no reason given"]
        raise NoEnvironmentError(f"cannot be installed: {errors[-1]}")
