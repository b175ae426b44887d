"""What came of the releases: how far each is off, and how far from the one before."""

from __future__ import annotations

import math
from collections.abc import Sequence

import pandas as pd

from studies.kit.journal import Row
from studies.measures.differences import with_reference
from studies.versions.asked import Asked

CHANGED = 1e-6
"""A peak that moves by more, relatively, is a change."""

CASE = ["engine", "source", "set", "case"]
"""Columns that name a case and who answers it."""

RELEASES = (
    *("engine", "release", "source", "set", "cases", "failed", "right"),
    *("median_error", "p90_error", "max_error", "moved", "moved_cases", "turned"),
    "message",
)


def releases_table(asked: Sequence[Asked]) -> pd.DataFrame:
    """Return a line for each release, preset and set of cases; one for a release without answers.

    Parameters
    ----------
    asked : sequence of Asked
        The releases of each engine in order.
    """
    rows: list[Row] = []
    before: dict[str, Asked] = {}
    for one in asked:
        rows += _lines(one, before.get(one.release.engine))
        if answering(one):
            before[one.release.engine] = one
    return pd.DataFrame(rows, columns=list(RELEASES))


def answering(one: Asked) -> bool:
    """Whether some case of a release has a result."""
    return one.answers is not None and bool((one.answers["outcome"] != "failed").any())


def _lines(one: Asked, before: Asked | None) -> list[Row]:
    release = one.release
    head = {"engine": release.engine, "release": release.version}
    if one.answers is None:
        return [{**head, "source": "", "set": "", "message": one.problem}]
    compared = with_reference(one.answers)
    moves = None if before is None or before.answers is None else moved(before.answers, one.answers)
    return [
        {
            **head,
            "source": source,
            "set": name,
            **_errors(rows),
            **_moves(None if moves is None else _of(moves, str(source), str(name))),
            "message": _commonest(rows),
        }
        for (source, name), rows in compared.groupby(["source", "set"], sort=False)
    ]


def _of(moves: pd.DataFrame, source: str, name: str) -> pd.DataFrame:
    return moves[(moves["source"] == source) & (moves["set"] == name)]


def _errors(rows: pd.DataFrame) -> Row:
    errors = rows["error"].abs().dropna()
    return {
        "cases": len(rows),
        "failed": int((rows["outcome"] == "failed").sum()),
        "right": int(rows["agrees"].sum()),
        "median_error": errors.median(),
        "p90_error": errors.quantile(0.9) if len(errors) else math.nan,
        "max_error": errors.max(),
    }


def _commonest(rows: pd.DataFrame) -> str:
    """Return why most cases failed, empty where none did."""
    reasons = rows.loc[rows["outcome"] == "failed", "message"]
    return "" if reasons.empty else str(reasons.value_counts().index[0])


def moved(before: pd.DataFrame, after: pd.DataFrame) -> pd.DataFrame:
    """Return for each case by how much its peak moved relatively, and whether its outcome turned.

    Parameters
    ----------
    before, after : DataFrame
        Answers of two releases.

    Returns
    -------
    DataFrame
        Columns of `CASE`, moved: nan unless the block rocked in both, and turned, which a failure
        in one of them is, too.
    """
    both = before.merge(after, on=CASE, suffixes=("_before", ""))
    rocked = (both["outcome_before"] == "rocked") & (both["outcome"] == "rocked")
    ratio = (both["peak_ratio"] / both["peak_ratio_before"]).where(rocked)
    turned = both["outcome_before"] != both["outcome"]
    return both[CASE].assign(moved=(ratio - 1.0).abs(), turned=turned)


def _moves(moves: pd.DataFrame | None) -> Row:
    if moves is None:
        return {"moved": math.nan, "moved_cases": math.nan, "turned": math.nan}
    return {
        "moved": moves["moved"].max(),
        "moved_cases": int((moves["moved"] > CHANGED).sum()),
        "turned": int(moves["turned"].sum()),
    }
