"""Statements that a table decides, reported whichever way they fall."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from typing import TypeAlias

import pandas as pd


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


def table_of(items: Sequence[Finding]) -> pd.DataFrame:
    """Return findings as a table, with a column source where some are about one."""
    table = pd.DataFrame([asdict(item) for item in items])
    return table if any(table["source"]) else table.drop(columns="source")
