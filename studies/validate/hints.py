"""What landing steps lean on: the same random cases with hints that are false."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, replace
from typing import TYPE_CHECKING

import pandas as pd

from engines.hints import TRUE, Hints
from studies.kit.jobs import Job
from studies.measures.differences import sensitivity_of
from studies.sources.registry import Effort, resolve

if TYPE_CHECKING:
    from studies.cases.drawn import RandomCase

HINTED = 30
"""Cases, the first ones, that are asked with false hints and with a calm motion."""

CALM = 0.9
"""Amplitude of the calm motion, over the acceleration that lifts the block."""

KNOWN = "true"
"""The hint of the rows that the others are held against."""

FALSE: Mapping[str, Hints] = {
    "onset 2 % low": Hints(onset=0.98),
    "onset 2 % high": Hints(onset=1.02),
    "onset 20 % low": Hints(onset=0.8),
    "onset 20 % high": Hints(onset=1.2),
    "sides swapped": Hints(swapped=True),
    "fall half as fast": Hints(fall=0.5),
    "fall twice as fast": Hints(fall=2.0),
}
"""Name -> what the steps are told."""


def hint_jobs(cases: Iterable[RandomCase], sources: Sequence[str], effort: Effort) -> list[Job]:
    """Return a job for each case, false hint, and engine whose steps land on impacts."""
    landing = [source for source in sources if resolve(source).lands]
    asked = [
        (posed, name, hints)
        for case in cases
        for posed, told in ((case, FALSE), (calm(case), {KNOWN: TRUE, **FALSE}))
        for name, hints in told.items()
    ]
    return [
        Job(
            labels={"table": "hints", "hint": name, **asdict(case)},
            block=case.block,
            motion=case.motion,
            source=source,
            options={**effort.options(source), "hints": hints},
        )
        for case, name, hints in asked
        for source in landing
    ]


def calm(case: RandomCase) -> RandomCase:
    """Return a case with a pulse too weak to lift its block."""
    return replace(case, amplitude_g=CALM / case.aspect)


def leanings(known: pd.DataFrame, hinted: pd.DataFrame) -> pd.DataFrame:
    """Hold rows with false hints beside those of the same cases and sources with true ones.

    Parameters
    ----------
    known, hinted : DataFrame
        Rows with the columns of `studies.measures.differences.with_reference`, and hint in the
        second.

    Returns
    -------
    DataFrame
        source and hint; right and still, the outcomes that agree of so many cases that lift the
        block and of as many that do not; the median and the largest error of the peaks that survive
        both, and over_kappa, the largest error over what errors are judged against.
    """
    same = known["case"].isin(hinted["case"]) & known["source"].isin(hinted["source"])
    rows = pd.concat([known[same].assign(hint=KNOWN), hinted], ignore_index=True)
    rows = rows.iloc[pd.factorize(rows["source"])[0].argsort(kind="stable")]
    lifts, size = rows["exact_outcome"] != "at rest", rows["error"].abs()
    rows = rows.assign(
        lifts=lifts,
        right=lifts & rows["agrees"],
        still=~lifts & rows["agrees"],
        size=size,
        scaled=size / sensitivity_of(rows),
    )
    groups = rows.groupby(["source", "hint"], sort=False)
    return groups.agg(
        cases=("lifts", "sum"),
        right=("right", "sum"),
        still=("still", "sum"),
        median_error=("size", "median"),
        max_error=("size", "max"),
        over_kappa=("scaled", "max"),
    ).reset_index()
