"""What an ensemble says: stripes, fragility curves, agreement one by one and in distribution."""

import math
from collections.abc import Iterator, Mapping

import numpy as np
import pandas as pd
from scipy.stats import binomtest, ks_2samp

from analytic.motion import FloatArray
from studies.differences import scientific
from studies.fragility import bounds, choose, fit_lognormal, resampled_fits, share_bounds

BLOCK = ["width_m", "height_m"]
CASE = [*BLOCK, "motion", "intensity"]

CLOSE = 0.1
"""A peak is predicted when it is right within this part."""

POINTS = 60
"""Points of a fragility curve."""


def _blocks(rows: pd.DataFrame) -> Iterator[tuple[dict[str, float], pd.DataFrame]]:
    for _, group in rows.groupby(BLOCK, sort=False):
        yield {name: float(group[name].iloc[0]) for name in BLOCK}, group


def stripes(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the share overturned of each block, source and intensity, with its bounds."""
    lines = []
    for names, group in rows.groupby([*BLOCK, "source", "intensity"], sort=False):
        usable = group[group["outcome"] != "failed"]
        overturned = int((usable["outcome"] == "overturned").sum())
        low, high = share_bounds(overturned, len(usable))
        lines.append(
            {
                **dict(zip([*BLOCK, "source", "intensity"], names, strict=True)),
                "cases": len(usable),
                "failed": len(group) - len(usable),
                "overturned": overturned,
                "share": overturned / len(usable) if len(usable) else math.nan,
                "share_low": low,
                "share_high": high,
                "median_peak": usable["peak_ratio"].median(),
            }
        )
    return pd.DataFrame(lines)


class Fragility:
    """The fit of one block and source, and those of resampled motions."""

    def __init__(self, group: pd.DataFrame) -> None:
        table = group.pivot(index="motion", columns="intensity", values="outcome")
        self.intensity = table.columns.to_numpy(float)
        usable = (table != "failed").to_numpy(float)
        overturned = (table == "overturned").to_numpy(float)
        self.fit = fit_lognormal(self.intensity, overturned.sum(axis=0), usable.sum(axis=0))
        # the same draw for every source, so that their ratios are of the same motions
        chosen = choose(len(table))
        self.resampled = resampled_fits(self.intensity, overturned, usable, chosen)

    def medians(self) -> FloatArray:
        """Return the medians of the resampled fits."""
        return np.array([fit.median for fit in self.resampled])


Fragilities = Mapping[tuple[float, float, str], Fragility]
"""Width and height of a block [m] and a source -> what is known of its overturning."""


def fragilities(rows: pd.DataFrame) -> Fragilities:
    """Fit every block and source."""
    return {
        (size["width_m"], size["height_m"], str(source)): Fragility(group)
        for size, block in _blocks(rows)
        for source, group in block.groupby("source", sort=False)
    }


def curves(rows: pd.DataFrame, fitted: Fragilities) -> pd.DataFrame:
    """Return the fitted probability of overturning against intensity, with its bounds."""
    least, most = rows["intensity"].min(), rows["intensity"].max()
    grid = np.geomspace(0.7 * least, 1.2 * most, POINTS)
    parts = []
    for (width_m, height_m, source), known in fitted.items():
        low, high = bounds(np.array([fit.probability(grid) for fit in known.resampled]))
        columns = {
            "width_m": width_m,
            "height_m": height_m,
            "source": source,
            "intensity": grid,
            "probability": known.fit.probability(grid),
            "low": low,
            "high": high,
        }
        parts.append(pd.DataFrame(columns))
    return pd.concat(parts, ignore_index=True)


def with_exact(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of all other sources beside the exact outcome and peak of their case."""
    exact = rows.loc[rows["source"] == "exact", [*CASE, "outcome", "peak_ratio"]]
    exact = exact.rename(columns={"outcome": "exact_outcome", "peak_ratio": "exact_peak"})
    joined = rows[rows["source"] != "exact"].merge(exact, on=CASE, validate="many_to_one")
    both = (joined["outcome"] == "rocked") & (joined["exact_outcome"] == "rocked")
    return joined.assign(
        agrees=joined["outcome"] == joined["exact_outcome"],
        error=(joined["peak_ratio"] / joined["exact_peak"] - 1.0).where(both),
    )


def agreement(rows: pd.DataFrame, fitted: Fragilities) -> pd.DataFrame:
    """Return, for each block and source, the agreement case by case and in distribution.

    Returns
    -------
    DataFrame
        right, false and missed overturnings; median_error and p90_error of single peaks, predicted
        (share of cases with the right outcome and, if rocked, a peak right within CLOSE);
        ks, the largest distance between the distributions of the peaks over the intensities, ks_p
        its p-value and ks_rejected the intensities with one below 0.05; mcnemar_p, of as many
        overturnings too many as too few; the fitted capacity and its ratio to the exact one.
    """
    lines = []
    for size, block in _blocks(with_exact(rows)):
        known = (size["width_m"], size["height_m"])
        exact = fitted[(*known, "exact")]
        lines.append({**size, "source": "exact", **_capacity(exact, exact)})
        for source, group in block.groupby("source", sort=False):
            usable = group[group["outcome"] != "failed"]
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
        "median_error": errors.median(),
        "p90_error": errors.quantile(0.9) if len(errors) else math.nan,
        "predicted": close.sum() / len(group),
    }


