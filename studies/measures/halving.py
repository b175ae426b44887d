"""How far off an answer may be, from the engine itself: the same run at half the step."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import pandas as pd

from analytic.response import Outcome
from engines.declaration import Stepping
from studies.old.jobs import Job
from studies.old.journal import Row
from studies.old.provenance import check
from studies.measures.published import PUBLISHED
from studies.sources.registry import resolve

FACTORS = PUBLISHED / "estimate" / "factors.csv"
"""By how much estimates are to be multiplied, as published."""

BOUNDED = 0.95
"""Part of the random cases whose error a factor bounds."""

ELSEWHERE = "the factor was found at the preset's own step"
"""Of landing steps twice and four times as long it is the same to 3 %, of a fixed MuJoCo step eight
times as long it is twice as large."""

OF_BLOCKS = "the factor was found on blocks"
OF_A_PEAK = "the factor is of a peak"
"""Why there is none of another scene."""

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
        return float(preset.step_s * job.block.p)
    return preset.ordinary_step(str(job.options.get("accuracy", "standard")))


def estimate(row: Mapping[Any, Any], finer: Mapping[Any, Any]) -> float:
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


def estimate_beyond(row: Mapping[Any, Any], finer: Mapping[Any, Any]) -> float:
    """Return the estimate, of what slid by the slips of its response: over the largest.

    It is inf where half the step has another number of slips.
    """
    if not row["outcome"] == finer["outcome"] == Outcome.SLID.value:
        return estimate(row, finer)
    slips, others = row["response"].slips, finer["response"].slips
    if len(slips) != len(others):
        return math.inf
    apart = (abs(one - other) for one, other in zip(slips, others, strict=True))
    return float(max(apart) / max(map(abs, others)))


def estimates_of(rows: pd.DataFrame, finer: pd.DataFrame) -> list[float]:
    """Return the estimate of each row, nan for one without a run at half its step.

    Parameters
    ----------
    rows, finer : DataFrame
        Columns case, source, outcome and peak_ratio; those at half the step in the second.
    """
    halves = {(row["case"], row["source"]): row for row in finer.to_dict("records")}
    pairs = ((row, halves.get((row["case"], row["source"]))) for row in rows.to_dict("records"))
    return [math.nan if half is None else estimate(row, half) for row, half in pairs]


def with_estimates(
    rows: Sequence[Row], finer: Sequence[Row], *, own_steps: bool = True, unheld: str = ""
) -> list[Row]:
    """Return rows of different sources with their estimates, and with what these bound.

    Parameters
    ----------
    rows, finer : sequence of dict
        A row for each source, with source, outcome, peak_ratio, message and response; in the second
        at half the step, without the sources that have none to halve (`halved`).
    own_steps : bool, optional
        Whether the presets' own steps were taken; if not, the message says that the factor was
        found at another one.
    unheld : str, optional
        Why estimates were not held against errors here; no bound is given then.

    Returns
    -------
    list of dict
        The rows with estimate, relative as of `estimate_beyond`, and bound, the estimate times the
        published factor; nan where there is none, and the message says why.

    Raises
    ------
    studies.old.journal.FolderError
        If the published factors were edited.
    """
    halves = {row["source"]: row for row in finer}
    return [
        {**row, **_estimated(row, halves.get(row["source"]), own_steps, unheld)} for row in rows
    ]


def _estimated(row: Row, finer: Row | None, own_steps: bool, unheld: str) -> Row:
    if finer is None:
        return {"estimate": math.nan, "bound": math.nan}
    found, trust = estimate_beyond(row, finer), published_trust(row["source"])
    warning = "the estimate was never held against errors" if trust is None else trust.warning()
    warning = unheld or warning
    if found == math.inf:
        warning = f"at half the step: {finer['outcome']}"
    elsewhere = "" if warning or own_steps else ELSEWHERE
    return {
        "estimate": found,
        "bound": math.nan if warning or trust is None else trust.factor * found,
        "message": "; ".join(words for words in (row["message"], warning, elsewhere) if words),
    }


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
    studies.old.journal.FolderError
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
