"""What changed from one release to the next, beside what the release notes say."""

from __future__ import annotations

from itertools import pairwise

import pandas as pd

from studies.kit.journal import Row
from studies.versions.notes import notes_between
from studies.versions.releases import Release
from studies.versions.tables import CHANGED

CHANGES = (
    *("engine", "before", "release", "presets", "moved", "moved_cases", "turned", "cases"),
    *("note", "link"),
)


def changes_table(lines: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each pair of neighbouring releases between which an answer changed.

    Parameters
    ----------
    lines : DataFrame
        The columns of releases.csv.
    """
    rows: list[Row] = []
    answered = lines[lines["failed"] < lines["cases"]]
    for engine, mine in answered.groupby("engine", sort=False):
        for before, after in pairwise(mine["release"].unique()):
            now = mine[mine["release"] == after]
            changed = now[(now["moved"] > CHANGED) | (now["turned"] > 0)]
            if len(changed):
                notes = notes_between(Release(str(engine), before), Release(str(engine), after))
                rows.append(
                    {
                        "engine": engine,
                        "before": before,
                        "release": after,
                        "presets": " ".join(_presets(changed)),
                        "moved": changed["moved"].max(),
                        "moved_cases": int(changed["moved_cases"].sum()),
                        "turned": int(changed["turned"].sum()),
                        "cases": int(now["cases"].sum()),
                        "note": "; ".join(f"{note.release}: {note.text}" for note in notes),
                        "link": " ".join(dict.fromkeys(note.link for note in notes)),
                    }
                )
    return pd.DataFrame(rows, columns=list(CHANGES))


def _presets(lines: pd.DataFrame) -> list[str]:
    return list(dict.fromkeys(str(source).partition(":")[2] for source in lines["source"]))
