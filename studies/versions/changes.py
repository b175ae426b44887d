"""What changed from one release to the next, beside what the release notes say."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import pandas as pd

from studies.versions.releases import Release
from studies.versions.tables import CHANGED

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
