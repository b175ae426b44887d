"""Which releases of an engine there are, and how one is asked.

It is asked by this command once more, where its own packages are found first: a folder with the
engine alone, so that what differs between two releases is the engine, and that takes no more room.
Only a library that was built with an older numpy gets one, too. A folder is filled once and kept.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from engines import ENGINES
from studies.kit.arguments import BadInputError
from studies.kit.fingerprint import ROOT
from studies.kit.provenance import version_of
from studies.kit.tables import read_table

INSTALLED, MINOR, ALL = "installed", "minor", "all"
"""Words for the release that is here, for the last of each minor number, and for all of them."""

LISTED = re.compile(r"^Available versions: (.+)$", re.MULTILINE)
FINAL = re.compile(r"\d+(\.\d+)*(\.post\d+)?")
"""Releases that are no trial."""


class MissingError(Exception):
    """A release that cannot be had, or releases that cannot be asked for; one line says why."""


@dataclass(frozen=True, slots=True)
class Release:
    """A release of an engine's package.

    Attributes
    ----------
    engine, version : str
    """

    engine: str
    version: str

    @property
    def package(self) -> str:
        """The distribution whose version it is."""
        return ENGINES[self.engine].packages[0]

    @property
    def order(self) -> tuple[int, ...]:
        """The numbers of its version, by which releases are put in order."""
        return tuple(map(int, re.findall(r"\d+", self.version)))

    @property
    def here(self) -> bool:
        """Whether it is the one that is installed."""
        return version_of(self.package) == self.version

    @property
    def folder(self) -> str:
        """The name of its folders."""
        return f"{self.engine}-{self.version}"


def installed(engine: str) -> Release:
    """Return the release that is installed."""
    return Release(engine, version_of(ENGINES[engine].packages[0]))


def python(*words: str, first: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Run a Python that looks in a folder before it looks where this one does."""
    places = [*([first.absolute()] if first else []), ROOT, *sys.path]
    env = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, places))}
    command = [sys.executable, "-P", *words]
    return subprocess.run(command, env=env, text=True, capture_output=True)


def pip(*words: str) -> subprocess.CompletedProcess[str]:
    """Run pip, of whose packages none is built here."""
    quiet = ("--only-binary", ":all:", "--retries", "1", "--disable-pip-version-check")
    return python("-m", "pip", *words, *quiet)


def complaint(done: subprocess.CompletedProcess[str]) -> str:
    """Return what a process said last of what went wrong."""
    lines = [line.strip() for line in done.stderr.splitlines() if line.strip()]
    errors = [line for line in lines if line.startswith("ERROR")]
    return (errors or lines or [f"ended with exit code {done.returncode}"])[-1]


def listed(engine: str) -> list[Release]:
    """Return the releases with a wheel for this Python, oldest first, as pip knows them.

    Raises
    ------
    MissingError
        If pip is not there, or knows none.
    """
    package = ENGINES[engine].packages[0]
    done = pip("index", "versions", package)
    found = LISTED.search(done.stdout)
    if found is None:
        raise MissingError(f"the releases of {package} cannot be asked for: {complaint(done)}")
    versions = [word for word in found[1].split(", ") if FINAL.fullmatch(word)]
    return sorted((Release(engine, version) for version in versions), key=lambda it: it.order)


def check_releases(asked: Sequence[str], engines: Sequence[str]) -> None:
    """Refuse what names no releases of some engines.

    Parameters
    ----------
    asked : sequence of str
        INSTALLED, MINOR, ALL, or ENGINE==RELEASE of a final release, which may not exist.
    engines : sequence of str
        Those of which a release may be named.

    Raises
    ------
    BadInputError
        That names the first word which is none of these.
    """
    for word in asked:
        name, _, version = word.partition("==")
        of_one = name in engines and FINAL.fullmatch(version)
        if word not in (INSTALLED, MINOR, ALL) and not of_one:
            words = f"{INSTALLED}, {MINOR}, {ALL}, or ENGINE==RELEASE of {', '.join(engines)}"
            raise BadInputError(f"--releases is {word!r}; it must be {words}")


