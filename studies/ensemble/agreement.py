"""Sources beside the exact solution of an ensemble, case by case and in distribution."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd

from studies.ensemble.fragility import BLOCK, Fragilities, Fragility, bounds, fragilities
from studies.measures.wrongness import ANSWERS, NO_ANSWER, REST, wrong_in

CASE = [*BLOCK, "motion", "intensity"]

CLOSE = 0.1
"""A peak is predicted when it is right within this part."""

LEVEL = 0.05
"""Level of the tests."""

BOUNDS = ["capacity_low", "capacity_high", "ratio_low", "ratio_high"]
DIGITS = 2
"""Digits after the point of a capacity, or a ratio of two, as they are printed."""
LEAST_RESAMPLES, MOST_RESAMPLES = 1000, 256_000
"""How often motions are drawn again, before it is seen whether the bounds hold."""


def beside_exact(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of all other sources beside the exact outcome and peak of their case.

    A case without an exact outcome has no answer.
    """
    exact = rows.loc[rows["source"] == "exact", [*CASE, "outcome", "peak_ratio"]]
    exact = exact.rename(columns={"outcome": "exact_outcome", "peak_ratio": "exact_peak"})
    joined = rows[rows["source"] != "exact"].merge(exact, on=CASE, validate="many_to_one")
    both = (joined["outcome"] == "rocked") & (joined["exact_outcome"] == "rocked")
    known = joined["exact_outcome"].isin(ANSWERS)
    wrong = wrong_in(joined[known]).reindex(joined.index, fill_value=NO_ANSWER)
    lost = wrong != ""
    return joined.assign(
        wrong=wrong,
        agrees=~lost,
        false=lost & (joined["outcome"] == "overturned"),
        missed=lost & (joined["exact_outcome"] == "overturned"),
        error=(joined["peak_ratio"] / joined["exact_peak"] - 1.0).where(both),
    )


def settled(rows: pd.DataFrame) -> tuple[Fragilities, pd.DataFrame]:
    """Resample until twice as many samples move no bound by half of its last printed digit.

    Returns
    -------
    Fragilities, DataFrame
        With so many samples, which a column of the agreement counts.
    """
    before, resamples = None, LEAST_RESAMPLES
    while True:
        fitted = fragilities(rows, resamples)
        agreed = agreement(rows, fitted).assign(resamples=resamples)
        bounded = agreed[BOUNDS].to_numpy(float)
        near = before is not None and np.allclose(
            before, bounded, rtol=0.0, atol=0.5 * 10.0**-DIGITS, equal_nan=True
        )
        if near or resamples >= MOST_RESAMPLES:
            return fitted, agreed
        before, resamples = bounded, 2 * resamples


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
        one of the same cases, with their bounds, and whether one of the capacity's, or of the two
        that the ratio is of, lies at the least or the largest intensity or beyond.
    """
    compared = dict(list(beside_exact(rows).groupby([*BLOCK, "source"], sort=False)))
    lines = []
    for key, here in fitted.items():
        line: dict[str, object] = dict(zip([*BLOCK, "source"], key, strict=True))
        if key in compared:
            group = compared[key]
            usable = group[group["wrong"] != NO_ANSWER]
            line |= {**_one_by_one(group, usable), **_in_distribution(usable)}
        lines.append({**line, **_capacity(here, fitted[(*key[:2], "exact")])})
    return pd.DataFrame(lines)


def _one_by_one(group: pd.DataFrame, usable: pd.DataFrame) -> dict[str, object]:
    errors = usable["error"].abs()
    return {
        "cases": len(group),
        "failed": len(group) - len(usable),
        "right": int(usable["agrees"].sum()),
        "false": int(usable["false"].sum()),
        "missed": int(usable["missed"].sum()),
        REST: int((usable["wrong"] == REST).sum()),
        "median_error": errors.median(),
        "p90_error": errors.quantile(0.9),
        "predicted": (usable["agrees"] & ~(errors > CLOSE)).sum() / len(group),
    }


def _in_distribution(usable: pd.DataFrame) -> dict[str, object]:
    from scipy.stats import binomtest, ks_2samp

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
    false, missed = int(usable["false"].sum()), int(usable["missed"].sum())
    return {
        "ks": float(worst.statistic),
        "ks_p": float(worst.pvalue),
        "ks_tests": len(tests),
        "ks_rejected": sum(float(test.pvalue) < LEVEL for test in tests),
        "mcnemar_p": binomtest(false, false + missed).pvalue if false + missed else 1.0,
    }


def _capacity(here: Fragility, exact: Fragility) -> dict[str, object]:
    beside = exact.where(here.usable)
    with np.errstate(invalid="ignore", divide="ignore"):
        ratio = float(np.divide(here.fit.median, beside.fit.median))
        low, high = bounds(here.resampled.median / beside.resampled.median)
    own_low, own_high = bounds(here.resampled.median)
    at_edge = _at_edge(here)
    return {
        "capacity": float(here.fit.median),
        "capacity_low": float(own_low),
        "capacity_high": float(own_high),
        "capacity_at_edge": at_edge,
        "beta": float(here.fit.beta),
        "capacity_ratio": ratio,
        "ratio_low": float(low),
        "ratio_high": float(high),
        "ratio_at_edge": at_edge or _at_edge(beside),
    }


def _at_edge(known: Fragility) -> bool:
    """Say whether a bound of a capacity is none of the intensities' making."""
    low, high = bounds(known.resampled.median)
    return bool(low <= known.intensity.min() or high >= known.intensity.max())


def confusion(rows: pd.DataFrame) -> pd.DataFrame:
    """Return how often each outcome stands beside each exact one, for each block and source."""
    counted = beside_exact(rows).groupby([*BLOCK, "source", "exact_outcome", "outcome"], sort=False)
    return counted.size().rename("cases").reset_index()
