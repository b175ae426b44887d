"""A release is asked: by this command once more, where its own packages are found first.

They are a folder with the engine alone, so that what differs between two releases is the engine,
and that takes no more room. Only a library that was built with an older numpy gets one, too. A
folder is filled once and kept.
"""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from engines import ENGINES
from studies.kit.tables import read_table
from studies.versions.releases import (
    INSTALLED,
    MissingError,
    Release,
    complaint,
    pip,
    python,
)

OLD_NUMPY = ("numpy<2", "pandas<3")
"""What a library needs that was built with an older numpy, and the pandas that works with that."""

BUILT_WITH_OLD_NUMPY = "numpy.core.multiarray failed to import"
"""What it says without."""

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


def ask(release: Release, out: Path, environments: Path, options: Sequence[str]) -> Asked:
    """Run the short study of a release into its folder, or what is missing there.

    Parameters
    ----------
    release : Release
    out, environments : Path
        Folders, with one inside for each release.
    options : sequence of str
        Further words of the command.
    """
    folder = out / release.folder
    packages = None if release.here else environments / release.folder
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
