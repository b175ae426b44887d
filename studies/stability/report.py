"""What the study of extreme cases found: tables and figure, from its CSVs alone."""

from __future__ import annotations

import math
from pathlib import Path
from textwrap import fill
from typing import Any

import pandas as pd

from studies.drawing.kept import Pictures, keep
from studies.kit.tables import left_aligned, read_table, write_table
from studies.measures.verdicts import Verdict
from studies.stability.findings import failures, findings, first_claim
from studies.stability.largest_step import LARGEST_STEP
from studies.stability.sensitivity import with_growth

ORDER = tuple(verdict.value for verdict in Verdict)


def report(folder: Path) -> str:
    """Reduce and draw a folder's tables; return the text, which findings.txt holds too."""
    matrix, steps, moved = (_table(folder, name) for name in ("stability", "steps", "sensitivity"))
    moved = with_growth(moved)
    write_table(folder / "sensitivity.csv", moved)
    text = "\n\n".join(
        [
            "Verdicts on the extreme cases:\n" + verdicts_text(matrix),
            "Failures, and the first setting that avoids each:\n" + failures_text(matrix),
            "Largest stable and accurate step, p dt (: over the contact's own time):\n"
            + steps_text(steps),
            "Change of the peak by a perturbation of the amplitude, over that of the exact\n"
            "solution; the median over the cases:\n" + sensitivity_text(moved, "amplitude"),
            "The same for the width:\n" + sensitivity_text(moved, "width"),
            fill(findings(matrix), 99),
        ]
    )
    return keep(folder, pictures(folder), text)


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


def verdicts_text(matrix: pd.DataFrame) -> str:
    """Return how often each source met each verdict."""
    counts = pd.crosstab(matrix["source"], matrix["verdict"])
    columns = [word for word in ORDER if word in counts]
    table = counts.loc[list(matrix["source"].unique()), columns]
    return table.rename_axis(index=None, columns=None).to_string()


def failures_text(matrix: pd.DataFrame) -> str:
    """Return what went wrong, with its reason and the setting that avoids it."""
    wrong = failures(matrix)
    if wrong.empty:
        return "none"
    shown = wrong[["case", "source", "reason", "remedy"]].rename(columns={"remedy": "avoided by"})
    return left_aligned(shown.assign(reason=shown["reason"].str.slice(0, 80)))


def steps_text(steps: pd.DataFrame) -> str:
    """Return the largest steps: a line for each source, a pair for each problem."""
    if steps.empty:
        return "none of the sources steps"
    cells = steps.assign(
        method=[
            method_name(*pair) for pair in zip(steps["source"], steps["contact_s"], strict=True)
        ],
        cell=[step_cell(row) for _, row in steps.iterrows()],
    )
    table = cells.pivot(index="method", columns="case", values="cell")
    table = table.loc[list(cells["method"].unique()), list(cells["case"].unique())]
    return table.rename_axis(index=None, columns=None).fillna("").to_string()


def method_name(source: str, contact_s: float) -> str:
    """Return a source, with its contact where that has a time of its own."""
    return source if math.isnan(contact_s) else f"{source}, own contact time"


def step_cell(row: pd.Series[Any]) -> str:
    """Return both largest steps of a row, and over the contact's time where there is one."""
    if row["invalid"]:
        return "not valid"
    pairs = zip(
        (row["largest_stable"], row["largest_accurate"]),
        (row["stable_over_contact"], row["accurate_over_contact"]),
        strict=True,
    )
    return " ".join(_step(value, over) for value, over in pairs)


def _step(value: float, over: float) -> str:
    if math.isnan(value):
        return "-"
    sign = ">" if value >= LARGEST_STEP else ""
    return f"{sign}{value:.2g}" + ("" if math.isnan(over) else f":{over:.2g}")


def sensitivity_text(moved: pd.DataFrame, quantity: str) -> str:
    """Return the median growth over κ for each source and perturbation."""
    part = moved[(moved["quantity"] == quantity) & (moved["delta"] > 0.0)]
    medians = part.groupby(["source", "delta"], sort=False)["change_over_exact"].median()
    table = medians.unstack("delta").map(lambda value: f"{value:.3g}")
    table.columns = [f"{delta:.0e}" for delta in table.columns]
    return table.rename_axis(index=None).to_string()
