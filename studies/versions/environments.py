"""An environment for each release: the engine of its own, all else shared with this one.

What differs between two releases is then the engine alone, and an environment takes no more room
than that. Only a library that was built with an older numpy gets one, too. An environment is made
once and kept.
"""

import json
import shutil
import subprocess
import sys
import time
from dataclasses import asdict, dataclass
from pathlib import Path

from engines import ENGINES
from studies.kit.fingerprint import ROOT
from studies.kit.provenance import write_text
from studies.versions.releases import MIB, Release, bytes_in

MADE = "made.json"
"""File that a finished environment is known by."""

SHARED = "shared.pth"
"""File of an environment's packages that names where to look for the others, after its own."""

OLD_NUMPY = ("numpy<2", "pandas<3")
"""What a library needs that was built with an older numpy, and the pandas that works with that."""

BUILT_WITH_OLD_NUMPY = "numpy.core.multiarray failed to import"
"""What it says without."""


class NoEnvironmentError(Exception):
    """A release that cannot be installed; one line says why."""


@dataclass(frozen=True, slots=True)
class Environment:
    """An environment, and what it took.

    Attributes
    ----------
    disk_mib : float
        Room on the disk [MiB].
    setup_s : float
        Time to make it [s].
    """

    disk_mib: float
    setup_s: float


def python_of(folder: Path) -> Path:
    """Return the interpreter of an environment."""
    return folder / "bin" / "python"


def is_made(folder: Path) -> bool:
    """Say whether a folder holds a finished environment."""
    return (folder / MADE).is_file()


def environment(folder: Path, release: Release) -> Environment:
    """Return the environment of a release in a folder, made if it is not there.

    Raises
    ------
    NoEnvironmentError
        If the release cannot be installed.
    """
    path = folder / MADE
    if is_made(folder):
        share(folder)  # this project may have been moved, or installed elsewhere, since
        return Environment(**json.loads(path.read_text(encoding="utf-8")))
    shutil.rmtree(folder, ignore_errors=True)
    began = time.perf_counter()
    folder.parent.mkdir(parents=True, exist_ok=True)
    _run([sys.executable, "-m", "venv", "--without-pip", str(folder)])
    share(folder)
    _install(folder, f"{release.package}=={release.version}")
    if _needs_old_numpy(folder, ENGINES[release.engine].library):
        _install(folder, *OLD_NUMPY)
    made = Environment(round(bytes_in(folder) / MIB, 1), round(time.perf_counter() - began, 1))
    write_text(path, json.dumps(asdict(made)) + "\n")
    return made


def share(folder: Path) -> None:
    """Let an environment find this project and what else is installed here, after its own."""
    here = [str(ROOT), *(path for path in sys.path if path.endswith("-packages"))]
    version = f"python{sys.version_info.major}.{sys.version_info.minor}"
    packages = folder / "lib" / version / "site-packages"
    write_text(packages / SHARED, "".join(f"{path}\n" for path in dict.fromkeys(here)))


def _needs_old_numpy(folder: Path, library: str) -> bool:
    """Say whether a library fails for being built with an older numpy than the one that is here."""
    command = [str(python_of(folder)), "-P", "-c", f"import {library}"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return bool(done.returncode) and BUILT_WITH_OLD_NUMPY in done.stderr


def _install(folder: Path, *requirements: str) -> None:
    pip = [sys.executable, "-m", "pip", "--python", str(python_of(folder)), "install"]
    quiet = ["--quiet", "--no-input", "--retries", "1", "--disable-pip-version-check"]
    _run([*pip, *quiet, "--only-binary", ":all:", *requirements])


def _run(command: list[str]) -> None:
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        said = [line.strip() for line in (done.stderr or done.stdout).splitlines() if line.strip()]
        errors = [line for line in said if line.startswith("ERROR")] or said or ["no reason given"]
        raise NoEnvironmentError(f"cannot be installed: {errors[-1]}")
