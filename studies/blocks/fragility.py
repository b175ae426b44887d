"""Fragility: which part of some records overturns a block, by their factor or their peaks."""

from __future__ import annotations

import numpy as np
import pandas as pd

from analytic.motion import FloatArray

MOST_ONSETS = 100.0
"""Over the onset: the largest factor tried."""
MEASURES = {"factor": None, "pga_g": "pga_g", "pgv_m_s": "pgv_m_s"}
"""Measure of a record's strength -> the column that the factor multiplies."""
FEWEST = 3
"""Records under which something overturns, without which there is no curve."""
RESAMPLED = 500
"""How often records are drawn again, for an interval."""


def fragility(lines: pd.DataFrame) -> pd.DataFrame:
    """Return a lognormal distribution of what overturns each block, and the list."""
    kept = lines[lines["no_margin"] == ""]
    least = kept.loc[kept.groupby("record")["margin"].idxmin()] if len(kept) else kept
    groups = [*lines.groupby("name", sort=False), ("any of the list", least)]
    records = lines["record"].nunique()
    rows = []
    for name, group in groups:
        group = group[group["no_margin"] == ""]
        for measure, column in MEASURES.items():
            times = 1.0 if column is None else group[column]
            found = _fit((times * group["margin"]).to_numpy(float), group["lifts"] * times)
            counts = {"records": len(group), "left_out": records - len(group)}
            rows.append({"name": name, "measure": measure, **counts, **found})
    return pd.DataFrame(rows)


def _fit(margins: FloatArray, lifts: pd.Series) -> dict[str, float]:
    """Return medians and spreads: of the sample, and by maximum likelihood with their intervals."""
    beyond = np.isinf(margins)
    logs = np.log(np.where(beyond, MOST_ONSETS * lifts, margins))
    names = ["least", "median", "most", "theta", "theta_low", "theta_high"]
    row = dict.fromkeys([*names, "beta", "beta_low", "beta_high"], np.nan)
    if len(margins):
        middle = np.quantile(margins, 0.5, method="nearest" if beyond.any() else "linear")
        row |= {"least": margins.min(), "median": float(middle), "most": margins.max()}
    if len(margins) - beyond.sum() < FEWEST:
        return row
    drawn = np.random.default_rng(0).integers(len(logs), size=(RESAMPLED, len(logs)))
    mean, spread = lognormal(logs, beyond)
    row |= {"theta": float(np.exp(mean)), "beta": float(spread)}
    means, spreads = lognormal(logs[drawn], beyond[drawn])
    for end, level in (("low", 0.05), ("high", 0.95)):  # an interval of 90 %
        row[f"theta_{end}"] = float(np.exp(np.quantile(means, level)))
        row[f"beta_{end}"] = float(np.quantile(spreads, level))
    return row


def lognormal(logs: FloatArray, beyond: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the mean and spread of logarithms of greatest likelihood, along the last axis."""
    # expectations stand for values `beyond`, again and again (Dempster, Laird and Rubin 1977)
    from scipy.stats import norm  # no help waits for it

    mean, spread = logs.mean(-1, keepdims=True), logs.std(-1, keepdims=True)
    for _ in range(200 if beyond.any() else 0):
        scale = np.maximum(spread, 1e-12)
        far = (logs - mean) / scale
        hazard = np.exp(norm.logpdf(far) - norm.logsf(far))
        likely = np.where(beyond, mean + scale * hazard, logs)
        left = np.where(beyond, scale**2 * (1.0 + far * hazard - hazard**2), 0.0)
        mean = likely.mean(-1, keepdims=True)
        spread = np.sqrt(((likely - mean) ** 2 + left).mean(-1, keepdims=True))
    return mean[..., 0], spread[..., 0]
