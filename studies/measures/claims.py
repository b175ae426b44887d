"""Statements that a table decides, reported whichever way they fall."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import TypeAlias

import pandas as pd

from studies.old.tables import read_table, write_table
from studies.measures.words import listed, out_of

TABLE = "findings.csv"
"""Where a study keeps its findings."""

NAMED = 6
"""Sources that are named in a sentence at most."""


@dataclass(frozen=True, slots=True)
class Finding:
    """A statement, and what became of it.

    Attributes
    ----------
    statement : str
    holds : bool or None
        None where a source that it needs was not asked.
    numbers : str
        The numbers that decide it, with their units; or what was missing.
    source : str
        Whom it is about, where it is said of several in turn.
    """

    statement: str
    holds: bool | None
    numbers: str
    source: str = ""

    @property
    def verdict(self) -> str:
        """What became of the statement, in words."""
        return {True: "holds", False: "does not hold", None: "not tested"}[self.holds]


Check: TypeAlias = "Callable[[pd.DataFrame], tuple[bool, str]]"
"""Says of a table whether a statement holds, and the numbers."""


def claim(statement: str, *needs: str) -> Callable[[Check], Callable[[pd.DataFrame], Finding]]:
    """Return what makes of a check the test of a statement.

    Parameters
    ----------
    statement : str
    *needs : str
        Sources without which it cannot be tested, of those in a table's column source.
    """

    def tested(check: Check, table: pd.DataFrame) -> Finding:
        if needs and not set(table["source"]).issuperset(needs):
            return Finding(statement, None, f"needs the sources {', '.join(needs)}")
        return Finding(statement, *check(table))

    return lambda check: partial(tested, check)


def tally(items: Sequence[Finding], whose: str) -> str:
    """Say how many of somebody's statements hold, and name those that do not.

    Parameters
    ----------
    items : sequence of Finding
        Those that were not tested count neither way.
    whose : str
        As it follows "Of": "the paper's conclusions".

    Returns
    -------
    str
        One sentence.
    """
    tested = [item for item in items if item.holds is not None]
    failing = [item.statement for item in tested if not item.holds]
    words = f"Of {whose} {out_of(len(tested) - len(failing), len(tested))} hold"
    return f"{words}; not: {'; '.join(failing)}." if failing else f"{words}."


def table_of(items: Sequence[Finding]) -> pd.DataFrame:
    """Return findings as a table, with a column source where some are about one."""
    table = pd.DataFrame([asdict(item) for item in items])
    return table if any(table["source"]) else table.drop(columns="source")


def write_findings(folder: Path, items: Sequence[Finding]) -> None:
    """Write a folder's findings to TABLE, for `read_findings`.

    Parameters
    ----------
    folder : Path
        One that is there; a table of that name is replaced.
    items : sequence of Finding
        One at least: each is a row with the columns statement, holds and numbers, and source
        where some are about one.
    """
    table = pd.DataFrame([asdict(item) for item in items])
    write_table(folder / TABLE, table if any(table["source"]) else table.drop(columns="source"))


def read_findings(folder: Path) -> list[Finding]:
    """Read a folder's findings back."""
    table = read_table(folder / TABLE, "holds")
    known = {"True": True, "False": False}
    return [
        Finding(str(statement), known.get(str(holds)), *map(str, more))
        for statement, holds, *more in table.to_numpy(object)
    ]


def said_once(items: Iterable[Finding]) -> list[Finding]:
    """Return findings in which what was found of several sources is one, and names them.

    Parameters
    ----------
    items : iterable of Finding
        Of more sources than NAMED it is said how many they are; the table has their numbers.
    """
    groups: dict[tuple[str, bool | None], list[Finding]] = {}
    for item in items:
        groups.setdefault((item.statement, item.holds), []).append(item)
    found = []
    for (statement, holds), group in groups.items():
        sources, shown = [item.source for item in group if item.source], group[:NAMED] == group
        whom = listed(sources) if shown else f"{len(sources)} sources"
        numbers = "; ".join(item.numbers for item in group) if shown else ""
        found.append(Finding(f"{statement}: {whom}" if sources else statement, holds, numbers))
    return found
