"""How far off an answer may be, from the engine itself: the same run at half the step."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from analytic.motion import FloatArray
from analytic.response import Outcome
from engines.declaration import Stepping
from studies.kit.jobs import Job
from studies.kit.store import check
from studies.measures.published import PUBLISHED
from studies.measures.wrongness import FALL, REST, wrong_in
from studies.sources.registry import resolve

FACTORS = PUBLISHED / "estimate" / "factors.csv"
"""The factors between estimates and errors, as published."""
BOUNDED = 0.95
"""Part of the random cases whose error a factor bounds."""
MOST_TRUSTED = 30.0
"""A larger factor is no bound: the estimate does not see the error."""
TEST, CALIBRATE = USES = "test", "calibrate"
"""What a random case is for: to try the factors, or to find them."""
NO_BOUND = "no bound"
ELSEWHERE = "the factor was found at the preset's own step"
"""With landing steps it keeps within 3 % at four times the step; with others it may double."""


def halved(job: Job) -> Job | None:
    """Return a job at half of its step; None where a source has no step that could be halved."""
    source = job.asked
    if source.kind != "engine" or source.used.stepping is Stepping.OWN:
        return None
    options = {name: value for name, value in job.options.items() if name != "accuracy"}
    return replace(job, options={**options, "step": 0.5 * step_of(job)})


def step_of(job: Job) -> float:
    """Return p dt of an engine's job."""
    preset = job.asked.used
    if "step" in job.options:
        return float(job.options["step"])
    if not math.isnan(preset.step_s):
        return float(preset.step_s * job.case.system.p)
    return preset.ordinary_step(str(job.options.get("accuracy", "standard")))


def estimate_of(row: Mapping[Any, Any], finer: Mapping[Any, Any]) -> float:
    """Return the relative difference of a peak from that at half the step."""
    outcomes = row["outcome"], finer["outcome"]
    if Outcome.FAILED.value in outcomes:
        return math.nan
    if outcomes[0] != outcomes[1]:
        return math.inf
    if outcomes[0] != Outcome.ROCKED.value:
        return 0.0
    return abs(float(row["peak_ratio"]) / float(finer["peak_ratio"]) - 1.0)


def factors(lines: pd.DataFrame) -> pd.DataFrame:
    """Return for each source by how much its estimates are to be multiplied, tried on others."""
    table = []
    for source, rows in lines.groupby("source", sort=False):
        mine, other = (rows[rows["set"] == use] for use in (CALIBRATE, TEST))
        kept, tested = mine.dropna(subset="over"), other["over"].dropna()
        wrong = mine[wrong_in(mine).isin((FALL, REST))]
        over = kept["over"].to_numpy()
        most = np.quantile(over, BOUNDED, method="inverted_cdf") if len(over) else math.nan
        low, high = interval(over)
        table.append(
            {
                "source": source,
                "cases": len(mine),
                "survivors": len(kept),
                "median_estimate": kept["estimate"].median(),
                "median_error": kept["error"].abs().median(),
                "factor_95": most,
                "factor_95_low": low,
                "factor_95_high": high,
                "wrong": len(wrong),
                "told": int((wrong["estimate"] == math.inf).sum()),
                "tested": len(tested),
                "bounded": int((tested <= high).sum()),
            }
        )
    return pd.DataFrame(table)


def interval(over: FloatArray) -> tuple[float, float]:
    """Return the ends of a factor's 95 % interval, values themselves; inf of too few values."""
    from scipy.stats import quantile_test  # it takes a second to load

    if not len(over):
        return 0.0, math.inf
    ends: Any = quantile_test(over, p=BOUNDED).confidence_interval(0.95)
    low = over.min() if math.isnan(ends.low) else ends.low
    return float(low), math.inf if math.isnan(ends.high) else float(ends.high)


class Trust(NamedTuple):
    """What published random cases say of a source's estimates."""

    factor: float  # the upper end of its 95 % interval; inf where the cases are too few for one
    cases: int

    def warning(self) -> str:
        """Say that they give no bound, or nothing."""
        if self.factor <= MOST_TRUSTED:
            return ""
        part = f"{100.0 * BOUNDED:.0f} % of the errors"
        if math.isinf(self.factor):
            return f"{NO_BOUND}: {self.cases} random cases tell no factor that bounds {part}"
        needed = f"from {self.cases} random cases it may take {self.factor:.3g} estimates"
        return f"{NO_BOUND}: {needed} to bound {part}"


def published_trust(source: str) -> Trust | None:
    """Return what was published of a source's estimates, if anything; refuse an edited table."""
    if not FACTORS.is_file():
        return None
    check(FACTORS.parent, [FACTORS.name], "the folder of the factors")
    asked = resolve(source)
    for line in pd.read_csv(FACTORS).to_dict("records"):
        known = resolve(str(line["source"]))
        if (known.engine, known.preset) == (asked.engine, asked.preset):
            return Trust(float(line["factor_95_high"]), int(line["survivors"]))
    return None
