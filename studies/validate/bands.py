"""Errors as they are, in bands of the exact peak and of κ: divided by nothing."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import inf

import pandas as pd

from studies.measures.differences import conditioning_of
from studies.measures.words import part

PEAKS, KAPPAS = (0.01, 0.1, 0.5), (10.0, 100.0)
"""Where bands end: of the exact peak over θcr, and of the larger of κ and κη."""


def bands(compared: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each source and band of the cases that survive in the exact solution.

    Parameters
    ----------
    compared : DataFrame
        With the columns of `studies.measures.differences.with_reference`.

    Returns
    -------
    DataFrame
        source, by (peak or κ), band, cases, right (outcomes), median_error and max_error.
    """
    rocked = compared[compared["exact_outcome"] == "rocked"]
    ways = {"peak": (rocked["exact_peak"], PEAKS), "κ": (conditioning_of(rocked), KAPPAS)}
    return pd.DataFrame(
        [
            {
                "source": source,
                "by": by,
                "band": band,
                "cases": len(rows),
                "right": int(rows["agrees"].sum()),
                "median_error": rows["error"].abs().median(),
                "max_error": rows["error"].abs().max(),
            }
            for by, (values, ends) in ways.items()
            for band, (low, high) in _named(ends).items()
            for source, rows in rocked[(low <= values) & (values < high)].groupby(
                "source", sort=False
            )
        ],
        columns=["source", "by", "band", "cases", "right", "median_error", "max_error"],
    )


def _named(ends: Sequence[float]) -> dict[str, tuple[float, float]]:
    """Return bands in their order, by what they are called."""
    between = {f"from {low:g} to {high:g}": (low, high) for low, high in pairwise(ends)}
    first, last = {f"below {ends[0]:g}": (0.0, ends[0])}, {f"above {ends[-1]:g}": (ends[-1], inf)}
    return {**first, **between, **last}


def bands_text(table: pd.DataFrame) -> str:
    """Return for each way to divide the cases median and largest error, a line for each source."""
    return "\n\n".join(_one_way(str(by), rows) for by, rows in table.groupby("by", sort=False))


def _one_way(by: str, table: pd.DataFrame) -> str:
    cells = table["median_error"].map(part) + ", " + table["max_error"].map(part)
    shown = table.assign(cell=cells.where(table["median_error"].notna(), "-"))
    places = shown.pivot(index="source", columns="band", values="cell").fillna("-")
    ordered = places.reindex(index=shown["source"].unique(), columns=shown["band"].unique())
    return str(ordered.reset_index(names=by).rename_axis(columns=None).to_string(index=False))
