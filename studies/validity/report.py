"""What the map of validity and the engines beyond it say."""

from __future__ import annotations

import math
from typing import Any

import pandas as pd

from studies.measures.words import listed

CASE = ["aspect", "onsets", "omega_over_p"]


def compared(rows: pd.DataFrame, exact: pd.DataFrame) -> pd.DataFrame:
    """Return the engines' rows beside the exact solution of their cases.

    With the further columns exact_outcome, exact_peak, min_normal, friction_needed, agrees and
    error (relative, of the peak where both rocked).
    """
    named = exact.rename(columns={"outcome": "exact_outcome", "peak_ratio": "exact_peak"})
    joined = rows.merge(named, on=CASE, validate="many_to_one")
    both = (joined["outcome"] == "rocked") & (joined["exact_outcome"] == "rocked")
    return joined.assign(
        agrees=joined["outcome"] == joined["exact_outcome"],
        error=(joined["peak_ratio"] / joined["exact_peak"] - 1.0).where(both),
    )


def first_claim(table: pd.DataFrame) -> str:
    """Say from which amplitude on the reference does not hold, by slenderness."""
    words = [
        f"{f'from {ends:.2g} onsets' if math.isfinite(ends) else 'never'} at H/B {aspect:g}"
        for aspect, ends in needs(table).set_index("aspect")["from_onsets"].items()
    ]
    return f"An engine is right to differ, because the pivot lifts off: {listed(words)}."


def needs(table: pd.DataFrame) -> pd.DataFrame:
    """Return what the reference needs, a line for each H/B.

    How many of the map's cases and of those that survive need a pull at the pivot, and from which
    amplitude on; the friction needed where it survives and stays down.
    """
    survives, lifts = table["outcome"] == "rocked", table["min_normal"] < 0.0
    lost = lifts & survives
    found = table.assign(
        survive=survives,
        lifted=lifts,
        survivors_lifted=lost,
        from_onsets=table["onsets"].where(lost),
        friction=table["friction_needed"].where(survives & ~lifts),
    )
    groups = found.groupby("aspect")
    return groups.agg(
        cases=("survive", "size"),
        lifted=("lifted", "sum"),
        survive=("survive", "sum"),
        survivors_lifted=("survivors_lifted", "sum"),
        from_onsets=("from_onsets", "min"),
        least_friction=("friction", "min"),
        median_friction=("friction", "median"),
    ).reset_index()


def verdicts(rows: pd.DataFrame, by: pd.Series[Any]) -> pd.DataFrame:
    """Return how many cases of each source end how, and their errors, for each value of `by`."""
    keys = [rows["source"], by]
    groups = rows.assign(error=rows["error"].abs()).groupby(keys, observed=True)
    found = groups.agg(
        agrees=("agrees", "sum"),
        median_error=("error", "median"),
        max_error=("error", "max"),
        slip_widths=("slip_widths", "max"),
        hop_widths=("hop_widths", "max"),
    )
    counts = groups["verdict"].value_counts().unstack(fill_value=0)
    return counts.join(found).reset_index()