def _in_distribution(usable: pd.DataFrame) -> dict[str, object]:
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
    with np.errstate(invalid="ignore", divide="ignore"):
        ratio = float(np.divide(here.fit.median, exact.fit.median))
        low, high = bounds(here.medians() / exact.medians())
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
    counted = with_exact(rows).groupby([*BLOCK, "source", "exact_outcome", "outcome"], sort=False)
    return counted.size().rename("cases").reset_index()


def findings(rows: pd.DataFrame, agreed: pd.DataFrame, confused: pd.DataFrame) -> str:
    """Say what the tables say: single responses, distributions, fragility, and the claim."""
    motions, levels = rows["motion"].nunique(), sorted(rows["intensity"].unique())
    head = (
        f"{motions} motions of the family {rows['family'].iloc[0]!r} at {len(levels)} intensities "
        f"(PGA over g tan α: {', '.join(f'{level:g}' for level in levels)})."
    )
    parts = [head]
    for size, block in _blocks(agreed):
        exact = block.iloc[0]
        title = f"\nBlock {size['width_m']:g} m x {size['height_m']:g} m; exact capacity "
        parts.append(f"{title}{_interval(exact, 'capacity')} onsets, β = {exact['beta']:.3f}:")
        parts.append(_block_table(block.iloc[1:]))
    parts.append("\nOutcomes beside the exact ones, all blocks and intensities:")
    totals = confused.groupby(["source", "exact_outcome", "outcome"], sort=False)["cases"].sum()
    parts.append(totals.unstack(fill_value=0).to_string())
    parts += ["", *_claims(agreed[agreed["source"] != "exact"])]
    return "\n".join(parts)


def _interval(row: "pd.Series[float]", name: str, prefix: str = "capacity") -> str:
    low, high = row[f"{prefix}_low"], row[f"{prefix}_high"]
    return f"{row[name]:.3f} [{low:.3f}, {high:.3f}]"


def _block_table(block: pd.DataFrame) -> str:
    shown = pd.DataFrame(
        {
            "source": block["source"],
            "right": [f"{row.right:.0f}/{row.cases:.0f}" for row in block.itertuples()],
            "false": block["false"].astype(int),
            "missed": block["missed"].astype(int),
            "failed": block["failed"].astype(int),
            "median": block["median_error"].map(scientific),
            "p90": block["p90_error"].map(scientific),
            "predicted": block["predicted"].map("{:.0%}".format),
            "KS": block["ks"].map("{:.3f}".format),
            "p": block["ks_p"].map("{:.2g}".format),
            "McNemar p": block["mcnemar_p"].map("{:.2g}".format),
            "capacity/exact": [
                _interval(row, "capacity_ratio", "ratio") for _, row in block.iterrows()
            ],
            "β": block["beta"].map("{:.3f}".format),
        }
    )
    return shown.to_string(index=False)


def _claims(agreed: pd.DataFrame) -> list[str]:
    """Hold the claim that statistics are predicted where single responses are not."""
    lines = []
    for source, group in agreed.groupby("source", sort=False):
        predicted = np.average(group["predicted"], weights=group["cases"])
        apart = (group["capacity_ratio"] - 1.0).abs().max()
        sure = (group["ratio_low"] > 1.0) | (group["ratio_high"] < 1.0)
        singles = f"{predicted:.0%} of single responses predicted within {CLOSE:.0%}"
        rejected, tests = int(group["ks_rejected"].sum()), int(group["ks_tests"].sum())
        lines.append(
            f"{source}: {singles}; the fitted capacity is off by up to {apart:.1%}, by more than "
            f"resampling explains for {int(sure.sum())} of {len(group)} blocks; the peaks' "
            f"distributions differ (p < 0.05) at {rejected} of {tests} intensities."
        )
    lines.append(
        "exact at 1.01 is the exact solution of motions 1 % stronger: what a small uncertainty of "
        "the motion does to the response itself."
    )
    lines.append(
        "The two distributions are of the same motions, so that the test of Kolmogorov and Smirnov "
        "errs on the side of calling them equal; McNemar's and the capacity's ratio are paired."
    )
    return lines
