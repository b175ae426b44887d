"""What came of the releases: how far each is off, and what changed, beside its release notes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import pandas as pd

from studies.kit.journal import Row
from studies.measures.differences import with_reference
from studies.versions.releases import Asked, Release

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


CHANGES = (
    *("engine", "before", "release", "presets", "moved", "moved_cases", "turned", "cases"),
    *("note", "link"),
)

MUJOCO = "https://mujoco.readthedocs.io/en/3.11.0/changelog.html"
MUJOCO_4 = "https://github.com/google-deepmind/mujoco/releases/tag/4.0.1"
PYMUNK = "https://github.com/viblo/pymunk/blob/master/CHANGELOG.rst"
DART = "https://github.com/dartsim/dart/releases/tag/v"


class Note(NamedTuple):
    """A note of a release: what it says in short, and where it stands."""

    release: Release
    text: str
    link: str


NOTES = tuple(
    Note(Release(engine, version), text, link)
    for engine, version, text, link in (
        ("mujoco", "3.11.0", "free bodies are no longer integrated by the midpoint rule", MUJOCO),
        ("mujoco", "4.0.1", "mends the sparse Cholesky factor of 4.0.0, with which the Newton "
         "solver had a wrong Hessian", MUJOCO_4),
        ("pymunk", "6.5.0", "takes in the latest Chipmunk", PYMUNK),
        ("pymunk", "6.8.0", "a newer fork of Chipmunk, with a number of issues fixed", PYMUNK),
        ("pymunk", "7.0.0", "Chipmunk is replaced by its fork Munk2D", PYMUNK),
        ("dart", "6.17.0", "contact normals of FCL are stabilized, finite solutions of the Dantzig "
         "solver kept", f"{DART}6.17.0"),
        ("dart", "6.19.0", "bodies at rest are put to sleep", f"{DART}6.19.0"),
        ("dart", "6.20.0", "FCL, the default detector, collides exact primitive shapes; more "
         "bodies at rest sleep", f"{DART}6.20.0"),
        ("dart", "6.20.0", "DARTCollisionDetector, that of our other presets, has a new engine",
         "https://github.com/dartsim/dart/pull/3381"),
    )
)  # fmt: skip
"""What release notes say of what may move a rocking block, in the order of the releases."""


def notes_between(before: Release, after: Release) -> list[Note]:
    """Return the notes on the releases after one, up to another."""
    mine = [note for note in NOTES if note.release.engine == after.engine]
    return [note for note in mine if before.order < note.release.order <= after.order]


def answered(lines: pd.DataFrame) -> pd.DataFrame:
    """Return the lines of releases.csv in which some case has a result."""
    return lines[lines["failed"] < lines["cases"]]


def is_changed(lines: pd.DataFrame) -> pd.Series[bool]:
    """Say of each line whether an answer is another one than in the release before."""
    return (lines["moved"] > CHANGED) | (lines["turned"] > 0)


def changes_table(lines: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each pair of neighbouring releases between which an answer changed.

    Parameters
    ----------
    lines : DataFrame
        The columns of releases.csv.
    """
    rows = []
    for engine, mine in answered(lines).groupby("engine", sort=False):
        for before, after in pairwise(mine["release"].unique()):
            now = mine[mine["release"] == after]
            changed = now[is_changed(now)]
            if changed.empty:
                continue
            notes = notes_between(Release(str(engine), before), Release(str(engine), after))
            rows.append(
                (
                    *(engine, before, after),
                    " ".join(changed["source"].str.partition(":")[2].unique()),
                    changed["moved"].max(),
                    *(int(changed[name].sum()) for name in ("moved_cases", "turned")),
                    int(now["cases"].sum()),
                    "; ".join(f"{note.release.version}: {note.text}" for note in notes),
                    " ".join(dict.fromkeys(note.link for note in notes)),
                )
            )
    return pd.DataFrame(rows, columns=list(CHANGES))
