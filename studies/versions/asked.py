"""A release is asked: by this command once more, where its own packages are found first."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import pandas as pd

from studies.kit.journal import Row
from studies.kit.tables import read_table
from studies.versions.environments import NoEnvironmentError, environment, variables
from studies.versions.releases import INSTALLED, Release

ANSWERS = "answers.csv"
"""Table of a release's folder."""

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
    name, made, packages = release.folder, {}, None
    if not release.here:
        packages = environments / name
        try:
            made = environment(packages, release)
        except NoEnvironmentError as error:
            return Asked(release, None, problem=str(error))
    words = ["versions", "--releases", INSTALLED, "--engines", release.engine, *options]
    command = [sys.executable, "-P", "-m", "studies", *words, "--out", str(out / name)]
    code, said = run_to_end(command, variables(packages))
    if code not in USABLE:
        return Asked(release, None, made, said or f"ended with exit code {code}")
    answers = read_table(out / name / ANSWERS, "release")
    if (found := set(answers["release"])) != {release.version}:
        return Asked(release, None, made, f"{', '.join(sorted(found))} was loaded in its stead")
    return Asked(release, answers, made)


def run_to_end(command: list[str], env: Mapping[str, str]) -> tuple[int, str]:
    """Run a process; return its exit code and the last line that it wrote to stderr.

    Whatever ends this process ends that one in an orderly way.
    """
    nowhere, kept = subprocess.DEVNULL, subprocess.PIPE
    with subprocess.Popen(command, env=env, text=True, stdout=nowhere, stderr=kept) as process:
        try:
            _, said = process.communicate()
        except BaseException:
            process.terminate()
            raise
    lines = said.strip().splitlines()
    return process.returncode, lines[-1] if lines else ""
