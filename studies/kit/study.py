"""What a study is, and the one way it runs: jobs in; rows, tables, a finding and figures out."""

from __future__ import annotations

import inspect
from base64 import b64encode
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import pandas as pd
from cyclopts import Parameter

from studies.kit.arguments import Out, Running, sources_option
from studies.kit.jobs import Job, Row, answer
from studies.kit.run import exit_code, makers_of, place_of, run
from studies.kit.say import as_text
from studies.kit.store import Store, provenance_of
from studies.kit.tables import read_table, split, tables_of, write_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Tables: TypeAlias = "Mapping[str, pd.DataFrame]"
"""Tables by the names of their files, without .csv."""
Figures: TypeAlias = "Mapping[str, Figure]"
"""Figures by the names of their files."""
SHARED = Parameter(show=False)
"""What marks the options that `rocking help run` explains, once for all studies."""


def stages(*functions: Callable[..., Any]) -> dict[str, Any]:
    """Return the stages of a study by their names, as `Study` takes them."""
    return {function.__name__: function for function in functions}


@dataclass(frozen=True, slots=True, kw_only=True)
class Study:
    """A study: its finding and its figures are made of its tables alone."""

    name: str  # of its command, and of the folder of a report that holds its results
    question: str
    help: str  # of its command: what it does, and how long that takes
    sources: tuple[str, ...] = ()  # asked by default; without any, there is no --sources
    options: type | None = None  # a dataclass of further options
    quick: str = ""  # what --quick leaves out; without it, there is no such option
    jobs: Callable[..., Sequence[Job]]  # (sources, quick[, options]), in the order of the rows
    measure: Callable[[Job], Row] = answer  # columns after labels and source, outcome among them
    split: str = ""  # a label whose values are tables: `tabulate` then takes the rows of each
    tabulate: Callable[[Any], Tables]  # of its rows
    finding: Callable[[Tables], str]  # what its tables show, in a sentence
    shown: Callable[[Tables], Tables] = lambda _: {}  # short tables, by their titles
    figures: Callable[[Tables], Figures] = lambda _: {}
    captions: Mapping[str, str] = field(default_factory=dict)  # by the beginning of a figure's name
    needed: Callable[[Sequence[Row]], Sequence[Row]] = tuple  # rows whose failure is the study's
    texts: tuple[str, ...] = ()  # columns of words that may look like numbers
    rows: str = ""  # a table of the rows as they are: a folder without a store goes on from it
    alone: bool = False  # whether its jobs run one at a time, unless --jobs says otherwise

    def command(self) -> Callable[..., int]:
        """Return its command: the function whose parameters are the command's options."""
        taken: dict[str, tuple[Any, Any]] = {"out": (Out, inspect.Parameter.empty)}
        if self.options is not None:
            taken["options"] = (Annotated[self.options, Parameter(name="*")], self.options())
        if self.sources:
            taken["sources"] = (Annotated[tuple[str, ...], SHARED, sources_option()], self.sources)
        if self.quick:
            taken["quick"] = (Annotated[bool, Parameter(help=self.quick)], False)
        taken["running"] = (Annotated[Running, SHARED], Running())

        def command(**given: Any) -> int:
            given = {name: value for name, (_, value) in taken.items()} | given
            out, running = given.pop("out"), given.pop("running")
            if self.alone and running.jobs is None and running.cluster is None:
                running = replace(running, jobs=1)
            options = [given.pop("options")] if self.options is not None else []
            jobs = self.jobs(given.get("sources", ()), given.get("quick", False), *options)
            asked = asdict(*options) if options else {}
            return self.carry_out(out, jobs, running, **given, **asked)

        shared = ["--sources"] * bool(self.sources) + ["--jobs --time-limit --cluster --also"]
        folded = f"Options of every study (`rocking help run`): {' '.join(shared)}."
        command.__doc__ = f"{self.question}\n\n{self.help}\n\n{folded}"
        command.__annotations__ = {name: hint for name, (hint, _) in taken.items()}
        of = partial(inspect.Parameter, kind=inspect.Parameter.KEYWORD_ONLY)
        command.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
            [of(name, default=it, annotation=hint) for name, (hint, it) in taken.items()]
        )
        return command

    def carry_out(self, out: Path, jobs: Sequence[Job], running: Running, **asked: Any) -> int:
        """Run into a folder what it does not hold yet; write and print what that shows."""
        with Store(out, self.name, self.rows) as store:
            rows = run(jobs, self.measure, place_of(running), store, running.also or ())
            tables = self.tabulate(split(rows, self.split) if self.split else pd.DataFrame(rows))
            store.finish(tables, makers_of(jobs, self.measure), len(rows), **asked)
        print(self.tell(out))
        return exit_code(self.needed(rows))

    def read(self, folder: Path) -> dict[str, pd.DataFrame]:
        """Read the tables of a folder, packed or not, by their names."""
        paths = {path.name.partition(".")[0]: path for path in tables_of(folder)}
        return {name: read_table(path, *self.texts) for name, path in paths.items()}

    def tell(self, folder: Path) -> str:
        """Draw the figures of a folder and write its finding, from its tables; return the text."""
        tables = self.read(folder)
        for name, drawing in self.figures(tables).items():
            from studies.kit.pictures import save

            save(drawing, folder / f"{name}.png")
        text = as_text(self.finding(tables), self.shown(tables))
        write_text(folder / "findings.txt", text + "\n")
        return text

    def hand_on(self, folder: Path, template: str, **more: Any) -> None:
        """Write a page to hand on of the tables and pictures of a folder, from a template."""
        from jinja2 import Environment, PackageLoader

        pages = Environment(loader=PackageLoader("studies", "."), autoescape=True)
        tables = self.read(folder)
        text = pages.get_template(template).render(
            finding=self.finding(tables).split("\n\n"),
            tables=self.shown(tables),
            pictures=[
                (self.caption_of(path.stem), b64encode(path.read_bytes()).decode())
                for path in sorted(folder.glob("*.png"))
            ],
            found=tables,
            made=provenance_of(folder),
            **more,
        )
        write_text(folder / f"{self.name}.html", text)

    def caption_of(self, figure: str) -> str:
        """Return what is seen in a figure, by the longest beginning of its name that has words."""
        known = [start for start in self.captions if figure.startswith(start)]
        return self.captions[max(known, key=len)] if known else figure


@dataclass(frozen=True, slots=True)
class Finding:
    """A statement, whether it holds, and the numbers that decide it."""

    statement: str
    holds: bool | None
    numbers: str


Check: TypeAlias = "Callable[[pd.DataFrame], tuple[bool, str]]"
"""Says of a table whether a statement holds, and the numbers."""


def claim(statement: str, *needs: str) -> Callable[[Check], Callable[[pd.DataFrame], Finding]]:
    """Return what makes of a check the test of a statement, which needs some sources."""

    def tested(check: Check, table: pd.DataFrame) -> Finding:
        if not set(table["source"]).issuperset(needs):
            return Finding(statement, None, f"needs the sources {', '.join(needs)}")
        return Finding(statement, *check(table))

    return lambda check: partial(tested, check)
