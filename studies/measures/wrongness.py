"""What is wrong about an outcome: counted here alone, for every table and sentence."""
# Rest and rocking are told by peaks, for an engine's word depends on how far its contact gives way.

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from analytic.response import Outcome, Response

FALL, REST, NO_ANSWER = "fall_wrong", "rest_wrong", "no_answer"
KINDS = (FALL, REST, NO_ANSWER)
"""Kinds of wrong outcomes, which are columns of tables, too."""
WORDS = {FALL: "wrong overturning", REST: "missed rocking", NO_ANSWER: "no result"}
"""Kind -> its name in a sentence."""
MEANINGS = {
    FALL: "one overturns, the other does not",
    REST: "a peak below a tenth of the exact one, or above 1 % of θcr for rest",
    NO_ANSWER: "the run failed, or the block slid away",
}
"""Kind -> what it counts of an outcome and the exact one."""

LEAST_PART, LEAST = 0.1, 0.01
"""Part of the exact peak, and of theta_cr where the exact solution rests, that tells rocking."""

ANSWERS = tuple(outcome.value for outcome in (Outcome.AT_REST, Outcome.ROCKED, Outcome.OVERTURNED))
"""Outcomes that can be right."""


def kinds_of(
    found: ArrayLike, peak: ArrayLike, right: ArrayLike, exact_peak: ArrayLike
) -> NDArray[np.str_]:
    """Return for each outcome and peak the kind of wrongness, empty where it is right."""
    mine, exact = np.broadcast_arrays(np.asarray(found, object), np.asarray(right, object))
    if not np.isin(exact, ANSWERS).all():
        raise ValueError(f"an exact outcome is none of {', '.join(ANSWERS)}")
    fallen, falls = Outcome.OVERTURNED.value, exact == Outcome.OVERTURNED.value
    size, wanted = np.asarray(peak, float), np.asarray(exact_peak, float)
    missed = np.where(wanted > 0.0, size < LEAST_PART * wanted, size > LEAST)
    return np.select(
        [~np.isin(mine, ANSWERS), (mine == fallen) != falls, ~falls & missed],
        [NO_ANSWER, FALL, REST],
        "",
    )


def kind_of(response: Response, exact: Response) -> str:
    """Return the kind of wrongness of a response, empty where it is right."""
    pair = ([value] for it in (response, exact) for value in (it.outcome.value, it.peak_ratio))
    return str(kinds_of(*pair)[0])


def wrong_in(rows: pd.DataFrame) -> pd.Series[Any]:
    """Return the kind of each row that has an outcome and a peak, and the exact ones."""
    names = ("outcome", "peak_ratio", "exact_outcome", "exact_peak")
    return pd.Series(kinds_of(*(rows[name] for name in names)), rows.index, object)


def counted(kinds: pd.Series[Any]) -> dict[str, int]:
    """Return how many there are of each kind."""
    return {kind: int((kinds == kind).sum()) for kind in KINDS}


def in_kinds(counts: Mapping[str, Any] | pd.Series[Any]) -> str:
    """Return how many outcomes are wrong, by kind: "wrong overturning in 3, no result in 2"."""
    words = [f"{name} in {counts[kind]:.0f}" for kind, name in WORDS.items() if counts[kind]]
    return ", ".join(words) or "none wrong"
