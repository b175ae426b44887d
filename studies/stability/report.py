"""What the study of extreme cases found: tables and figure, from its CSVs alone."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from studies.drawing.kept import Pictures, tell
from studies.kit.tables import read_table, write_table
from studies.measures.verdicts import Verdict
from studies.stability.findings import failures, findings, first_claim
from studies.stability.sensitivity import with_growth

ORDER = tuple(verdict.value for verdict in Verdict)
LARGEST = (
    *("case", "source", "contact_s", "largest_stable", "largest_accurate"),
    *("stable_over_contact", "accurate_over_contact"),
)


def report(folder: Path) -> str:
    """Reduce and draw a folder's tables; return the text, which findings.txt holds too."""
    matrix, steps, moved = (_table(folder, name) for name in ("stability", "steps", "sensitivity"))
    moved = with_growth(moved)
    write_table(folder / "sensitivity.csv", moved)
    wrong = failures(matrix)[["case", "source", "reason", "remedy"]]
    tables = {
        "Verdicts on the extreme cases": verdicts(matrix),
        "Failures, and the first setting that avoids each": wrong,
        "Largest stable and accurate step, p dt, and over the contact's own time": (
            steps.reindex(columns=LARGEST).dropna(how="all")
        ),
        "Change of the peak by a perturbation over that of the exact solution, in the median": (
            growth(moved)
        ),
    }
    return tell(folder, pictures(folder), findings(matrix), tables)


def headline(folder: Path) -> str:
    """Return how many of the extreme cases the engines get right."""
    return first_claim(_table(folder, "stability"))


def pictures(folder: Path) -> Pictures:
    """Draw the matrix of a folder from its stability.csv alone."""
    from studies.stability.figure import draw_matrix

    return {"stability": draw_matrix(_table(folder, "stability"))}


def _table(folder: Path, name: str) -> pd.DataFrame:
    """Return a table with empty words as such; empty if none of the sources has a row in it."""
    path = folder / f"{name}.csv"
    return read_table(path) if path.is_file() else pd.DataFrame()


def verdicts(matrix: pd.DataFrame) -> pd.DataFrame:
    """Return how often each source met each verdict."""
    counts = pd.crosstab(matrix["source"], matrix["verdict"])
    columns = [word for word in ORDER if word in counts]
    return counts.loc[list(matrix["source"].unique()), columns].reset_index()


def growth(moved: pd.DataFrame) -> pd.DataFrame:
    """Return the median growth over κ for each source, perturbed quantity and its size."""
    up = moved[moved["delta"] > 0.0]
    medians = up.groupby(["quantity", "source", "delta"], sort=False)["change_over_exact"].median()
    table = medians.unstack("delta")
    table.columns = [f"{delta:.0e}" for delta in table.columns]
    return table.reset_index()
