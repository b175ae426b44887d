"""What an ensemble says: stripes, fragility curves, agreement one by one and in distribution."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pandas as pd

from studies.ensemble.claims import AT_EDGE, interval, verdict
from studies.ensemble.fragility import BLOCK, Fragilities, bounds, by_block, share_bounds
from studies.measures.differences import scientific

DISORDER = 1.0
"""beta from which on the intensity hardly orders the overturnings."""

POINTS = 60
"""Points of a fragility curve."""


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


def curves(rows: pd.DataFrame, fitted: Fragilities) -> pd.DataFrame:
    """Return the fitted probability of overturning against intensity, with its bounds."""
    least, most = rows["intensity"].min(), rows["intensity"].max()
    grid = np.geomspace(0.7 * least, 1.2 * most, POINTS)
    parts = []
    for (width_m, height_m, source), known in fitted.items():
        low, high = bounds(known.resampled.probability(grid))
        columns = {
            "width_m": width_m,
            "height_m": height_m,
            "source": source,
            "intensity": grid,
            "probability": known.fit.probability(grid),
            "low": low,
            "high": high.clip(max=1.0),
        }
        parts.append(pd.DataFrame(columns))
    return pd.concat(parts, ignore_index=True)


def findings(rows: pd.DataFrame, agreed: pd.DataFrame, confused: pd.DataFrame) -> str:
    """Say what the tables say: single responses, distributions, fragility, and the claim."""
    motions, levels = rows["motion"].nunique(), sorted(rows["intensity"].unique())
    head = (
        f"{motions} motions of {rows['family'].iloc[0]!r} at {len(levels)} intensities "
        f"(PGA over g tan α: {', '.join(f'{level:g}' for level in levels)})."
    )
    parts = [head]
    for size, block in by_block(agreed):
        exact = block.iloc[0]
        title = f"\nBlock {size['width_m']:g} m x {size['height_m']:g} m; exact capacity "
        parts.append(
            f"{title}{interval(exact, 'capacity', 'capacity')} onsets, β = {exact['beta']:.3f}:"
        )
        parts.append(_block_table(block.iloc[1:]))
        if exact["beta"] > DISORDER:
            parts.append("A stronger motion often spares the block: the fit says little here.")
    parts.append("\nOutcomes beside the exact ones, all blocks and intensities:")
    totals = confused.groupby(["source", "exact_outcome", "outcome"], sort=False)["cases"].sum()
    parts.append(totals.unstack(fill_value=0).to_string())
    parts += [
        "",
        verdict(agreed[agreed["source"] != "exact"]),
        "exact at 1.01 is the exact solution of motions 1 % stronger: what a small uncertainty of "
        "the motion does to the response itself.",
        "The two distributions are of the same motions, so that the test of Kolmogorov and Smirnov "
        "errs on the side of calling them equal; McNemar's and the capacity's ratio are paired.",
        f"Bounds are of {agreed['resamples'].max()} samples of the motions, of which twice as many "
        f"as before moved none by half of its last digit; {AT_EDGE}: one lies at the least or the "
        "largest intensity, or beyond, and says no more than that.",
    ]
    return "\n".join(parts)


def _number(form: str) -> Callable[[float], str]:
    return lambda value: "-" if math.isnan(value) else format(value, form)


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
            "KS": block["ks"].map(_number(".3f")),
            "p": block["ks_p"].map(_number(".2g")),
            "McNemar p": block["mcnemar_p"].map(_number(".2g")),
            "capacity/exact": [interval(row) for _, row in block.iterrows()],
            "β": block["beta"].map(_number(".3f")),
        }
    )
    return shown.to_string(index=False)
