"""Statements that a table decides, reported whichever way they fall."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TypeAlias

import pandas as pd


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
