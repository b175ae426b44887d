"""What the printed numbers say: which come out to their digits, and by how much the others miss."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from studies.drawing.kept import Pictures, keep
from studies.kit.tables import in_columns, read_table, write_table
from studies.literature.problems import Problem, Restitution
from studies.literature.readings import NAMED
from studies.measures.words import out_of


def report(folder: Path) -> str:
    """Reduce and draw a folder's literature.csv; write and return the text."""
    table = agreement(_read(folder / "literature.csv"))
    write_table(folder / "agreement.csv", table)
    return keep(
        folder, pictures(folder), "\n\n".join([table_text(table), *works(table), headline(folder)])
    )


def headline(folder: Path) -> str:
    """Say how many printed numbers come out to their digits."""
    mine = _of_theory(_read(folder / "agreement.csv"))
    right = int((mine["agrees"] == "True").sum())
    return f"Of the printed numbers of the literature {out_of(right, len(mine))} come out."


def _of_theory(table: pd.DataFrame) -> pd.DataFrame:
    """Return the answers of the models of the prints, where these are no measurements."""
    return table[(table["source"] == table["model"]) & (table["of"] == "theory")]


def pictures(folder: Path) -> Pictures:
    """Draw how far each answer is from the print, from a folder's agreement.csv alone."""
    from studies.literature.figure import draw_literature

    return {"literature": draw_literature(_read(folder / "agreement.csv"))}


def _read(path: Path) -> pd.DataFrame:
    """Read a table back with empty words as such."""
    return read_table(path, "measured", "agrees", "printed", "why")


def agreement(rows: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each printed number and source: the print, the answer, its miss."""
    lines: list[dict[str, Any]] = []
    for row in rows.to_dict("records"):
        lines += _lines(NAMED[str(row["problem"])], {str(k): v for k, v in row.items()})
    table = pd.DataFrame(lines)
    exact = table[table["source"] == "exact"].set_index(["problem", "side"])["value"]
    places = pd.MultiIndex.from_frame(table[["problem", "side"]])
    return table.assign(from_exact=table["value"] / exact.reindex(places).to_numpy() - 1.0)


def _lines(problem: Problem, row: dict[str, Any]) -> list[dict[str, Any]]:
    lines = []
    for side, printed in enumerate(problem.printed):
        value = float(row[("value", "other_side")[side]])
        low, high = printed.bounds
        lines.append(
            {
                "problem": problem.name,
                "side": side,
                "work": problem.work,
                "where": problem.where,
                "quantity": problem.quantity,
                "printed": str(printed),
                "measured": problem.measured[side] if problem.measured else "",
                "model": problem.model,
                "of": "test" if isinstance(problem, Restitution) else "theory",
                "source": row["source"],
                "outcome": row["outcome"],
                "value": value,
                "low": low,
                "high": high,
                "miss": printed.miss(value),
                "agrees": str(bool(low <= value <= high)),
                "why": problem.why,
                "message": row["message"],
            }
        )
    return lines


def table_text(table: pd.DataFrame) -> str:
    """Return a line for each printed number, with the answers of all sources beside it."""
    sources = list(dict.fromkeys(table["source"]))
    lines = []
    for (_, _), group in table.groupby(["problem", "side"], sort=False):
        first = group.iloc[0]
        answers = group.set_index("source")["value"].reindex(sources)
        mine = group[group["source"] == first["model"]].iloc[0]
        lines.append(
            {
                "problem": first["problem"],
                "quantity": first["quantity"],
                "printed": first["printed"],
                "measured": first["measured"],
                **{name: _digits(value) for name, value in answers.items()},
                "to the digit": "yes" if mine["agrees"] == "True" else f"off {mine['miss']:.1e}",
                "why not": "" if mine["agrees"] == "True" else first["why"],
            }
        )
    return in_columns(pd.DataFrame(lines).astype(str))


def _digits(value: float) -> str:
    return "" if np.isnan(value) else f"{value:.6g}"


def works(table: pd.DataFrame) -> list[str]:
    """Return the works that the numbers come from, a line each."""
    return ["\n".join(dict.fromkeys(table["work"]))]
