"""What an ensemble says: tables of its rows, and whose statistics tests tell from the exact."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from studies.drawing.kept import Pictures, tell
from studies.ensemble.agreement import BOUNDS, CLOSE, DIGITS, LEVEL, confusion, settled
from studies.ensemble.fragility import BLOCK, Fragilities, bounds, share_bounds
from studies.kit.tables import write_table
from studies.measures.words import listed

POINTS = 60
"""Points of a fragility curve."""

ONE_BY_ONE = [
    *(*BLOCK, "source", "cases", "failed", "right", "false", "missed"),
    *("median_error", "p90_error", "predicted"),
]
IN_DISTRIBUTION = [
    *(*BLOCK, "source", "ks", "ks_p", "mcnemar_p", "capacity", "capacity_ratio"),
    *("ratio_low", "ratio_high", "ratio_at_edge", "beta"),
]
SETTLED = dict.fromkeys(("capacity", "capacity_ratio", *BOUNDS), DIGITS)
"""Digits after the point of what motions that are drawn again leave open."""


def read_rows(folder: Path) -> pd.DataFrame:
    """Read ensemble.csv; the exact solution of stronger motions is a source of its own."""
    rows = pd.read_csv(folder / "ensemble.csv", dtype={"message": str})
    stronger = rows["source"] + rows["strength"].map(" at {:g}".format)
    return rows.assign(source=rows["source"].where(rows["strength"] == 1.0, stronger))


def report(folder: Path) -> str:
    """Reduce a folder's ensemble.csv to its tables, its drawing and its findings; return these."""
    rows = read_rows(folder)
    fitted, agreed = settled(rows)
    tables = {"stripes": stripes(rows), "curves": curves(rows, fitted), "agreement": agreed}
    tables["confusion"] = confusion(rows)
    for name, table in tables.items():
        write_table(folder / f"{name}.csv", table)
    by = ["source", "exact_outcome", "outcome"]
    outcomes = tables["confusion"].groupby(by, sort=False)["cases"].sum().unstack(fill_value=0)
    others = agreed[agreed["source"] != "exact"]
    shown = {
        f"Single responses, predicted within {CLOSE:g} (exact at 1.01: the exact solution of "
        "motions 1 % stronger)": others[ONE_BY_ONE],
        f"Distributions, and the capacity over the exact one with bounds of "
        f"{agreed['resamples'].max()} samples of the motions (at_edge: one lies at the least or "
        "the largest intensity, or beyond)": agreed[IN_DISTRIBUTION].round(SETTLED),
        f"Tests of all blocks that tell statistics from the exact ones, at the level {LEVEL:g} "
        "(Kolmogorov and Smirnov's errs on the side of equality, the others are paired)": (
            told(others)
        ),
        "Outcomes beside the exact ones, all blocks and intensities": outcomes.reset_index(),
    }
    motions, levels = rows["motion"].nunique(), sorted(rows["intensity"].unique())
    head = (
        f"{motions} motions of {rows['family'].iloc[0]!r} at {len(levels)} intensities "
        f"(PGA over g tan α: {', '.join(f'{level:g}' for level in levels)})."
    )
    return tell(folder, pictures(folder), f"{headline(folder)} {head}", shown)


def pictures(folder: Path) -> Pictures:
    """Draw a folder's figures from its tables alone; single responses where it holds them."""
    from studies.ensemble.figure import draw_fragility, draw_singles

    tables = (pd.read_csv(folder / f"{name}.csv") for name in ("stripes", "curves", "agreement"))
    drawn = {"ensemble": draw_fragility(*tables)}
    if (folder / "ensemble.csv").is_file():
        drawn["singles"] = draw_singles(read_rows(folder))
    return drawn


def headline(folder: Path) -> str:
    """Say whose statistics tests tell from the exact ones, and whose they do not."""
    agreed = pd.read_csv(folder / "agreement.csv")
    return first_claim(agreed[agreed["source"] != "exact"])


def first_claim(agreed: pd.DataFrame) -> str:
    """Say whose statistics tests tell from the exact ones, and whose they do not."""
    tests = told(agreed).set_index("source")
    any_does = tests[["capacity_off", "mcnemar_rejected", "ks_rejected"]].any(axis=1)
    found, untold = (listed(list(tests.index[some])) for some in (any_does, ~any_does))
    if not any_does.any():
        return f"Of many records, tests tell no statistics from the exact ones: not by {untold}."
    rest = "" if any_does.all() else f", and those by {untold} they do not"
    return f"Of many records, tests tell the statistics by {found} from the exact ones{rest}."


def told(agreed: pd.DataFrame) -> pd.DataFrame:
    """Return for each source the tests that tell its statistics from the exact ones, of all blocks.

    Parameters
    ----------
    agreed : DataFrame
        Lines of agreement.csv, without those of the exact solution.

    Returns
    -------
    DataFrame
        predicted: share of the single responses that are; capacity_off: blocks whose interval of
        the ratio of capacities leaves out 1; mcnemar_rejected: those of which as many overturn
        falsely as are missed is no chance; ks_rejected of ks_tests distributions.
    """
    lines = agreed.assign(
        predicted=agreed["predicted"] * agreed["cases"],
        blocks=1,
        capacity_off=(agreed["ratio_low"] > 1.0) | (agreed["ratio_high"] < 1.0),
        mcnemar_rejected=agreed["mcnemar_p"] < LEVEL,
    )
    kept = ["cases", "predicted", "blocks", "capacity_off", "mcnemar_rejected"]
    table = lines.groupby("source", sort=False)[[*kept, "ks_rejected", "ks_tests"]].sum()
    return table.assign(predicted=table["predicted"] / table["cases"]).reset_index()


def stripes(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the share overturned of each block, source and intensity, with its bounds."""
    counted = rows.assign(
        **{name: rows["outcome"] == name for name in ("failed", "overturned")},
        cases=rows["outcome"] != "failed",
    ).groupby([*BLOCK, "source", "intensity"], sort=False)
    table = counted[["cases", "failed", "overturned"]].sum()
    pairs = table[["overturned", "cases"]].to_numpy().tolist()
    low, high = zip(*(share_bounds(*pair) for pair in pairs), strict=True)
    return table.assign(
        share=table["overturned"] / table["cases"],
        share_low=low,
        share_high=high,
        median_peak=counted["peak_ratio"].median(),
    ).reset_index()


def curves(rows: pd.DataFrame, fitted: Fragilities) -> pd.DataFrame:
    """Return the fitted probability of overturning against intensity, with its bounds."""
    grid = np.geomspace(0.7 * rows["intensity"].min(), 1.2 * rows["intensity"].max(), POINTS)
    parts = []
    for names, known in fitted.items():
        low, high = bounds(known.resampled.probability(grid))
        columns = {
            **dict(zip([*BLOCK, "source"], names, strict=True)),
            "intensity": grid,
            "probability": known.fit.probability(grid),
            "low": low,
            "high": high.clip(max=1.0),
        }
        parts.append(pd.DataFrame(columns))
    return pd.concat(parts, ignore_index=True)
