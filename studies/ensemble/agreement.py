"""Sources beside the exact solution of an ensemble, case by case and in distribution.

In distribution: the probability of overturning against intensity, with what is not known of it. A
block overturns at the intensity x with the probability Phi(ln(x/median)/beta): capacities are
lognormal. Fitted by maximum likelihood to the counts at each intensity (Baker 2015, "Efficient
analytical fragility function fitting using dynamic structural analysis"), all samples at once; the
bounds are quantiles over resampled motions, whole, since what one motion does at two intensities is
not independent.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping
from typing import NamedTuple

import numpy as np
import pandas as pd

from analytic.motion import FloatArray
from studies.measures.wrongness import ANSWERS, NO_ANSWER, REST, wrong_in

BLOCK = ["width_m", "height_m"]
"""Columns that tell blocks apart."""

CONFIDENCE = 0.95
NEWTON_STEPS, HALVINGS, CONVERGED, ROUNDING = 100, 30, 1e-9, 1e-13
"""Of a fit: steps and halvings of a step at most, the last step, and what a sum's rounding is."""

FAR = 10.0
"""A median further than this many times beyond the intensities is not determined by them."""


class Fit(NamedTuple):
    """Lognormal capacities: their medians, and the standard deviations of their logarithms.

    Each attribute is an array of the shape of what was fitted. beta is 0 where every intensity with
    an overturning lies above every one with a survival; the median is then between the two, or 0 or
    inf if there is only one of them. The median is nan where the counts do not determine one:
    overturning does not rise with the intensity (beta is then inf), rises so little that even odds
    lie FAR beyond the intensities, or there are no counts. `level` is then the normal quantile of
    the probability at intensity 1.
    """

    median: FloatArray
    beta: FloatArray
    level: FloatArray

    def probability(self, intensity: FloatArray) -> FloatArray:
        """Return the probabilities of overturning: for each fit, at each intensity."""
        from scipy.special import ndtr

        median, beta, level = (np.asarray(value)[..., np.newaxis] for value in self)
        with np.errstate(divide="ignore", invalid="ignore"):
            rising = ndtr(np.log(intensity / median) / beta)
            unknown = ndtr(level + np.log(intensity) / beta)
        step = (beta == 0.0) | (median == 0.0) | (median == math.inf)
        known = np.where(step, (intensity > median).astype(float), rising)
        return np.where(np.isnan(median), unknown, known)


