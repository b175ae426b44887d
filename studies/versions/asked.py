"""A release is asked: by this command once more, in the Python of its environment."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from studies.kit.fingerprint import ROOT
from studies.versions.environments import Environment, NoEnvironmentError, environment, python_of
from studies.versions.releases import INSTALLED, Release

ANSWERS = "answers.csv"
"""Table of a release's folder."""

USABLE = (0, 1)
"""Exit codes of a run that left its table; 1 where rows failed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Asking:
    """How releases are asked.

    Attributes
    ----------
    out, environments : Path
        Folders, with one inside for each release.
    options : tuple of str
        Further words of the command.
    """

    out: Path
    environments: Path
    options: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Asked:
    """What came of a release.

    Attributes
    ----------
    release : Release
    answers : DataFrame or None
        A row for each case and preset, the columns of answers.csv; None where it could not be had.
    made : Environment or None
        None where it is the installed one, or was not made.
    problem : str
        Why there are no answers.
    """

    release: Release
    answers: pd.DataFrame | None
    made: Environment | None = None
    problem: str = ""


def ask(release: Release, how: Asking) -> Asked:
    """Run the short study of a release into its folder, or what is missing there."""
    name = release.folder
    # the one that is installed is asked by this Python, which finds there what is found here
    made, python = None, Path(sys.executable)
    search = {"PYTHONPATH": os.pathsep.join([str(ROOT), *sys.path])}
    if not release.here:
        try:
            made = environment(how.environments / name, release)
        except NoEnvironmentError as error:
            return Asked(release, None, problem=str(error))
        python, search = python_of(how.environments / name), {}
    words = ["versions", "--releases", INSTALLED, "--engines", release.engine, *how.options]
    command = [str(python), "-P", "-m", "studies", *words, "--out", str(how.out / name)]
    kept = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    code, said = run_to_end(command, {**kept, **search})
    if code not in USABLE:
        return Asked(release, None, made, said or f"ended with exit code {code}")
    answers = read(how.out / name)
    if (found := set(answers["release"])) != {release.version}:
        return Asked(release, None, made, f"{', '.join(sorted(found))} was loaded in its stead")
    return Asked(release, answers, made)


def run_to_end(command: list[str], variables: dict[str, str]) -> tuple[int, str]:
    """Run a process; return its exit code and the last line that it wrote to stderr.

    Whatever ends this process ends that one in an orderly way.
    """
    nowhere, kept = subprocess.DEVNULL, subprocess.PIPE
    with subprocess.Popen(
        command, env=variables, text=True, stdout=nowhere, stderr=kept
    ) as process:
        try:
            _, said = process.communicate()
        except BaseException:
            process.terminate()
            raise
    lines = said.strip().splitlines()
    return process.returncode, lines[-1] if lines else ""


def read(folder: Path) -> pd.DataFrame:
    """Read a release's answers back."""
    words = {"release": str, "message": str}
    path = folder / ANSWERS
    return pd.read_csv(path, keep_default_na=False, na_values=["nan"], dtype=words)
