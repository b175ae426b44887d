"""What came of the releases: how far each is off, and what changed, beside its release notes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import pandas as pd

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
    tables = []
    before: dict[str, pd.DataFrame] = {}
    for one in asked:
        engine, answers = one.release.engine, one.answers
        if answers is None:
            lines = pd.DataFrame([{"source": "", "set": "", "message": one.problem}])
        else:
            lines = _lines(answers, before.get(engine))
            if (answers["outcome"] != "failed").any():
                before[engine] = answers
        tables.append(lines.assign(engine=engine, release=one.release.version))
    return pd.concat(tables, ignore_index=True).reindex(columns=list(RELEASES))


def _lines(answers: pd.DataFrame, before: pd.DataFrame | None) -> pd.DataFrame:
    """Return a line for each preset and set: how far off it is, and from the release before."""
    rows = with_reference(answers)
    moves = rows[CASE].assign(moved=math.nan, turned=math.nan)
    rows = rows.merge(moves if before is None else moved(before, answers), on=CASE, how="left")
    failed, turned = rows["outcome"] == "failed", rows["turned"].astype(float)
    rows = rows.assign(
        size=rows["error"].abs(),
        failed=failed,
        reason=rows["message"].where(failed),
        turned=turned,
        changed=(rows["moved"] > CHANGED).where(turned.notna()).astype(float),
    )
    grouped = rows.groupby(["source", "set"], sort=False, as_index=False)
    return grouped.agg(
        cases=("case", "size"),
        failed=("failed", "sum"),
        right=("agrees", "sum"),
        median_error=("size", "median"),
        p90_error=("size", lambda sizes: sizes.quantile(0.9)),
        max_error=("size", "max"),
        moved=("moved", "max"),
        moved_cases=("changed", _counted),
        turned=("turned", _counted),
        message=("reason", _commonest),
    )


def _counted(marks: pd.Series[float]) -> float:
    """Return how many cases are marked, nan where none could be."""
    return float(marks.sum(min_count=1))


def _commonest(reasons: pd.Series[str]) -> str:
    """Return why most cases failed, empty where none did."""
    return str(next(iter(reasons.value_counts().index), ""))


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