def fit_lognormal(intensity: FloatArray, overturned: FloatArray, cases: FloatArray) -> Fit:
    """Fit capacities to the numbers overturned of so many cases.

    Parameters
    ----------
    intensity : ndarray, shape (k,)
    overturned, cases : ndarray, shape (..., k)
        Counts at each intensity.
    """
    from scipy.special import ndtri

    overturned, cases = np.broadcast_arrays(overturned, cases)
    *shape, number = cases.shape
    overturned, cases = overturned.reshape(-1, number), cases.reshape(-1, number)
    survived, logs = cases - overturned, np.log(intensity)
    all_cases, all_overturned = cases.sum(axis=-1), overturned.sum(axis=-1)
    strongest = np.where(survived > 0, intensity, 0.0).max(axis=-1)
    weakest = np.where(overturned > 0, intensity, math.inf).min(axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        middle = cases @ logs / all_cases
        # equal shares do not rise, whichever way their means are rounded
        falls = overturned @ logs / all_overturned <= middle + ROUNDING * np.abs(logs).max()
        share = ndtri(all_overturned / all_cases)
    apart, fitted = strongest <= weakest, all_cases > 0
    a, b = np.full((2, *fitted.shape), math.nan)
    rises = fitted & ~apart & ~falls
    a[rises], b[rises] = _likeliest(
        logs - middle[rises][:, np.newaxis], overturned[rises], survived[rises]
    )
    with np.errstate(over="ignore", invalid="ignore"):
        beyond = middle - a / b
        near = np.abs(beyond - beyond.clip(logs.min(), logs.max())) <= math.log(FAR)
        # only one of the two: 0 times inf
        between = np.where(weakest == math.inf, math.inf, np.sqrt(strongest * weakest))
        median = np.select([fitted & apart, rises & near], [between, np.exp(beyond)], math.nan)
        beta = np.select([~fitted, apart, rises], [math.nan, 0.0, 1.0 / b], math.inf)
        level = np.select([rises & ~near, fitted & ~apart & ~rises], [a - b * middle, share])
        level = np.where(fitted & np.isnan(median), level, math.nan)
    return Fit(*(value.reshape(shape) for value in (median, beta, level)))


def _likeliest(
    logs: FloatArray, overturned: FloatArray, survived: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return levels and slopes of the normal quantile in the logarithm of the intensity.

    By Newton's method, all at once, each step halved until the likelihood grows: its logarithm is
    concave.
    """
    from scipy.special import log_ndtr

    line = np.zeros((len(logs), 2))
    powers = np.stack([np.ones_like(logs), logs], axis=-1)
    known = _likelihood(line, powers, overturned, survived)
    for _ in range(NEWTON_STEPS):
        z = (powers @ line[..., np.newaxis])[..., 0]
        bell = -0.5 * z * z - 0.5 * math.log(2.0 * math.pi)
        up, down = np.exp(bell - log_ndtr(z)), np.exp(bell - log_ndtr(-z))
        slope = ((overturned * up - survived * down)[..., np.newaxis] * powers).sum(axis=-2)
        bend = overturned * up * (z + up) + survived * down * (down - z)
        curvature = np.einsum("nk,nki,nkj->nij", bend, powers, powers)
        step = np.linalg.solve(curvature, slope[..., np.newaxis])[..., 0]
        for _ in range(HALVINGS):
            found = _likelihood(line + step, powers, overturned, survived)
            less = found < known - ROUNDING * np.abs(known)
            if not less.any():
                break
            step[less] *= 0.5
        line, known = line + step, found
        if (np.abs(step) <= CONVERGED * (1.0 + np.abs(line))).all():
            break
    return line[:, 0], line[:, 1]


def _likelihood(
    line: FloatArray, powers: FloatArray, overturned: FloatArray, survived: FloatArray
) -> FloatArray:
    """Return the logarithm of the likelihood of each line."""
    from scipy.special import log_ndtr

    z = (powers @ line[..., np.newaxis])[..., 0]
    return np.asarray((overturned * log_ndtr(z) + survived * log_ndtr(-z)).sum(axis=-1))


def draws_of(motions: int, resamples: int, seed: int = 0) -> FloatArray:
    """Draw motions with replacement, the same ones for the same seed.

    Returns
    -------
    ndarray, shape (resamples, motions)
        How often each sample has each motion; the first samples are the same for any number.
    """
    evenly = np.full(motions, 1.0 / motions)
    return np.random.default_rng(seed).multinomial(motions, evenly, size=resamples).astype(float)


def bounds(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the pointwise confidence bounds of rows of values, those of infinite ones included.

    What is not determined may be anything from 0 to inf.
    """
    tail = 0.5 * (1.0 - CONFIDENCE)
    least, most = (np.where(np.isnan(values), end, values) for end in (0.0, math.inf))
    # a neighbour instead of an interpolation: between a number and inf there is none
    low = np.quantile(least, tail, axis=0, method="lower")
    high = np.quantile(most, 1.0 - tail, axis=0, method="higher")
    return low, high


def share_bounds(successes: int, cases: int) -> tuple[float, float]:
    """Return the exact bounds of a share at the level CONFIDENCE (Clopper and Pearson 1934).

    Parameters
    ----------
    successes, cases : int
        The share is successes/cases, of independent cases; there may be none.

    Returns
    -------
    (float, float)
        The lower and the upper one; 0 and 1 where there is no case.
    """
    from scipy.stats import binomtest

    if cases == 0:
        return 0.0, 1.0
    interval = binomtest(successes, cases).proportion_ci(CONFIDENCE, method="exact")
    return float(interval.low), float(interval.high)


class Fragility:
    """The fit of one block and source, and those of resampled motions.

    Parameters
    ----------
    intensity : ndarray, shape (k,)
    overturned, usable : ndarray, shape (n, k)
        Whether each motion overturned the block, and whether there is a result, 0 or 1.
    resamples : int
        How often the motions are drawn again, whole.
    """

    def __init__(
        self, intensity: FloatArray, overturned: FloatArray, usable: FloatArray, resamples: int
    ) -> None:
        self.intensity, self.overturned, self.usable = intensity, overturned, usable
        self.fit = fit_lognormal(intensity, overturned.sum(axis=0), usable.sum(axis=0))
        # the same draw for every source, so that their ratios are of the same motions
        draws = draws_of(len(overturned), resamples)
        self.resampled = fit_lognormal(intensity, draws @ overturned, draws @ usable)

    @classmethod
    def of(cls, group: pd.DataFrame, resamples: int) -> Fragility:
        """Return that of the rows of one block and source."""
        table = group.pivot(index="motion", columns="intensity", values="outcome")
        overturned = (table == "overturned").to_numpy(float)
        usable = (table != "failed").to_numpy(float)
        return cls(table.columns.to_numpy(float), overturned, usable, resamples)

    def where(self, usable: FloatArray) -> Fragility:
        """Return that of the cases in which another source has a result too."""
        if usable.all():
            return self
        both = (self.overturned * usable, self.usable * usable)
        return Fragility(self.intensity, *both, len(self.resampled.median))


Fragilities = Mapping[tuple[Hashable, ...], Fragility]
"""Width and height of a block [m] and a source -> what is known of its overturning."""


def fragilities(rows: pd.DataFrame, resamples: int) -> Fragilities:
    """Fit every block and source."""
    groups = rows.groupby([*BLOCK, "source"], sort=False)
    return {key: Fragility.of(group, resamples) for key, group in groups}


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
    """Return the columns of agreement.csv, for each block and source, but for its resamples."""
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