def chosen(engine: str, asked: Sequence[str]) -> tuple[list[Release], str]:
    """Return the releases of an engine that are asked, in order, the installed one among them.

    Parameters
    ----------
    engine : str
    asked : sequence of str
        Words and names, as `check_releases` lets them pass.

    Returns
    -------
    list of Release, str
        And why those that were not named are missing, where they are.
    """
    names = [word.partition("==") for word in asked]
    found = {
        installed(engine),
        *(Release(engine, last) for name, _, last in names if name == engine),
    }
    problem = ""
    if {MINOR, ALL}.intersection(asked):
        try:
            every = listed(engine)
            last_of_minors = {one.order[:2]: one for one in every}.values()
            found.update(every if ALL in asked else last_of_minors)
        except MissingError as error:
            problem = str(error)
    return sorted(found, key=lambda release: release.order), problem


OLD_NUMPY = ("numpy<2", "pandas<3")
"""What a library needs that was built with an older numpy, and the pandas that works with that."""

BUILT_WITH_OLD_NUMPY = "numpy.core.multiarray failed to import"
"""What it says without."""

NO_WHEEL = "No matching distribution"
"""What pip says where no package of a release suits this Python."""

USABLE = (0, 1)
"""Exit codes of a run that left its table; 1 where rows failed."""


@dataclass(frozen=True, slots=True)
class Asked:
    """What came of a release.

    Attributes
    ----------
    release : Release
    answers : DataFrame or None
        A row for each case and preset, the columns of answers.csv; None where it could not be had.
    problem : str
        Why there are no answers.
    """

    release: Release
    answers: pd.DataFrame | None
    problem: str = ""

    @property
    def has_wheel(self) -> bool:
        """Whether there is a package of it for this Python: pip lists what was never built, too."""
        return NO_WHEEL not in self.problem


def ask(release: Release, out: Path, options: Sequence[str]) -> Asked:
    """Run the short study of a release into its folder, or what is missing there.

    Parameters
    ----------
    release : Release
    out : Path
        Folder with one inside for each release, and one of environments, 2 to 300 MB each.
    options : sequence of str
        Further words of the command.
    """
    folder = out / release.folder
    packages = None if release.here else out / "environments" / release.folder
    words = ("--releases", INSTALLED, "--engines", release.engine, *options, "--out", str(folder))
    try:
        if packages:
            fill(packages, release)
        done = python("-m", "studies", "versions", *words, first=packages)
        if done.returncode not in USABLE:
            raise MissingError(complaint(done))
        answers = read_table(folder / "answers.csv", "release")
        if (found := set(answers["release"])) != {release.version}:
            raise MissingError(f"{', '.join(sorted(found))} was loaded in its stead")
    except MissingError as error:
        return Asked(release, None, str(error))
    return Asked(release, answers)


def fill(folder: Path, release: Release) -> None:
    """Install the packages of a release into a folder, unless they are there.

    Raises
    ------
    MissingError
        If the release cannot be installed.
    """
    if folder.is_dir():
        return
    part = folder.with_name(f".part.{folder.name}")
    shutil.rmtree(part, ignore_errors=True)
    _install(part, "--no-deps", f"{release.package}=={release.version}")
    tried = python("-c", f"import {ENGINES[release.engine].library}", first=part)
    if tried.returncode and BUILT_WITH_OLD_NUMPY in tried.stderr:
        _install(part, *OLD_NUMPY)
    part.rename(folder)


def _install(folder: Path, *requirements: str) -> None:
    done = pip("install", "--target", str(folder), "--quiet", "--no-input", *requirements)
    if done.returncode:
        raise MissingError(f"cannot be installed: {complaint(done)}")
