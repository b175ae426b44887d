"""Fragility: the probability of overturning against intensity, with what is not known of it.

A block overturns at the intensity x with the probability Phi(ln(x/median)/beta): capacities are
lognormal. Fitted by maximum likelihood to the counts at each intensity (Baker 2015, "Efficient
analytical fragility function fitting using dynamic structural analysis"), with scipy's optimizer
and its normal distribution; the bounds are quantiles over resampled motions, whole, since what one
motion does at two intensities is not independent.
"""

import math
from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import log_ndtr, ndtr, ndtri
from scipy.stats import binomtest

from analytic.motion import FloatArray

BLOCK = ["width_m", "height_m"]
"""Columns that tell blocks apart."""

CONFIDENCE = 0.95
RESAMPLES = 200


FAR = 10.0
"""A median further than this many times beyond the intensities is not determined by them."""


class Fit(NamedTuple):
    """A lognormal capacity: its median, and the standard deviation of its logarithm.

    beta is 0 where every intensity with an overturning lies above every one with a survival; the
    median is then between the two, or 0 or inf if there is only one of them. The median is nan
    where the counts do not determine one: overturning does not rise with the intensity (beta is
    then inf), rises so little that even odds lie FAR beyond the intensities, or there are no
    counts. `level` is then the normal quantile of the probability at intensity 1.
    """

    median: float
    beta: float
    level: float = math.nan

    def probability(self, intensity: FloatArray) -> FloatArray:
        """Return the probability of overturning at each intensity."""
        if math.isnan(self.median):
            return np.asarray(ndtr(self.level + np.log(intensity) / self.beta))
        if self.beta == 0.0 or not 0.0 < self.median < math.inf:
            return np.where(intensity > self.median, 1.0, 0.0)
        return np.asarray(ndtr(np.log(intensity / self.median) / self.beta))


def fit_lognormal(intensity: FloatArray, overturned: FloatArray, cases: FloatArray) -> Fit:
    """Fit the capacity to the number overturned of so many cases at each intensity."""
    survived = cases - overturned
    if not cases.any():
        return Fit(math.nan, math.nan)
    if not overturned.any() or not survived.any():
        return Fit(0.0 if overturned.any() else math.inf, 0.0)
    strongest, weakest = intensity[survived > 0].max(), intensity[overturned > 0].min()
    if strongest <= weakest:
        return Fit(math.sqrt(strongest * weakest), 0.0)
    logs = np.log(intensity)
    middle = float(np.average(logs, weights=cases))
    if np.average(logs, weights=overturned) <= middle:
        # the likelihood is concave, and falls with the slope from zero on
        return Fit(math.nan, math.inf, float(ndtri(overturned.sum() / cases.sum())))
    level, slope = _likeliest(logs - middle, overturned, survived)
    beyond = -level / slope + middle
    if logs.min() - math.log(FAR) <= beyond <= logs.max() + math.log(FAR):
        return Fit(math.exp(beyond), 1.0 / slope)
    return Fit(math.nan, 1.0 / slope, level - slope * middle)


def _likeliest(logs: FloatArray, overturned: FloatArray, survived: FloatArray) -> FloatArray:
    """Return level and slope of the normal quantile in the logarithm of the intensity."""

    def unlikelihood(line: FloatArray) -> tuple[float, FloatArray]:
        """Return the negative logarithm of the likelihood, which is convex, and its gradient."""
        z = line[0] + line[1] * logs
        below, above = log_ndtr(z), log_ndtr(-z)
        bell = -0.5 * z * z - 0.5 * math.log(2.0 * math.pi)
        growth = overturned * np.exp(bell - below) - survived * np.exp(bell - above)
        gradient = -np.array([growth.sum(), growth @ logs])
        return -float(overturned @ below + survived @ above), gradient

    best: FloatArray = minimize(unlikelihood, [0.0, 2.0], jac=True, method="BFGS").x
    return best


def resampled_fits(
    intensity: FloatArray, overturned: FloatArray, usable: FloatArray, chosen: NDArray[np.intp]
) -> list[Fit]:
    """Fit again to motions drawn with replacement.

    Parameters
    ----------
    intensity : ndarray, shape (k,)
    overturned, usable : ndarray, shape (n, k)
        Whether each motion overturned the block, and whether there is a result, 0 or 1.
    chosen : ndarray, shape (r, n)
        The motions of each sample; the same for two sources makes their difference a paired one.
    """
    return [
        fit_lognormal(intensity, overturned[rows].sum(axis=0), usable[rows].sum(axis=0))
        for rows in chosen
    ]


def choose(motions: int, seed: int = 0, resamples: int = RESAMPLES) -> NDArray[np.intp]:
    """Draw the motions of each sample, the same ones for the same seed."""
    return np.random.default_rng(seed).integers(motions, size=(resamples, motions))


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
    """Return the exact confidence bounds of a share (Clopper and Pearson 1934)."""
    if cases == 0:
        return 0.0, 1.0
    interval = binomtest(successes, cases).proportion_ci(CONFIDENCE, method="exact")
    return float(interval.low), float(interval.high)


def by_block(rows: pd.DataFrame) -> Iterator[tuple[dict[str, float], pd.DataFrame]]:
    """Yield the size of each block, by its columns, with its rows."""
    for _, group in rows.groupby(BLOCK, sort=False):
        yield {name: float(group[name].iloc[0]) for name in BLOCK}, group


class Fragility:
    """The fit of one block and source, and those of resampled motions.

    Parameters
    ----------
    intensity : ndarray, shape (k,)
    overturned, usable : ndarray, shape (n, k)
        Whether each motion overturned the block, and whether there is a result, 0 or 1.
    """

    def __init__(self, intensity: FloatArray, overturned: FloatArray, usable: FloatArray) -> None:
        self.intensity, self.overturned, self.usable = intensity, overturned, usable
        self.fit = fit_lognormal(intensity, overturned.sum(axis=0), usable.sum(axis=0))
        # the same draw for every source, so that their ratios are of the same motions
        chosen = choose(len(overturned))
        self.resampled = resampled_fits(intensity, overturned, usable, chosen)

    @classmethod
    def of(cls, group: pd.DataFrame) -> "Fragility":
        """Return that of the rows of one block and source."""
        table = group.pivot(index="motion", columns="intensity", values="outcome")
        overturned = (table == "overturned").to_numpy(float)
        usable = (table != "failed").to_numpy(float)
        return cls(table.columns.to_numpy(float), overturned, usable)

    def where(self, usable: FloatArray) -> "Fragility":
        """Return that of the cases in which another source has a result too."""
        if usable.all():
            return self
        return Fragility(self.intensity, self.overturned * usable, self.usable * usable)

    def medians(self) -> FloatArray:
        """Return the medians of the resampled fits."""
        return np.array([fit.median for fit in self.resampled])


Fragilities = Mapping[tuple[float, float, str], Fragility]
"""Width and height of a block [m] and a source -> what is known of its overturning."""


def fragilities(rows: pd.DataFrame) -> Fragilities:
    """Fit every block and source."""
    return {
        (size["width_m"], size["height_m"], str(source)): Fragility.of(group)
        for size, block in by_block(rows)
        for source, group in block.groupby("source", sort=False)
    }
