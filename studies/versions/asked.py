"""A release is asked: by this command once more, where its own packages are found first.

They are a folder with the engine alone, so that what differs between two releases is the engine,
and that takes no more room. Only a library that was built with an older numpy gets one, too. A
folder is filled once and kept.
"""

from __future__ import annotations

import json
import shutil
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import pandas as pd

from engines import ENGINES
from studies.kit.journal import Row
from studies.kit.provenance import write_text
from studies.kit.tables import read_table
from studies.versions.releases import (
    INSTALLED,
    MissingError,
    Release,
    complaint,
    pip,
    python,
    room_mib,
)

MADE = "made.json"
"""File that a finished folder is known by: disk_mib, its room [MiB], and setup_s, the time that
filling it took [s]."""

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
    made : Row
        What its packages took, as `environment` returns it; empty where they are the installed
        ones, or could not be had.
    problem : str
        Why there are no answers.
    """

    release: Release
    answers: pd.DataFrame | None
    made: Row = field(default_factory=dict)
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
    folder, made = out / release.folder, {}
    packages = None if release.here else environments / release.folder
    words = ("--releases", INSTALLED, "--engines", release.engine, *options, "--out", str(folder))
    try:
        if packages:
            made = environment(packages, release)
        done = python("-m", "studies", "versions", *words, first=packages)
        if done.returncode not in USABLE:
            raise MissingError(complaint(done))
        answers = read_table(folder / "answers.csv", "release")
        if (found := set(answers["release"])) != {release.version}:
            raise MissingError(f"{', '.join(sorted(found))} was loaded in its stead")
    except MissingError as error:
        return Asked(release, None, made, str(error))
    return Asked(release, answers, made)


def is_made(folder: Path) -> bool:
    """Say whether a folder holds the finished packages of a release."""
    return (folder / MADE).is_file()


def environment(folder: Path, release: Release) -> Row:
    """Return what is known of the packages of a release in a folder, filled if it is not yet.

    Raises
    ------
    MissingError
        If the release cannot be installed.
    """
    if not is_made(folder):
        shutil.rmtree(folder, ignore_errors=True)
        began = time.perf_counter()
        _install(folder, "--no-deps", f"{release.package}=={release.version}")
        tried = python("-c", f"import {ENGINES[release.engine].library}", first=folder)
        if tried.returncode and BUILT_WITH_OLD_NUMPY in tried.stderr:
            _install(folder, *OLD_NUMPY)
        took = round(time.perf_counter() - began, 1)
        found = {"disk_mib": round(room_mib([folder]), 1), "setup_s": took}
        write_text(folder / MADE, json.dumps(found) + "\n")
    return dict(json.loads((folder / MADE).read_text(encoding="utf-8")))


def _install(folder: Path, *requirements: str) -> None:
    done = pip("install", "--target", str(folder), "--quiet", "--no-input", *requirements)
    if done.returncode:
        raise MissingError(f"cannot be installed: {complaint(done)}")
