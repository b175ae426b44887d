"""Sources beside the exact solution of an ensemble, case by case and in distribution."""

import math

import numpy as np
import pandas as pd
from scipy.stats import binomtest, ks_2samp

from studies.ensemble.fragility import BLOCK, Fragilities, Fragility, bounds, by_block
from studies.measures.wrongness import NO_ANSWER, REST, wrong_in

CASE = [*BLOCK, "motion", "intensity"]

CLOSE = 0.1
"""A peak is predicted when it is right within this part."""


def beside_exact(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of all other sources beside the exact outcome and peak of their case."""
    exact = rows.loc[rows["source"] == "exact", [*CASE, "outcome", "peak_ratio"]]
    exact = exact.rename(columns={"outcome": "exact_outcome", "peak_ratio": "exact_peak"})
    joined = rows[rows["source"] != "exact"].merge(exact, on=CASE, validate="many_to_one")
    both = (joined["outcome"] == "rocked") & (joined["exact_outcome"] == "rocked")
    wrong = wrong_in(joined)
    return joined.assign(
        wrong=wrong,
        agrees=wrong == "",
        error=(joined["peak_ratio"] / joined["exact_peak"] - 1.0).where(both),
    )


def agreement(rows: pd.DataFrame, fitted: Fragilities) -> pd.DataFrame:
    """Return, for each block and source, the agreement case by case and in distribution.

    Returns
    -------
    DataFrame
        right, false and missed overturnings, at rest for rocked or the reverse; median_error and
        p90_error of single peaks, predicted (share of cases with the right outcome and, if rocked,
        a peak right within CLOSE);
        ks, the largest distance between the distributions of the peaks over the intensities, ks_p
        its p-value and ks_rejected the intensities with one below 0.05; mcnemar_p, of as many
        overturnings too many as too few; the fitted capacity and its ratio to the exact
        one of the same cases.
    """
    lines = []
    for size, block in by_block(beside_exact(rows)):
        known = (size["width_m"], size["height_m"])
        exact = fitted[(*known, "exact")]
        lines.append({**size, "source": "exact", **_capacity(exact, exact)})
        for source, group in block.groupby("source", sort=False):
            usable = group[group["wrong"] != NO_ANSWER]
            lines.append(
                {
                    **size,
                    "source": source,
                    **_one_by_one(group, usable),
                    **_in_distribution(usable),
                    **_capacity(fitted[(*known, str(source))], exact),
                }
            )
    return pd.DataFrame(lines)


def _one_by_one(group: pd.DataFrame, usable: pd.DataFrame) -> dict[str, object]:
    errors = usable["error"].abs().dropna()
    close = usable["agrees"] & ~(usable["error"].abs() > CLOSE)
    return {
        "cases": len(group),
        "failed": len(group) - len(usable),
        "right": int(usable["agrees"].sum()),
        "false": int(((usable["outcome"] == "overturned") & ~usable["agrees"]).sum()),
        "missed": int(((usable["exact_outcome"] == "overturned") & ~usable["agrees"]).sum()),
        REST: int((usable["wrong"] == REST).sum()),
        "median_error": errors.median(),
        "p90_error": errors.quantile(0.9) if len(errors) else math.nan,
        "predicted": close.sum() / len(group),
    }


def _in_distribution(usable: pd.DataFrame) -> dict[str, object]:
    if usable.empty:
        unknown = dict.fromkeys(("ks", "ks_p", "mcnemar_p"), math.nan)
        return {**unknown, "ks_tests": 0, "ks_rejected": 0}
    # an overturned block has the largest peak there is, and the test asks for no more
    peaks = usable[["peak_ratio", "exact_peak"]].replace(math.inf, 1e9)
    tests = [
        ks_2samp(stripe["peak_ratio"], stripe["exact_peak"], method="asymp")
        for _, stripe in peaks.groupby(usable["intensity"])
    ]
    worst = max(tests, key=lambda test: float(test.statistic))
    false = int(((usable["outcome"] == "overturned") & ~usable["agrees"]).sum())
    missed = int(((usable["exact_outcome"] == "overturned") & ~usable["agrees"]).sum())
    return {
        "ks": float(worst.statistic),
        "ks_p": float(worst.pvalue),
        "ks_tests": len(tests),
        "ks_rejected": sum(float(test.pvalue) < 0.05 for test in tests),
        "mcnemar_p": binomtest(false, false + missed).pvalue if false + missed else 1.0,
    }


def _capacity(here: Fragility, exact: Fragility) -> dict[str, float]:
    beside = exact.where(here.usable)
    with np.errstate(invalid="ignore", divide="ignore"):
        ratio = float(np.divide(here.fit.median, beside.fit.median))
        low, high = bounds(here.medians() / beside.medians())
        own_low, own_high = bounds(here.medians())
    return {
        "capacity": here.fit.median,
        "capacity_low": float(own_low),
        "capacity_high": float(own_high),
        "beta": here.fit.beta,
        "capacity_ratio": ratio,
        "ratio_low": float(low),
        "ratio_high": float(high),
    }


def confusion(rows: pd.DataFrame) -> pd.DataFrame:
    """Return how often each outcome stands beside each exact one, for each block and source."""
    counted = beside_exact(rows).groupby([*BLOCK, "source", "exact_outcome", "outcome"], sort=False)
    return counted.size().rename("cases").reset_index()
