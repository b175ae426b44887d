"""What engines say of their own errors: the same random cases at half the step."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import pandas as pd

from studies.kit.jobs import Job
from studies.measures.halving import estimates_of, halved, published_trust
from studies.measures.words import out_of

HALVES = "halves"
"""Table of the rows at half the step."""


def half_jobs(jobs: Iterable[Job]) -> list[Job]:
    """Return the jobs at half their steps, of those sources that have a step to halve."""
    finer = (halved(job) for job in jobs)
    return [
        replace(job, labels={**job.labels, "table": HALVES}) for job in finer if job is not None
    ]


def with_bounds(compared: pd.DataFrame, finer: pd.DataFrame) -> pd.DataFrame:
    """Add estimate, and bound: the estimate times the published factor, nan where none was.

    Parameters
    ----------
    compared : DataFrame
        With the columns of `studies.measures.differences.with_reference`.
    finer : DataFrame
        The same cases at half the step.
    """
    found = compared.assign(estimate=estimates_of(compared, finer))
    trusts = {source: published_trust(str(source)) for source in compared["source"].unique()}
    factors = {source: trust.factor for source, trust in trusts.items() if trust is not None}
    return found.assign(bound=found["estimate"] * found["source"].map(factors).astype(float))


def bounds_text(compared: pd.DataFrame) -> str:
    """Say of every source how many of its errors the published factor bounds."""
    lines = []
    for source, rows in compared.groupby("source", sort=False):
        known = rows.dropna(subset=["error", "estimate"])
        if known.empty:
            continue
        trust = published_trust(str(source))
        if trust is None:
            lines.append(f"{source}: its estimates were never held against errors")
            continue
        bounded = int((known["error"].abs() <= known["bound"]).sum())
        words = trust.warning() or f"times {trust.factor:.3g} bounds {out_of(bounded, len(known))}"
        lines.append(f"{source}: {words}")
    return "\n".join(lines)
