"""What a study is: data by which it is listed, run and shown, and the module that does the work.

The data need no more than the standard library, so that a list of the commands loads no study.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from importlib import import_module
from typing import TYPE_CHECKING, Protocol, cast

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from matplotlib.figure import Figure


@dataclass(frozen=True, slots=True, kw_only=True)
class Chapter:
    """A place of a study in a report.

    Attributes
    ----------
    folder : str
        Where a report keeps its results.
    question : str
    tables : tuple of str
        Tables short enough to be read.
    quick, full : tuple of str
        Further arguments of its command.
    minutes : tuple of float
        About how long quick and full take on two cores.
    weaker : str
        In what the quick form falls short of the full one.
    """

    folder: str
    question: str
    tables: tuple[str, ...] = ()
    quick: tuple[str, ...] = ("--quick",)
    full: tuple[str, ...] = ()
    minutes: tuple[float, float] = (1.0, 1.0)
    weaker: str = ""


class Command(Protocol):
    """A module with a command of the command line."""

    @property
    def command(self) -> Callable[..., int]:
        """The function whose parameters are the command's, and which returns the exit code."""


class StudyModule(Command, Protocol):
    """The module of a study that leaves tables behind."""

    def headline(self, folder: Path) -> str:
        """Return what a folder's tables show first, as a claim of one sentence."""

    def pictures(self, folder: Path) -> dict[str, Figure]:
        """Draw a folder's figures from its CSVs alone, by name."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Study:
    """A study.

    Attributes
    ----------
    name : str
        Its command.
    help : str
        What its command's help says first.
    table : str
        Pattern of the table by which its results folder is known; empty if it leaves none.
    tables : tuple of str
        Tables that it writes into its folder.
    chapters : tuple of Chapter
        Its places in a report.
    captions : mapping
        Name of a picture -> what is seen in it, for those who read and those who are read to.
    others : tuple of str
        Files that it writes besides.
    module : str
        Where its `command` is, and of a study with tables all of `StudyModule`.
    """

    name: str
    help: str
    table: str = ""
    tables: tuple[str, ...] = ()
    chapters: tuple[Chapter, ...] = ()
    captions: Mapping[str, str] = field(default_factory=dict)
    others: tuple[str, ...] = ("findings.txt",)
    module: str = ""

    def __post_init__(self) -> None:
        if not self.module:
            object.__setattr__(self, "module", f"studies.{self.name}.study")

    @property
    def products(self) -> tuple[str, ...]:
        """All files that it writes into its folder; none without a table."""
        pictures = (f"{name}.png" for name in self.captions)
        return (*self.tables, *pictures, *self.others) if self.tables else ()

    def load(self) -> StudyModule:
        """Import the module of a study that leaves tables."""
        return cast(StudyModule, import_module(self.module))

    def command_line(self, chapter: Chapter, folder: Path, full: bool) -> list[str]:
        """Return the words after `rocking` that fill a folder for a chapter."""
        return [self.name, "--out", str(folder), *(chapter.full if full else chapter.quick)]
