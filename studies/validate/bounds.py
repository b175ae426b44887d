"""What engines say of their own errors: the same random cases at half the step."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

import pandas as pd

from studies.kit.jobs import Job
from studies.measures.halving import estimates_of, halved, published_trust

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
    return found.assign(bound=found["estimate"] * found["source"].map(_factors(found)))


def bounded(compared: pd.DataFrame) -> pd.DataFrame:
    """Return of every source with estimates its factor, and how many errors that bounds.

    The factor is nan of a source whose estimates were never held against errors.
    """
    known = compared.dropna(subset=["error", "estimate"])
    known = known.assign(
        factor=known["source"].map(_factors(known)), within=known["error"].abs() <= known["bound"]
    )
    groups = known.groupby("source", sort=False)
    return groups.agg(
        factor=("factor", "first"), survivors=("within", "size"), bounded=("within", "sum")
    ).reset_index()


def _factors(rows: pd.DataFrame) -> dict[str, float]:
    trusts = {source: published_trust(str(source)) for source in rows["source"].unique()}
    return {source: math.nan if trust is None else trust.factor for source, trust in trusts.items()}
