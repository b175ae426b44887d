"""What a study is: data by which it is listed, run and shown, and the module that does the work.

The data need no more than the standard library, so that a list of the commands loads no study.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import InitVar, dataclass, field, replace
from importlib import import_module
from inspect import Parameter, signature
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path

    import pandas as pd
    from matplotlib.figure import Figure


@dataclass(frozen=True, slots=True, kw_only=True)
class Chapter:
    """A place of a study in a report.

    Attributes
    ----------
    question : str
    folder : str
        Where a report keeps its results; by default called as the study.
    tables : tuple of str
        Tables short enough to be read.
    quick, full : tuple of str
        Further arguments of its command.
    minutes : tuple of float
        About how long quick and full take on two cores.
    weaker : str
        In what the quick form falls short of the full one.
    """

    question: str
    folder: str = ""
    tables: tuple[str, ...] = ()
    quick: tuple[str, ...] = ("--quick",)
    full: tuple[str, ...] = ()
    minutes: tuple[float, float] = (1.0, 1.0)
    weaker: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Study:
    """A study: what its folder says of it, in words and pictures, is made of its tables alone.

    Attributes
    ----------
    name : str
        Its command.
    help : str
        What its command's help says first.
    tables : tuple of str
        Tables that it writes into its folder.
    table : str
        Pattern of the table by which its folder is known; by default the first, where there is
        something to draw or to claim.
    texts : tuple of str
        Columns of its tables that are words though they may look like numbers.
    claims : tuple of str
        Tables of which its module's `finding` makes one sentence, what they show first; without
        any it takes the folder.
    drawings : mapping
        Name of a picture -> the function of its module `figure` that draws it, and the tables that
        this takes. Where captions name others, one of the two modules has `pictures` of the folder,
        by name.
    captions : mapping
        Name of a picture -> what is seen in it, for those who read and those who are read to.
    chapter, chapters : Chapter, tuple of Chapter
        Its place or places in a report.
    others : tuple of str
        Files that it writes besides.
    module : str
        Where its `command` is, the function whose parameters are the command's, and which returns
        the exit code.
    """

    name: str
    help: str
    tables: tuple[str, ...] = ()
    table: str = ""
    texts: tuple[str, ...] = ()
    claims: tuple[str, ...] = ()
    drawings: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    captions: Mapping[str, str] = field(default_factory=dict)
    chapter: InitVar[Chapter | None] = None
    chapters: tuple[Chapter, ...] = ()
    others: tuple[str, ...] = ("findings.txt",)
    module: str = ""

    def __post_init__(self, chapter: Chapter | None) -> None:
        places = (chapter,) if chapter else self.chapters
        known = {
            "chapters": tuple(replace(each, folder=each.folder or self.name) for each in places),
            "table": self.table or (self.tables[0] if self.captions or self.claims else ""),
            "module": self.module or f"studies.{self.name}.study",
        }
        for name, value in known.items():
            object.__setattr__(self, name, value)

    @property
    def products(self) -> tuple[str, ...]:
        """All files that it writes into its folder; none without a table."""
        pictures = (f"{name}.png" for name in self.captions)
        return (*self.tables, *pictures, *self.others) if self.tables else ()

    @property
    def about(self) -> str:
        """What its command's help says: what it is for, what it writes, and how long that takes."""
        writes = [*self.tables, *["pictures"] * bool(self.captions), *self.others]
        said = [self.help, f"Writes {', '.join(writes)}."] if self.tables else [self.help]
        for place in self.chapters[:1]:
            quick = f", {place.minutes[0]:g} with {' '.join(place.quick)}" if place.quick else ""
            said[-1] += f" About {place.minutes[1]:g} minutes on two cores{quick}."
        return "\n\n".join(said)

    def load(self) -> Any:
        """Import its module."""
        return import_module(self.module)

    @property
    def parameters(self) -> Mapping[str, Parameter]:
        """The parameters of its command, by name."""
        return signature(self.load().command).parameters

    def read(self, folder: Path, name: str) -> pd.DataFrame:
        """Read a table of a folder, packed or not; return none as empty."""
        from studies.old.tables import table_in

        return table_in(folder, name, *self.texts)

    def finding(self, folder: Path) -> str:
        """Return what a folder's tables show first, as a claim of one sentence."""
        if not self.claims:
            return str(self.load().finding(folder))
        return str(self.load().finding(*(self.read(folder, name) for name in self.claims)))

    def pictures(self, folder: Path) -> dict[str, Figure]:
        """Draw a folder's figures from its tables alone, by name; none without its first table."""
        figures = f"{self.module.rpartition('.')[0]}.figure"
        if self.captions and not self.drawings:
            known = getattr(self.load(), "pictures", None)
            return dict((known or import_module(figures).pictures)(folder))
        read = {
            picture: (draw, [self.read(folder, name) for name in tables])
            for picture, (draw, *tables) in self.drawings.items()
        }
        return {
            picture: getattr(import_module(figures), draw)(*tables)
            for picture, (draw, tables) in read.items()
            if len(tables[0].columns)
        }

    def command_line(self, chapter: Chapter, folder: Path, full: bool) -> list[str]:
        """Return the words after `rocking` that fill a folder for a chapter.

        Parameters
        ----------
        chapter : Chapter
        folder : Path
        full : bool
            Whether in its full form, or the quick one.
        """
        return [self.name, "--out", str(folder), *(chapter.full if full else chapter.quick)]
