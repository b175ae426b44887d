"""Are statistics predicted where single responses are not? What the tests say, as they say it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pandas as pd

from studies.ensemble.agreement import CLOSE, DIGITS
from studies.measures.words import listed, out_of, part

LEVEL = 0.05
"""Level of the tests."""

SINGLES = 0.9
"""Share of single responses within CLOSE from which on they are called predicted."""


def first_claim(agreed: pd.DataFrame) -> str:
    """Say whose statistics tests tell from the exact ones, and whose they do not."""
    words: dict[bool, list[str]] = {True: [], False: []}
    for source, rows in agreed.groupby("source", sort=False):
        words[bool(rejections(rows))].append(str(source))
    told, untold = listed(words[True]), listed(words[False])
    if not words[True]:
        return f"Of many records, tests tell no statistics from the exact ones: not by {untold}."
    rest = f", and those by {untold} they do not" if words[False] else ""
    return f"Of many records, tests tell the statistics by {told} from the exact ones{rest}."


def verdict(agreed: pd.DataFrame) -> str:
    """Say for which sources the claim holds, and what rejects it for the others."""
    spared, refuted, predicted = [], [], []
    for source, rows in agreed.groupby("source", sort=False):
        name = f"{source} ({part(share_predicted(rows))})"
        if share_predicted(rows) >= SINGLES:
            predicted.append(name)
        elif against := rejections(rows):
            refuted.append(f"{name}: {', '.join(against)}")
        else:
            spared.append(name)
    sentences = [
        f"At least {SINGLES:.0%} of single responses come within {CLOSE:.0%} of the exact ones "
        f"with {listed(predicted)}."
    ]
    if spared:
        sentences.append(
            "With fewer single responses predicted, no test tells the statistics from the exact "
            f"ones for {listed(spared)}: there the claim that statistics are predicted where "
            "responses are not holds."
        )
    if refuted:
        sentences.append(f"At least one test rejects it for {'; '.join(refuted)}.")
    return " ".join(sentences)


def share_predicted(rows: pd.DataFrame) -> float:
    """Return the share of single responses that a source predicts, over all blocks."""
    return float(np.average(rows["predicted"], weights=rows["cases"]))


def rejections(rows: pd.DataFrame) -> list[str]:
    """Return what tells a source's statistics from the exact ones, each test with its number."""
    words = []
    for _, row in rows.iterrows():
        block = f"at {row['width_m']:g} m x {row['height_m']:g} m"
        if is_off(row["ratio_low"], row["ratio_high"]):
            words.append(f"capacity ratio {interval(row)} {block}")
        if row["mcnemar_p"] < LEVEL:
            words.append(f"McNemar p = {row['mcnemar_p']:.2g} {block}")
    if rows["ks_rejected"].sum():
        words.append(_distributions(rows))
    return words


def is_off(low: float, high: float) -> bool:
    """Say whether an interval leaves out 1."""
    return low > 1.0 or high < 1.0


AT_EDGE = "*"
"""What follows bounds of which one is none of the intensities' making."""


def interval(row: pd.Series[Any], name: str = "capacity_ratio", prefix: str = "ratio") -> str:
    """Return a fitted number with its bounds; it may be one that the outcomes do not tell."""
    value, *bounds = (row[it] for it in (name, f"{prefix}_low", f"{prefix}_high"))
    middle = "undetermined" if math.isnan(value) else f"{value:.{DIGITS}f}"
    low, high = (f"{bound:.{DIGITS}f}" for bound in bounds)
    return f"{middle} [{low}, {high}]{AT_EDGE if row[f'{prefix}_at_edge'] else ''}"


def _distributions(rows: pd.DataFrame) -> str:
    tests = rows["ks_tests"].sum()
    return (
        f"Kolmogorov and Smirnov's test rejects {out_of(rows['ks_rejected'].sum(), tests)} "
        f"distributions of the peak ({LEVEL * tests:.1f} expected by chance)"
    )
