"""How far off an answer may be, from the engine itself: the same run at half the step."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import pandas as pd

from analytic.response import Outcome
from engines.declaration import Stepping
from studies.kit.jobs import Job
from studies.kit.store import check
from studies.measures.published import PUBLISHED
from studies.sources.registry import resolve

FACTORS = PUBLISHED / "estimate" / "factors.csv"
"""By how much estimates are to be multiplied, as published."""

BOUNDED = 0.95
"""Part of the random cases whose error a factor bounds."""

ELSEWHERE = "the factor was found at the preset's own step"
"""Of landing steps twice and four times as long it is the same to 3 %, of a fixed MuJoCo step eight
times as long it is twice as large."""

MOST_TRUSTED = 30.0
"""A factor above is no bound: the estimate does not see the error."""

NO_BOUND = "no bound"
"""What is said of such an estimate."""


def halved(job: Job) -> Job | None:
    """Return a job at half of its step; None where a source has no step that could be halved."""
    source = job.asked
    if source.kind != "engine" or source.used.stepping is Stepping.OWN:
        return None
    options = {name: value for name, value in job.options.items() if name != "accuracy"}
    return replace(job, options={**options, "step": 0.5 * step_of(job)})


def step_of(job: Job) -> float:
    """Return p dt of an engine's job."""
    if "step" in job.options:
        return float(job.options["step"])
    preset = job.asked.used
    if not math.isnan(preset.step_s):
        return float(preset.step_s * job.case.system.p)
    return preset.ordinary_step(str(job.options.get("accuracy", "standard")))


def estimate_of(row: Mapping[Any, Any], finer: Mapping[Any, Any]) -> float:
    """Return the relative difference of a peak from that at half the step.

    It is inf where half the step has another outcome, nan where one of the two failed, 0 where the
    block stays at rest or overturns in both.
    """
    outcomes = row["outcome"], finer["outcome"]
    if Outcome.FAILED.value in outcomes:
        return math.nan
    if outcomes[0] != outcomes[1]:
        return math.inf
    if outcomes[0] != Outcome.ROCKED.value:
        return 0.0
    return abs(float(row["peak_ratio"]) / float(finer["peak_ratio"]) - 1.0)


def estimates_of(rows: pd.DataFrame, finer: pd.DataFrame) -> list[float]:
    """Return the estimate of each row, nan for one without a run at half its step.

    Parameters
    ----------
    rows, finer : DataFrame
        Columns case, source, outcome and peak_ratio; those at half the step in the second.
    """
    halves = {(row["case"], row["source"]): row for row in finer.to_dict("records")}
    pairs = ((row, halves.get((row["case"], row["source"]))) for row in rows.to_dict("records"))
    return [math.nan if half is None else estimate_of(row, half) for row, half in pairs]


class Trust(NamedTuple):
    """What published random cases say of a source's estimates."""

    factor: float
    """By how much they are to be multiplied to bound the errors of `BOUNDED` of the cases: the
    upper end of its 95 % interval, inf where the cases are too few for one."""
    cases: int

    @property
    def holds(self) -> bool:
        """Whether the estimates see the error."""
        return self.factor <= MOST_TRUSTED

    def warning(self) -> str:
        """Say that they give no bound, or nothing."""
        if self.holds:
            return ""
        part = f"{BOUNDED:.0%} of the errors".replace("%", " %")
        if math.isinf(self.factor):
            return f"{NO_BOUND}: {self.cases} random cases tell no factor that bounds {part}"
        needed = f"from {self.cases} random cases it may take {self.factor:.3g} estimates"
        return f"{NO_BOUND}: {needed} to bound {part}"


def published_trust(source: str) -> Trust | None:
    """Return what was published of a source's estimates.

    Parameters
    ----------
    source : str
        Its name; an engine's best preset may be named or not.

    Returns
    -------
    Trust or None
        None where FACTORS has no line of it, or is not there.

    Raises
    ------
    studies.kit.store.FolderError
        If the table is not what its folder's provenance tells of.
    studies.sources.registry.UnknownSourceError
        If there is no such source.
    """
    if not FACTORS.is_file():
        return None
    check(FACTORS.parent, [FACTORS.name], "the folder of the factors")
    asked = resolve(source)
    for line in pd.read_csv(FACTORS).to_dict("records"):
        known = resolve(str(line["source"]))
        if (known.engine, known.preset) == (asked.engine, asked.preset):
            return Trust(float(line["factor_95_high"]), int(line["survivors"]))
    return None
