"""Which releases of an engine there are, which of them are asked, and what room they take."""

import importlib.util
import re
import subprocess
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from engines import ENGINES
from studies.kit.arguments import BadInputError
from studies.kit.provenance import version_of

INSTALLED, MINOR, ALL = "installed", "minor", "all"
"""Words for the release that is here, for the last of each minor number, and for all of them."""

MIB = 2.0**20

LISTED = re.compile(r"^Available versions: (.+)$", re.MULTILINE)
FINAL = re.compile(r"\d+(\.\d+)*(\.post\d+)?")
"""Releases that are no trial."""


class UnlistedError(Exception):
    """The releases of an engine could not be asked for; one line says why."""


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

    def __str__(self) -> str:
        return f"{self.engine}=={self.version}"


def installed(engine: str) -> Release:
    """Return the release that is installed."""
    return Release(engine, version_of(ENGINES[engine].packages[0]))


def listed(engine: str) -> list[Release]:
    """Return the releases with a wheel for this Python, oldest first, as pip knows them.

    Raises
    ------
    UnlistedError
        If pip is not there, or knows none.
    """
    package = ENGINES[engine].packages[0]
    command = [sys.executable, "-m", "pip", "index", "versions", package]
    quick = ["--only-binary", ":all:", "--retries", "1", "--disable-pip-version-check"]
    done = subprocess.run([*command, *quick], capture_output=True, text=True, check=False)
    found = LISTED.search(done.stdout)
    if found is None:
        said = [line for line in done.stderr.splitlines() if line.startswith("ERROR")]
        reason = said[-1] if said else "pip named none"
        raise UnlistedError(f"the releases of {package} cannot be asked for: {reason}")
    versions = [word for word in found[1].split(", ") if FINAL.fullmatch(word)]
    return sorted((Release(engine, version) for version in versions), key=lambda it: it.order)


def last_of_minors(releases: Iterable[Release]) -> list[Release]:
    """Return the last release of each minor number, of releases in order."""
    return list({release.order[:2]: release for release in releases}.values())


def check_releases(asked: Sequence[str], engines: Sequence[str]) -> None:
    """Raise BadInputError unless each names releases of the engines."""
    for word in asked:
        name, equals, version = word.partition("==")
        if word in (INSTALLED, MINOR, ALL) or (
            equals and name in engines and FINAL.fullmatch(version)
        ):
            continue
        words = f"{INSTALLED}, {MINOR}, {ALL}, or ENGINE==RELEASE of {', '.join(engines)}"
        raise BadInputError(f"--releases is {word!r}; it must be {words}")


def chosen(engine: str, asked: Sequence[str], known: Mapping[str, list[Release]]) -> list[Release]:
    """Return the releases of an engine that are asked, in order, the installed one among them.

    Parameters
    ----------
    engine : str
    asked : sequence of str
        Words and names, as `check_releases` lets them pass.
    known : mapping
        Engine -> its releases in order; those of an engine that is not there are unknown.
    """
    every = known.get(engine, [])
    found = {installed(engine)}
    for word in asked:
        name, _, version = word.partition("==")
        if name == engine:
            found.add(Release(engine, version))
        elif word in (MINOR, ALL):
            found |= set(last_of_minors(every) if word == MINOR else every)
    return sorted(found, key=lambda release: release.order)


def room_mib(engine: str) -> float:
    """Return the room of an engine's library as it is installed here [MiB], others' apart."""
    spec = importlib.util.find_spec(ENGINES[engine].library)
    if spec is None:
        return 0.0
    if spec.submodule_search_locations:
        return sum(bytes_in(Path(folder)) for folder in spec.submodule_search_locations) / MIB
    return Path(spec.origin).stat().st_size / MIB if spec.has_location and spec.origin else 0.0


def bytes_in(folder: Path) -> int:
    """Return the room of the files in a folder [byte], links apart."""
    files = (path for path in folder.rglob("*") if path.is_file() and not path.is_symlink())
    return sum(path.stat().st_size for path in files)
