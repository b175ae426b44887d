"""What landing steps lean on: the same random cases with hints that are false."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING

import pandas as pd

from engines.hints import TRUE, Hints
from studies.kit.jobs import Job
from studies.measures.differences import scientific, sensitivity_of
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


@dataclass(frozen=True, slots=True, kw_only=True)
class Leaning:
    """How a source fares with a hint.

    `right` and `still` count outcomes that agree, of as many cases that lift the block and of as
    many that do not. Errors of the peak are relative, over cases that survive both; `over_kappa` is
    the largest error over what errors are judged against.
    """

    source: str
    hint: str
    cases: int
    right: int
    still: int
    median_error: float
    max_error: float
    over_kappa: float


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


def leanings(known: pd.DataFrame, hinted: pd.DataFrame) -> list[Leaning]:
    """Hold rows with false hints beside those of the same cases and sources with true ones.

    Parameters
    ----------
    known, hinted : DataFrame
        Rows with the columns of `studies.measures.differences.with_reference`, and hint in the
        second.
    """
    same = known["case"].isin(hinted["case"]) & known["source"].isin(hinted["source"])
    rows = pd.concat([known[same].assign(hint=KNOWN), hinted], ignore_index=True)
    size = rows["error"].abs()
    lifts = rows["exact_outcome"] != "at rest"
    rows = rows.assign(
        cases=lifts,
        right=lifts & rows["agrees"],
        still=~lifts & rows["agrees"],
        size=size,
        scaled=size / sensitivity_of(rows),
    )
    return [
        Leaning(
            source=str(source),
            hint=str(hint),
            **{name: int(group[name].sum()) for name in ("cases", "right", "still")},
            median_error=float(group["size"].median()),
            max_error=float(group["size"].max()),
            over_kappa=float(group["scaled"].max()),
        )
        for source, part in rows.groupby("source", sort=False)
        for hint, group in part.groupby("hint", sort=False)
    ]


def leanings_text(table: pd.DataFrame) -> str:
    """Return leanings as an aligned table."""
    shown = pd.DataFrame(
        {
            "source": table["source"].mask(table["source"].duplicated(), ""),
            "hint": table["hint"],
            "outcomes": table["right"].astype(str) + "/" + table["cases"].astype(str),
            "stay": table["still"].astype(str) + "/" + table["cases"].astype(str),
            "median": table["median_error"].map(scientific),
            "max": table["max_error"].map(scientific),
            "max over S": table["over_kappa"].map(scientific),
        }
    )
    return shown.to_string(index=False)
